// STEP, IGES and BREP: files that OpenCASCADE's own writers make, read back by palpate-import-cad.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IGESCAFControl_Writer.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Poly_Triangulation.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <sstream>

#include "cpu_ref/ref_backend.h"
#include "model/cache/geometry_cache.h"
#include "model/contact/response.h"
#include "model/mesh/mesh_import.h"
#include "model/scene/geometry_build.h"
#include "model/scene/scene_file.h"
#include "tests/model/temporary_folder.h"

// For builds with the address sanitizer: OpenCASCADE's writers, which this test calls in its own process,
// leave memory behind.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libTK"; }

namespace palpate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

double exact_volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

double volume(const Mesh& mesh, const MeshPart& part) {
  double six = 0;
  for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    six += glm::dot(mesh.vertices[a], glm::cross(mesh.vertices[b], mesh.vertices[c]));
  }
  return six / 6;
}

/// Of a closed body whose faces may lie the wrong way round, as a scene makes it of them; 0: it is open.
double oriented_volume(const Mesh& mesh) {
  const auto lattice = choose_lattice(mesh, mesh);
  const auto angle = make_smooth_angle(30);
  MeshReport report;
  const auto body = build_lattice_mesh(mesh, *lattice, *angle, report);
  if (!body || !body->closed) return 0;
  double six = 0;
  for (std::uint32_t t = 0; t < body->triangles.size(); ++t)
    six += glm::dot(Vec3(body->corner(t, 0)), glm::cross(Vec3(body->corner(t, 1)), Vec3(body->corner(t, 2))));
  return six / 6 * std::pow(lattice->step_m, 3);
}

struct Box3 {
  Vec3 low{INFINITY}, high{-INFINITY};
};

Box3 box_of(const Mesh& mesh, const MeshPart& part) {
  Box3 box;
  for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      box.low = glm::min(box.low, mesh.vertices[v]), box.high = glm::max(box.high, mesh.vertices[v]);
  return box;
}

std::vector<std::string> paths(const Mesh& mesh) {
  std::vector<std::string> out;
  for (const MeshPart& part : mesh.parts) out.push_back(part.path);
  return out;
}

std::vector<std::optional<std::uint32_t>> colours(const Mesh& mesh) {
  std::vector<std::optional<std::uint32_t>> out;
  for (const MeshPart& part : mesh.parts) out.push_back(part.colour);
  return out;
}

/// A bored block, 100 × 60 × 40 mm, its corner at the origin, and a lid with two bolts, turned by 180° and 5
/// mm above it: engine { block, lid { plate, bolt, bolt } }. Shapes are in millimetres.
class Engine {
 public:
  Engine() : document_(new TDocStd_Document("MDTV-XCAF")) {
    XCAFDoc_DocumentTool::Set(document_->Main(), false);
    const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    block_ = BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(100, 60, 40).Shape(),
                             BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(50, 30, -1), gp::DZ()), 15, 50).Shape())
                 .Shape();
    plate_ = BRepPrimAPI_MakeBox(100, 60, 10).Shape();
    bolt_ = BRepPrimAPI_MakeCylinder(5, 20).Shape();
    const auto part = [&](const TopoDS_Shape& shape, const char* name) {
      return called(shapes->AddShape(shape, false), name);
    };
    const TDF_Label block = part(block_, "block"), plate = part(plate_, "plate"), bolt = part(bolt_, "bolt");
    const TDF_Label lid = called(shapes->NewShape(), "lid"), engine = called(shapes->NewShape(), "engine");
    called(shapes->AddComponent(lid, plate, at(0, 0, 0)), "plate:1");
    called(shapes->AddComponent(lid, bolt, at(10, 10, 10)), "left bolt");
    const TDF_Label right = called(shapes->AddComponent(lid, bolt, at(90, 10, 10)), "right bolt");
    called(shapes->AddComponent(engine, block, at(0, 0, 0)), "block:1");
    called(shapes->AddComponent(engine, lid, half_turn_and(100, 60, 45)), "lid:1");
    shapes->UpdateAssemblies();
    block_label_ = block, plate_label_ = plate, bolt_label_ = bolt, right_ = right;
  }

  /// The block green, the plate brown but for one face, which is white, bolts grey, and the right one blue.
  void paint() {
    const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    colours->SetColor(block_label_, rgb(kGreen), XCAFDoc_ColorSurf);
    colours->SetColor(bolt_label_, rgb(kGrey), XCAFDoc_ColorGen);
    colours->SetColor(right_, rgb(kBlue), XCAFDoc_ColorSurf);
    std::uint32_t face_colour = kWhite;  // the first face's
    for (TopExp_Explorer it(plate_, TopAbs_FACE); it.More(); it.Next(), face_colour = kBrown)
      colours->SetColor(shapes->AddSubShape(plate_label_, it.Current()), rgb(face_colour), XCAFDoc_ColorSurf);
  }
  static constexpr std::uint32_t kGreen = 0x20a040, kBrown = 0x804010, kWhite = 0xffffff, kGrey = 0x808080,
                                 kBlue = 0x0010f0;

  /// `schema`: what Interface_Static calls it; `unit`: MM, INCH, M.
  void write(const std::string& path, const char* schema, const char* unit) {
    STEPCAFControl_Controller::Init();
    Interface_Static::SetCVal("write.step.schema", schema);
    Interface_Static::SetCVal("write.step.unit", unit);
    STEPCAFControl_Writer writer;
    writer.SetNameMode(true);
    writer.SetColorMode(true);
    ASSERT_TRUE(writer.Transfer(document_, STEPControl_AsIs));
    ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
  }

  const TopoDS_Shape& block() const { return block_; }
  const TopoDS_Shape& plate() const { return plate_; }
  const TopoDS_Shape& bolt() const { return bolt_; }

 private:
  static Quantity_Color rgb(std::uint32_t colour) {
    return {(colour >> 16) / 255.0, (colour >> 8 & 0xff) / 255.0, (colour & 0xff) / 255.0, Quantity_TOC_sRGB};
  }
  static TDF_Label called(const TDF_Label& label, const char* name) {
    TDataStd_Name::Set(label, name);
    return label;
  }
  static TopLoc_Location at(double x, double y, double z) {
    gp_Trsf place;
    place.SetTranslation(gp_Vec(x, y, z));
    return place;
  }

  /// About z, then to (x, y, z).
  static TopLoc_Location half_turn_and(double x, double y, double z) {
    gp_Trsf turn;
    turn.SetRotation(gp::OZ(), M_PI);
    return at(x, y, z) * TopLoc_Location(turn);
  }

  Handle(TDocStd_Document) document_;
  TopoDS_Shape block_, plate_, bolt_;
  TDF_Label block_label_, plate_label_, bolt_label_, right_;
};

class Cad : public testing::Test {
 protected:
  Cad() { Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream)); }

  Mesh read(const std::string& path, const Tessellation& tessellation = {}, double scale = 1) {
    auto mesh = import_mesh(path, scale, report_, {}, {}, tessellation);
    EXPECT_TRUE(mesh) << mesh.error().sentence;
    return mesh ? std::move(*mesh) : Mesh{};
  }

  std::string refused(const std::string& path) {
    const auto mesh = import_mesh(path, 1, report_);
    EXPECT_FALSE(mesh);
    if (mesh) return {};
    EXPECT_EQ(mesh.error().code, ErrorCode::kBadValue);
    EXPECT_THAT(mesh.error().sentence, HasSubstr(path));
    return mesh.error().sentence;
  }

  std::string engine(const char* name, const char* schema = "AP214IS", const char* unit = "MM") {
    const std::string path = folder_.path(name);
    Engine().write(path, schema, unit);
    return path;
  }

  TemporaryFolder folder_;
  ImportReport report_;
};

constexpr double kVolume =
    1e-3;  ///< of a solid's exact volume: what the issue of a fine tessellation may be off by
constexpr double kCubicMm = 1e-9;  ///< m³
const Tessellation kFine{
    .deflection_m = 3e-6, .angle_deg = 4, .part = {}};  // of a circle of 5 mm: sagitta of 86 sides

/// Schema, unit as the writer calls it, unit as the note calls it.
struct Written {
  const char *schema, *unit, *told;
};
class CadAssembly : public Cad, public testing::WithParamInterface<Written> {};

TEST_P(CadAssembly, ComesInWithItsTreeItsNamesItsUnitAndItsVolumes) {
  const Engine exact;
  const std::string path = folder_.path("engine.step");
  Engine().write(path, GetParam().schema, GetParam().unit);
  const Mesh mesh = read(path, kFine);
  ASSERT_THAT(paths(mesh),
              ElementsAre("engine/block", "engine/lid/plate", "engine/lid/bolt", "engine/lid/bolt#2"));
  EXPECT_EQ(mesh.parts[0].also, "block:1");
  EXPECT_EQ(mesh.parts[2].also, "left bolt");
  EXPECT_EQ(mesh.parts[3].also, "right bolt");
  EXPECT_THAT(report_.notes, Contains(AllOf(HasSubstr("unit of length is"), HasSubstr(GetParam().told),
                                            HasSubstr("in metres"))));
  const TopoDS_Shape* shapes[] = {&exact.block(), &exact.plate(), &exact.bolt(), &exact.bolt()};
  for (std::size_t i = 0; i < 4; ++i) {
    const double wanted = exact_volume(*shapes[i]) * kCubicMm;
    EXPECT_NEAR(volume(mesh, mesh.parts[i]), wanted, kVolume * wanted)
        << mesh.parts[i].path;  // above 0: outward, too
  }
  // Where the assembly puts it: the right bolt's box. 1e-9 m: what a file's digits keep.
  const Box3 bolt = box_of(mesh, mesh.parts[3]);
  EXPECT_NEAR(bolt.low.z, 0.055, 1e-9);
  EXPECT_NEAR(bolt.high.z, 0.075, 1e-9);
  EXPECT_NEAR(0.5 * (bolt.low.x + bolt.high.x), 0.01, 1e-5);
  EXPECT_NEAR(0.5 * (bolt.low.y + bolt.high.y), 0.05, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Schemas, CadAssembly,
                         testing::Values(Written{"AP214IS", "MM", "illi"}, Written{"AP242DIS", "MM", "illi"},
                                         Written{"AP203", "MM", "illi"}, Written{"AP214IS", "INCH", "inch"},
                                         Written{"AP242DIS", "M", "metre"}),
                         [](const auto& file) {
                           return fmt::format("{}_{}", file.param.schema, file.param.unit);
                         });

TEST_F(Cad, PartsHaveTheirColours) {
  Engine engine;
  engine.paint();
  const std::string path = folder_.path("engine.step");
  for (const char* schema : {"AP214IS", "AP242DIS"}) {
    engine.write(path, schema, "MM");
    const Mesh mesh = read(path);
    EXPECT_THAT(colours(mesh), ElementsAre(Engine::kGreen, Engine::kBrown, Engine::kGrey, Engine::kBlue))
        << schema;
    const auto part = take_part(mesh, "right bolt", path);
    ASSERT_TRUE(part) << part.error().sentence;
    EXPECT_THAT(colours(*part), ElementsAre(Engine::kBlue));
  }
}

TEST_F(Cad, FacesThatAreSewnKeepTheirColour) {
  Handle(TDocStd_Document) document = new TDocStd_Document("MDTV-XCAF");
  XCAFDoc_DocumentTool::Set(document->Main(), false);
  const TDF_Label box =
      XCAFDoc_DocumentTool::ShapeTool(document->Main())->AddShape(BRepPrimAPI_MakeBox(10, 20, 30).Shape());
  XCAFDoc_DocumentTool::ColorTool(document->Main())
      ->SetColor(box, Quantity_Color(1, 0, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  IGESControl_Controller::Init();
  Interface_Static::SetIVal("write.iges.brep.mode", 0);  // faces
  IGESCAFControl_Writer writer;
  writer.SetColorMode(true);
  ASSERT_TRUE(writer.Transfer(document));
  const std::string path = folder_.path("box.igs");
  ASSERT_TRUE(writer.Write(path.c_str()));
  EXPECT_THAT(colours(read(path)), ElementsAre(0xff0000u));
}

TEST_F(Cad, APartWithoutAColourHasNone) {
  EXPECT_THAT(colours(read(engine("engine.step"))), Each(std::nullopt));
}

// OpenCASCADE 7.6.3 follows a null pointer there.
TEST_F(Cad, AFileWithDamagedColoursIsReadWithoutThem) {
  Engine engine;
  engine.paint();
  const std::string path = folder_.path("engine.step");
  engine.write(path, "AP214IS", "MM");
  const Mesh sound = read(path);
  std::ifstream in(path, std::ios::binary);
  std::stringstream whole;
  whole << in.rdbuf();
  std::string text = whole.str();
  constexpr std::string_view kUsage = "SURFACE_STYLE_USAGE(.BOTH.,";
  const std::size_t style = text.find(kUsage);
  ASSERT_NE(style, std::string::npos);
  const std::size_t reference = style + kUsage.size();
  text.replace(reference, text.find(')', reference) - reference, "$");

  double most = 0;
  const auto mesh = import_mesh(folder_.write("damaged.step", text), 1, report_, {},
                                [&](const char* /*what*/, double done) {
                                  EXPECT_GE(done, most);
                                  most = done;
                                  return true;
                                });
  ASSERT_TRUE(mesh) << mesh.error().sentence;
  EXPECT_THAT(report_.notes, Contains("its colours are damaged and left out"));
  EXPECT_THAT(colours(*mesh), Each(std::nullopt));
  EXPECT_EQ(paths(*mesh), paths(sound));
  EXPECT_EQ(mesh->vertices, sound.vertices);
  EXPECT_EQ(mesh->triangles, sound.triangles);
}

TEST_F(Cad, HowFarItIsIsToldAndItCanBeCancelledBetween) {
  const std::string path = folder_.path("ball.brep");
  ASSERT_TRUE(BRepTools::Write(BRepPrimAPI_MakeSphere(1).Shape(), path.c_str()));
  const Tessellation slow{.deflection_m = 1, .angle_deg = 0.2, .part = {}};  // seconds
  const auto mesh = import_mesh(
      path, 1, report_, {},
      [](std::string_view what, double done) {
        return what != "import, triangles" || done < 2.0 / 3;  // that is where it begins
      },
      slow);
  ASSERT_FALSE(mesh) << mesh->triangles.size();
  EXPECT_THAT(mesh.error().sentence, HasSubstr("was cancelled"));
}

TEST_F(Cad, ABrepThatIsCutShortIsToldAtOnce) {
  const std::string path = folder_.path("ball.brep");
  ASSERT_TRUE(BRepTools::Write(BRepPrimAPI_MakeSphere(1).Shape(), path.c_str()));
  std::ifstream whole(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(whole)), {});
  while (text.back() == '\n' || text.back() == ' ') text.pop_back();
  folder_.write("bare.brep", text);  // its last number is the file's last byte
  EXPECT_EQ(read(folder_.path("bare.brep")).triangles, read(path).triangles);
  for (const double part : {0.2, 0.5, 0.9}) {
    folder_.write("half.brep",
                  text.substr(0, static_cast<std::size_t>(part * static_cast<double>(text.size()))));
    const auto mesh = import_mesh(folder_.path("half.brep"), 1, report_);
    ASSERT_FALSE(mesh) << part;
    EXPECT_THAT(mesh.error().sentence, HasSubstr("half.brep' is cut short")) << part;
  }
}

TEST_F(Cad, APartIsAddressedByNamePathInstanceAndNumber) {
  const Mesh mesh = read(engine("engine.step"));
  const auto only = [&](const char* name) {
    const auto part = take_part(mesh, name, "engine.step");
    EXPECT_TRUE(part) << part.error().sentence;
    return part ? paths(*part) : std::vector<std::string>();
  };
  EXPECT_THAT(only("block"), ElementsAre("engine/block"));
  EXPECT_THAT(only("engine/lid/bolt#2"), ElementsAre("engine/lid/bolt#2"));
  EXPECT_THAT(only("right bolt"), ElementsAre("engine/lid/bolt#2"));
  EXPECT_THAT(only("#4"), ElementsAre("engine/lid/bolt#2"));
  EXPECT_THAT(only("lid"), ElementsAre("engine/lid/plate", "engine/lid/bolt", "engine/lid/bolt#2"));
  for (const char* wrong : {"#0", "#5", "#", "#1x", "rihgt bolt"}) {
    const auto part = take_part(mesh, wrong, "engine.step");
    ASSERT_FALSE(part) << wrong;
    EXPECT_THAT(part.error().sentence,
                AllOf(HasSubstr(fmt::format("no node named '{}'", wrong)), HasSubstr("palpate info --tree")));
  }
  EXPECT_THAT(take_part(mesh, "rihgt bolt", "engine.step").error().sentence,
              HasSubstr("did you mean 'right bolt'"));
}

TEST_F(Cad, DeflectionAndAngleBoundTheTriangles) {
  const std::string path = folder_.path("ball.brep");
  constexpr double kRadius = 0.05;
  ASSERT_TRUE(BRepTools::Write(BRepPrimAPI_MakeSphere(kRadius).Shape(), path.c_str()));
  std::size_t before = 0;
  for (const double deflection : {1e-3, 1e-4, 1e-5}) {
    const Mesh mesh = read(path, {.deflection_m = deflection, .angle_deg = 90, .part = {}});
    double farthest = 0;
    for (const auto& [a, b, c] : mesh.triangles)
      farthest = std::max(
          farthest, kRadius - glm::length((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0));
    EXPECT_LT(farthest, 2 * deflection);  // OpenCASCADE goes by the edges of triangles, not by their middles
    EXPECT_GT(mesh.triangles.size(), before);
    before = mesh.triangles.size();
  }
  EXPECT_GT(read(path, {.deflection_m = 1, .angle_deg = 5, .part = {}}).triangles.size(),
            4 * read(path, {.deflection_m = 1, .angle_deg = 45, .part = {}}).triangles.size());
}

TEST_F(Cad, WithoutADeflectionThePartThatIsAskedForGivesIt) {
  const std::string path = engine("engine.step");
  const Tessellation whole{.deflection_m = 0, .angle_deg = 90, .part = {}},
      bolt{.deflection_m = 0, .angle_deg = 90, .part = "right bolt"};
  EXPECT_GT(read(path, bolt).triangles.size(), read(path, whole).triangles.size());
  const auto wrong =
      import_mesh(path, 1, report_, {}, {}, {.deflection_m = 0, .angle_deg = 15, .part = "nut"});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().sentence, HasSubstr("no node named 'nut'"));
}

TEST_F(Cad, ScaleIsAFactorOnMetres) {
  const Mesh once = read(engine("engine.step")), twice = read(folder_.path("engine.step"), {}, 2);
  EXPECT_NEAR(box_of(twice, twice.parts[0]).high.x, 2 * box_of(once, once.parts[0]).high.x, 1e-9);
  EXPECT_NEAR(box_of(once, once.parts[0]).high.x, 0.1, 1e-9);
}

TEST_F(Cad, BrepIsInItsOwnUnit) {
  const std::string path = folder_.path("block.BREP");
  ASSERT_TRUE(BRepTools::Write(Engine().block(), path.c_str()));
  read(path);
  EXPECT_THAT(report_.notes, Contains(HasSubstr(" file units of them")));
  const Mesh mesh = read(path, {}, 0.001);
  ASSERT_THAT(paths(mesh), ElementsAre("block"));
  EXPECT_NEAR(box_of(mesh, mesh.parts[0]).high.x, 0.1, 1e-9);
}

TEST_F(Cad, AFaceThatItsTrianglesDoNotCoverIsMadeAnew) {
  // OpenCASCADE leaves a part of some cones out and doesn't say so. Here a file brings such triangles along.
  const TopoDS_Shape can = BRepPrimAPI_MakeCylinder(0.05, 0.1).Shape();
  const BRepMesh_IncrementalMesh made(can, 1e-4, false, 0.1);
  TopLoc_Location at;
  for (TopExp_Explorer it(can, TopAbs_FACE); it.More(); it.Next())
    if (const Handle(Poly_Triangulation) all = BRep_Tool::Triangulation(TopoDS::Face(it.Current()), at))
      all->ResizeTriangles(all->NbTriangles() - 1, true);
  ASSERT_TRUE(BRepTools::Write(can, folder_.path("can.brep").c_str()));
  const Mesh mesh = read(folder_.path("can.brep"), {.deflection_m = 1e-3, .angle_deg = 15, .part = {}});
  EXPECT_NEAR(oriented_volume(mesh) / exact_volume(can), 1, 0.02);  // a prism of 24 sides: 1.1 % less
}

TEST_F(Cad, FacesOfAnIgesFileAreSewnToABody) {
  for (const int solids : {0, 1}) {  // faces one by one, and solids
    IGESControl_Controller::Init();
    IGESControl_Writer writer("IN", solids);
    ASSERT_TRUE(writer.AddShape(Engine().block()));
    writer.ComputeModel();
    const std::string path = folder_.path("block.igs");
    ASSERT_TRUE(writer.Write(path.c_str()));
    const Mesh mesh = read(path, kFine);
    ASSERT_EQ(mesh.parts.size(), 1u);
    const double wanted = exact_volume(Engine().block()) * kCubicMm;
    EXPECT_NEAR(oriented_volume(mesh), wanted, kVolume * wanted) << solids;
    EXPECT_THAT(report_.notes, Contains(HasSubstr("unit of length is inch")));
  }
}

TEST_F(Cad, AProductOfSeveralBodiesHasAPartForEach) {
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  builder.Add(all, BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  builder.Add(all, BRepPrimAPI_MakeBox(gp_Pnt(5, 0, 0), 2, 2, 2).Shape());
  builder.Add(all, BRepPrimAPI_MakeBox(gp_Pnt(9, 0, 0), 2, 2, 2).Shell());
  const std::string path = folder_.path("three.brep");
  ASSERT_TRUE(BRepTools::Write(all, path.c_str()));
  const Mesh mesh = read(path);
  ASSERT_THAT(paths(mesh), ElementsAre("three/solid", "three/solid#2", "three/shell"));
  EXPECT_NEAR(volume(mesh, mesh.parts[0]), 6, 1e-9);
  EXPECT_NEAR(box_of(mesh, mesh.parts[2]).low.x, 9, 1e-9);
}

TEST_F(Cad, SolidsOfAProductHaveTheirNamesWhereverItStands) {
  Handle(TDocStd_Document) document = new TDocStd_Document("MDTV-XCAF");
  XCAFDoc_DocumentTool::Set(document->Main(), false);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TopoDS_Compound both;
  const BRep_Builder builder;
  builder.MakeCompound(both);
  builder.Add(both, BRepPrimAPI_MakeBox(1, 2, 3).Shape());
  builder.Add(both, BRepPrimAPI_MakeBox(gp_Pnt(5, 0, 0), 2, 2, 2).Shape());
  const TDF_Label pair = shapes->AddShape(both, false), all = shapes->NewShape();
  TDataStd_Name::Set(pair, "pair");
  TDataStd_Name::Set(all, "all");
  gp_Trsf away;
  away.SetTranslation(gp_Vec(100, 0, 0));
  shapes->AddComponent(all, pair, away);
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  ASSERT_TRUE(writer.Transfer(document, STEPControl_AsIs));
  const std::string path = folder_.path("pair.step");
  ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
  std::stringstream whole;
  whole << std::ifstream(path, std::ios::binary).rdbuf();
  std::string text = whole.str();
  constexpr std::string_view kNoName = "MANIFOLD_SOLID_BREP(''";
  for (const char* name : {"left", "right"}) {
    const std::size_t at = text.find(kNoName);
    ASSERT_NE(at, std::string::npos);
    text.insert(at + kNoName.size() - 1, name);
  }
  EXPECT_THAT(paths(read(folder_.write("named.step", text))), ElementsAre("all/pair/left", "all/pair/right"));
}

TEST_F(Cad, AFileOfCurvesHasNoTriangles) {
  const std::string path = folder_.path("edge.brep");
  ASSERT_TRUE(
      BRepTools::Write(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)).Shape(), path.c_str()));
  EXPECT_THAT(refused(path), HasSubstr("has no faces"));
}

TEST_F(Cad, DamagedFilesAreRefusedWithASentence) {
  std::ifstream in(engine("engine.step"), std::ios::binary);
  std::stringstream whole;
  whole << in.rdbuf();
  const std::string text = whole.str();
  EXPECT_THAT(refused(folder_.write("short.step", text.substr(0, text.size() / 2))),
              HasSubstr("is cut short"));
  std::string broken = text;
  broken.replace(broken.find("CARTESIAN_POINT"), 15, "CARTESIAN_POINT(");  // a bracket too many
  EXPECT_THAT(refused(folder_.write("syntax.step", broken)),
              AllOf(HasSubstr("breaks the rules of STEP files"), HasSubstr("Line")));
  broken = text;
  broken.replace(broken.find("VERTEX_POINT('',#") + 17, 1, "99999");
  EXPECT_THAT(refused(folder_.write("reference.step", broken)),
              AllOf(HasSubstr("breaks the rules of STEP files"), HasSubstr("Unresolved Reference")));
  EXPECT_THAT(refused(folder_.write("empty.stp", "")), HasSubstr("empty"));
  EXPECT_THAT(refused(folder_.write("other.step", "solid\nendsolid\n")), HasSubstr("is no STEP file"));
  EXPECT_THAT(refused(folder_.write("other.iges", "nothing")), HasSubstr("is no IGES file"));
  EXPECT_THAT(refused(folder_.write("other.brep", "nothing")), HasSubstr("is no BREP file"));
  EXPECT_THAT(refused(folder_.write("bare.step",
                                    "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")),
              HasSubstr("breaks the rules"));
}

class CadScene : public Cad {
 protected:
  Result<Scene> scene(const std::string& response = "", const std::string& more = "") {
    engine("engine.step");
    folder_.write(
        "scene.json",
        fmt::format(
            R"({{"static": [{{"mesh": "engine.step", "without": ["right bolt"]{}}}], "tool": {{"mesh": "engine.step", "part": "right bolt"}}{}}})",
            more, response));
    return read_scene(folder_.path("scene.json"));
  }
};

TEST_F(CadScene, ANamedPartIsTheToolAndTouchesItsAssembly) {
  auto read = scene();
  ASSERT_TRUE(read) << read.error().sentence;
  const auto loaded = load_scene(std::move(*read), {});
  ASSERT_TRUE(loaded) << loaded.error().sentence;
  EXPECT_THAT(loaded->geometry.tool_report.parts.size(), 1u);
  EXPECT_TRUE(loaded->geometry.tool.closed);
  const auto backend = make_ref_backend();
  ASSERT_TRUE(
      backend->prepare(loaded->geometry, decide_plan(query_facts(loaded->scene, loaded->geometry)).plan, {}));
  // The bolt stands on the plate: a millimetre down it is in it, a millimetre up it is free.
  for (const auto& [lift, contact] : {std::pair{-0.001, true}, std::pair{0.001, false}}) {
    const auto pose = to_lattice({{0, 0, lift}, Quat(1, 0, 0, 0)}, loaded->geometry);
    ASSERT_TRUE(pose);
    Contacts contacts;
    ASSERT_TRUE(backend->query(*pose, nullptr, contacts));
    EXPECT_EQ(contacts.contact, contact) << lift;
  }
}

TEST_F(CadScene, TessellationFollowsTheScene) {
  const auto triangles = [&](const std::string& response) -> std::size_t {
    auto read = scene(response);
    if (!read) return ADD_FAILURE() << read.error().sentence, 0;
    const auto meshes = import_scene(*read, {});
    if (!meshes) return ADD_FAILURE() << meshes.error().sentence, 0;
    return meshes->mockup.triangles.size();
  };
  const std::size_t usual = triangles("");
  EXPECT_GT(triangles(R"(, "response": {"tessellation": 1e-6})"), usual);
  EXPECT_GT(triangles(R"(, "response": {"sample_spacing": 1e-5})"), usual);
  EXPECT_GT(triangles(R"(, "response": {"voxel_size": 1e-5})"), usual);
  EXPECT_GT(triangles(R"(, "response": {"tessellation_angle_deg": 3})"), usual);
  EXPECT_EQ(triangles(R"(, "response": {"tessellation": "auto"})"), usual);
}

TEST_F(CadScene, UnitsBesideAFileThatStatesItsUnitAreRefused) {
  const auto read = scene("", R"(, "units": "mm")");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().sentence, AllOf(HasSubstr("/static/0/units"), HasSubstr("states its unit")));
  EXPECT_TRUE(scene("", R"(, "scale": 1)"));
}

TEST_F(CadScene, TheCacheKnowsTheTessellationApart) {
  const auto key = [&](const std::string& response) { return geometry_key(*scene(response)); };
  EXPECT_NE(key(R"(, "response": {"tessellation": 1e-4})"), key(""));
  EXPECT_NE(key(R"(, "response": {"tessellation_angle_deg": 10})"), key(""));
  ASSERT_TRUE(key(""));
}

TEST_F(Cad, AFileThatNamesOthersStandsNotAlone) {
  EXPECT_TRUE(stands_alone(engine("engine.step")));
  EXPECT_FALSE(stands_alone(folder_.write("names.stp", "#1=DOCUMENT_FILE('other.stp','','',#2,'','');")));
}

}  // namespace
}  // namespace palpate
