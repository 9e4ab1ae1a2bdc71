// read_mesh() of CAD files, STEP, IGES and BREP, for the program palpate-import-cad: OpenCASCADE reads and
// triangulates them.
#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Interface_ReportEntity.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Poly_Triangulation.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "model/files/file_view.h"
#include "model/files/one_line.h"
#include "model/import/mesh_read.h"
#include "model/import/part_names.h"
#include "model/lattice/lattice_build.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;
constexpr double kSewingMm =
    0.01;  ///< IGES faces whose edges are nearer belong together (chosen: what exporters round to)

constexpr double kFewestDeflections = 8;  ///< no body is made of triangles more coarsely than this part of
                                          ///< its longest side, whatever is asked for (chosen)

enum class Format { kStep, kIges, kBrep };

/// Hands on what the library tells of how far a stage is.
class StageProgress : public Message_ProgressIndicator {
 public:
  StageProgress(const TellHowFar& tell, ImportStage stage) : tell_(tell), stage_(stage) {}

 private:
  void Show(const Message_ProgressScope& /*scope*/, const Standard_Boolean /*force*/) override {
    constexpr double kWorthTelling = 1e-3;
    if (!tell_ || GetPosition() < told_ + kWorthTelling) return;
    told_ = GetPosition();
    tell_({stage_, told_});
  }

  const TellHowFar& tell_;
  ImportStage stage_;
  double told_ = 0;
};

/// As the library's functions take it.
Message_ProgressRange progress_of(const Handle(Message_ProgressIndicator) & progress) {
  return Message_ProgressIndicator::Start(progress);
}

using Colour = std::optional<std::uint32_t>;  ///< 0xrrggbb, sRGB

/// A body of the file where it stands in the assembly.
struct Body {
  std::string path, also;
  TopoDS_Shape shape;
  Colour colour;
};

std::string text_of(const TCollection_ExtendedString& text) {
  std::string out(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  char* begin = out.data();
  out.resize(static_cast<std::size_t>(text.ToUTF8CString(begin)));
  return clean_name(out.c_str());
}

/// "MILLIMETRE" as "millimetre".
std::string unit_name(const char* text) {
  std::string out = clean_name(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
}

std::string label_name(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? text_of(name->Get()) : std::string();
}

/// What the file colours: products, instances, and solids, shells and faces within a product.
class Colours {
 public:
  Colours() = default;
  explicit Colours(const Handle(TDocStd_Document) & document)
      : tool_(XCAFDoc_DocumentTool::ColorTool(document->Main())) {}

  /// Of a product or an instance.
  Colour of(const TDF_Label& label) const {
    Quantity_Color colour;
    if (!tool_->GetColor(label, XCAFDoc_ColorSurf, colour) &&
        !tool_->GetColor(label, XCAFDoc_ColorGen, colour))
      return {};
    double rgb[3];
    colour.Values(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB);
    std::uint32_t out = 0;
    for (const double part : rgb)
      out = out << 8 | static_cast<std::uint32_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
    return out;
  }

  /// Learns what is coloured within a product.
  void learn(const TDF_Label& product) {
    TDF_LabelSequence within;
    XCAFDoc_ShapeTool::GetSubShapes(product, within);
    for (const TDF_Label& label : within) learn(XCAFDoc_ShapeTool::GetShape(label), of(label));
  }
  void learn(const TopoDS_Shape& shape, const Colour& colour) {
    if (colour && !shape.IsNull()) known_.Bind(shape.Located(TopLoc_Location()), static_cast<int>(*colour));
  }

  /// Of a body within a product that has no colour itself: of its solids, else of its shells, else of most of
  /// its faces that have one.
  Colour of(const TopoDS_Shape& body) const {
    if (known_.IsEmpty()) return {};
    for (const TopAbs_ShapeEnum kind : {TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE}) {
      std::map<int, std::size_t> counts;
      for (TopExp_Explorer it(body, kind); it.More(); it.Next())
        if (const int* colour = known_.Seek(it.Current().Located(TopLoc_Location()))) ++counts[*colour];
      if (!counts.empty())
        return static_cast<std::uint32_t>(
            std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
              return a.second < b.second;
            })->first);
    }
    return {};
  }

 private:
  Handle(XCAFDoc_ColorTool) tool_;
  TopTools_DataMapOfShapeInteger known_;  ///< shapes where their product has them, without their locations
};

/// Lists the bodies of shapes and assemblies, depth first.
class Bodies {
 public:
  /// `name_of`: the name that the file gives a solid within a shape; may be empty.
  Bodies(std::function<std::string(const TopoDS_Shape&)> name_of, Colours& colours)
      : name_of_(std::move(name_of)), colours_(colours) {}

  /// `inherited`: the colour of the nearest assembly above that has one.
  void add(const TDF_Label& label, const TopLoc_Location& above, const std::string& folder,
           SiblingNames& siblings, const Colour& inherited) {
    TDF_Label product = label;
    TopLoc_Location here = above;
    std::string instance;
    Colour colour = colours_.of(label);
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      XCAFDoc_ShapeTool::GetReferredShape(label, product);
      here = above * XCAFDoc_ShapeTool::GetLocation(label);
      instance = label_name(label);
      if (!colour) colour = colours_.of(product);
    }
    std::string name = label_name(product);
    if (name.empty()) name = instance.empty() ? "part" : instance;
    const std::string path = folder + siblings.unique(name);
    if (!XCAFDoc_ShapeTool::IsAssembly(product)) {
      colours_.learn(product);
      return add(XCAFDoc_ShapeTool::GetShape(product).Moved(here), path,
                 instance == name ? std::string() : instance, colour, inherited);
    }
    TDF_LabelSequence children;
    XCAFDoc_ShapeTool::GetComponents(product, children);
    SiblingNames names;
    for (const TDF_Label& child : children) add(child, here, path + "/", names, colour ? colour : inherited);
  }

  /// A shape with several solids is so many bodies below `path`. `colour` is the whole shape's, `inherited`
  /// goes where nothing within has one.
  void add(const TopoDS_Shape& shape, const std::string& path, const std::string& also,
           const Colour& colour = {}, const Colour& inherited = {}) {
    const auto colour_of = [&](const TopoDS_Shape& body) {
      if (colour) return colour;
      const Colour own = colours_.of(body);
      return own ? own : inherited;
    };
    std::vector<TopoDS_Shape> solids, shells, faces;
    for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) solids.push_back(it.Current());
    for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next())
      shells.push_back(it.Current());
    for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next())
      faces.push_back(it.Current());
    if (solids.size() + shells.size() + (faces.empty() ? 0 : 1) == 1) {
      bodies_.push_back({path, also, shape, colour_of(shape)});
      return;
    }
    SiblingNames names;
    for (const auto* list : {&solids, &shells})
      for (const TopoDS_Shape& body : *list) {
        const std::string name = name_of_(body.Located(TopLoc_Location()));
        bodies_.push_back({path + "/" +
                               names.unique(!name.empty()     ? name
                                            : list == &solids ? "solid"
                                                              : "shell"),
                           {},
                           body,
                           colour_of(body)});
      }
    if (faces.empty()) return;
    const TopoDS_Shape rest = together(faces);
    bodies_.push_back({path + "/" + names.unique("faces"), {}, rest, colour_of(rest)});
  }

  std::vector<Body> take() { return std::move(bodies_); }

  static TopoDS_Shape together(const std::vector<TopoDS_Shape>& shapes) {
    TopoDS_Compound all;
    const BRep_Builder builder;
    builder.MakeCompound(all);
    for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
    return all;
  }

 private:
  std::function<std::string(const TopoDS_Shape&)> name_of_;
  Colours& colours_;
  std::vector<Body> bodies_;
};

/// All bodies of a document that a reader has filled.
std::vector<Body> bodies_of(const Handle(TDocStd_Document) & document,
                            std::function<std::string(const TopoDS_Shape&)> name_of, Colours& colours) {
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
  Bodies bodies(std::move(name_of), colours);
  SiblingNames names;
  for (const TDF_Label& root : roots) bodies.add(root, {}, {}, names, {});
  return bodies.take();
}

Handle(TDocStd_Document) new_document() {
  Handle(TDocStd_Document) document = new TDocStd_Document("MDTV-XCAF");
  XCAFDoc_DocumentTool::Set(document->Main(), false);
  return document;
}

/// What a file's text breaks of the rules, syntax and references to what does not exist: the rest of a
/// sentence that begins with the file's name. The library would drop what is concerned without a word, or
/// crash over it.
std::string broken_text(const Handle(Interface_InterfaceModel) & model) {
  const Handle(Interface_Check) check = model->GlobalCheck(true);
  if (check.IsNull() || !check->HasFailed()) return {};
  return fmt::format("breaks the rules of STEP files in {} {}, first: {}", check->NbFails(),
                     check->NbFails() == 1 ? "place" : "places", one_line(clean_name(check->CFail(1))));
}

/// Points, curves, surfaces and faces of which the library has read something wrong. It goes on with the
/// others, and may crash over them: so this goes to standard error, too, of which the last line is told when
/// that happens.
void note_broken_shapes(const Handle(Interface_InterfaceModel) & model, ImportReport& report) {
  std::size_t broken = 0;
  std::string first;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const std::string_view type = model->Value(i)->DynamicType()->Name();
    if (!model->IsReportEntity(i) || !(type.starts_with("StepGeom_") || type.starts_with("StepShape_")))
      continue;
    const Handle(Interface_Check) check = model->ReportEntity(i)->Check();
    if (check->HasFailed() && ++broken == 1) first = one_line(clean_name(check->CFail(1)));
  }
  if (broken == 0) return;
  report.notes.push_back(fmt::format("{} entities of its shapes break the rules, first: {}", broken, first));
  fmt::print(stderr, "{}\n", report.notes.back());
}

/// Faces that the file has and the library could not make.
std::size_t lost_faces(const Handle(XSControl_WorkSession) & session) {
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  const Handle(Interface_InterfaceModel) model = session->Model();
  std::size_t lost = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) continue;
    const Handle(Transfer_Binder) binder = process->Find(entity);
    if (!binder.IsNull() && !binder->HasResult()) ++lost;
  }
  return lost;
}

Result<std::vector<Body>> read_step(const std::string& path, ImportReport& report, const TellHowFar& tell,
                                    bool with_colours) {
  STEPCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(with_colours);
  reader.SetLayerMode(false), reader.SetPropsMode(false);
  reader.SetGDTMode(false), reader.SetMatMode(false), reader.SetViewMode(false), reader.SetSHUOMode(false);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    return bad_value(
        fmt::format("'{}' can't be read: it breaks the rules of STEP files (ISO 10303-21)", path));
  const Handle(Interface_InterfaceModel) model = reader.Reader().WS()->Model();
  if (const std::string wrong = broken_text(model); !wrong.empty())
    return bad_value(fmt::format("'{}' {}", path, wrong));
  note_broken_shapes(model, report);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  Handle(TDocStd_Document) document = new_document();
  const Handle(StageProgress) progress = new StageProgress(tell, ImportStage::kShapes);
  if (!reader.Transfer(document, progress_of(progress)))
    return bad_value(fmt::format("'{}' has no shape that can be read", path));
  std::string unit;
  for (const TCollection_AsciiString& length : lengths)
    unit += (unit.empty() ? "" : ", ") + unit_name(length.ToCString());
  report.notes.push_back(
      unit.empty() ? "it states no unit of length, millimetres were taken; coordinates are in metres"
                   : fmt::format("its unit of length is {}; coordinates are in metres", unit));
  const Handle(XSControl_WorkSession) session = reader.Reader().WS();
  if (const std::size_t lost = lost_faces(session))
    report.notes.push_back(fmt::format("{} faces could not be read and are left out", lost));
  const auto name_of = [transfer = session->TransferReader()](const TopoDS_Shape& shape) {
    const auto item =
        Handle(StepRepr_RepresentationItem)::DownCast(transfer->EntityFromShapeResult(shape, 1));
    return item.IsNull() || item->Name().IsNull() ? std::string() : clean_name(item->Name()->ToCString());
  };
  Colours colours(document);
  return bodies_of(document, name_of, colours);
}

/// IGES has faces one by one, and some the wrong way round: those whose edges meet are joined, so that a body
/// is closed again. Which side is out is found out for all formats in the same way
/// (model/mesh/orientation.h).
std::vector<Body> sew(std::vector<Body> bodies, const std::string& name, const Colours& colours) {
  BRepBuilderAPI_Sewing sewing(kSewingMm);
  std::vector<Body> out, loose;
  for (Body& body : bodies)
    if (TopExp_Explorer(body.shape, TopAbs_SOLID).More()) {
      out.push_back(std::move(body));
    } else {
      sewing.Add(body.shape);
      loose.push_back(std::move(body));
    }
  if (loose.empty()) return out;
  sewing.Perform();
  Colours kept;
  for (const Body& body : loose)
    for (TopExp_Explorer it(body.shape, TopAbs_FACE); it.More(); it.Next()) {
      const Colour own = colours.of(it.Current());
      kept.learn(sewing.ModifiedSubShape(it.Current()), own ? own : body.colour);
    }
  Bodies sewn([](const TopoDS_Shape&) { return std::string(); }, kept);
  sewn.add(sewing.SewedShape(), name, {});
  for (Body& body : sewn.take()) out.push_back(std::move(body));
  return out;
}

Result<std::vector<Body>> read_iges(const std::string& path, const std::string& name, ImportReport& report,
                                    const TellHowFar& tell, bool with_colours) {
  IGESCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(with_colours), reader.SetLayerMode(false);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    return bad_value(fmt::format("'{}' can't be read: it breaks the rules of IGES files", path));
  const Handle(IGESData_IGESModel) model = Handle(IGESData_IGESModel)::DownCast(reader.Model());
  Handle(TDocStd_Document) document = new_document();
  const Handle(StageProgress) progress = new StageProgress(tell, ImportStage::kShapes);
  if (!reader.Transfer(document, progress_of(progress)))
    return bad_value(fmt::format("'{}' has no shape that can be read", path));
  const Handle(TCollection_HAsciiString) unit =
      model.IsNull() ? Handle(TCollection_HAsciiString)() : model->GlobalSection().UnitName();
  report.notes.push_back(
      unit.IsNull()
          ? "it states no unit of length, millimetres were taken; coordinates are in metres"
          : fmt::format("its unit of length is {}; coordinates are in metres", unit_name(unit->ToCString())));
  Colours colours(document);
  return sew(bodies_of(
                 document, [](const TopoDS_Shape&) { return std::string(); }, colours),
             name, colours);
}

Result<std::vector<Body>> read_brep(const std::string& path, const std::string& name,
                                    const TellHowFar& tell) {
  TopoDS_Shape shape;
  const Handle(StageProgress) progress = new StageProgress(tell, ImportStage::kRead);
  if (!BRepTools::Read(shape, path.c_str(), BRep_Builder(), progress_of(progress)) || shape.IsNull())
    return bad_value(fmt::format("'{}' can't be read: it breaks the rules of BREP files", path));
  Colours none;
  Bodies bodies([](const TopoDS_Shape&) { return std::string(); }, none);
  bodies.add(shape, name, {});
  return bodies.take();
}

/// What the library would not notice: a file that ends too early.
std::string distrust(Format format, std::string_view bytes) {
  if (format == Format::kStep) {
    if (bytes.substr(0, 4096).find("ISO-10303-21") == std::string_view::npos)
      return "is no STEP file: ISO-10303-21 does not stand at its beginning";
    if (bytes.substr(bytes.size() - std::min<std::size_t>(bytes.size(), 4096)).find("END-ISO-10303-21") ==
        std::string_view::npos)
      return "is cut short: END-ISO-10303-21 does not stand at its end";
  }
  if (format == Format::kIges) {
    constexpr std::size_t kSection = 72;  // the letter of a line's section
    if (bytes.size() <= kSection || bytes[kSection] != 'S')
      return "is no IGES file of text lines: its first line has no S in column 73";
    const std::size_t last = bytes.find_last_not_of("\r\n \t"), begin = bytes.rfind('\n', last);
    if (begin == std::string_view::npos || last - begin <= kSection || bytes[begin + 1 + kSection] != 'T')
      return "is cut short: its last line has no T in column 73";
  }
  if (format == Format::kBrep && bytes.substr(0, 4096).find("CASCADE Topology") == std::string_view::npos)
    return "is no BREP file: 'CASCADE Topology' does not stand at its beginning";
  return {};
}

/// Triangles of the bodies' faces.
class Triangulator {
 public:
  /// `unit_m`: metres per unit of the shapes.
  Triangulator(const std::string& file, double unit_m) : file_(file), unit_m_(unit_m) {}

  Result<Mesh> run(const std::vector<Body>& bodies, const Tessellation& tessellation, ImportReport& report,
                   const TellHowFar& tell) {
    const Result<double> deflection = deflection_for(bodies, tessellation);
    if (!deflection) return deflection.error();
    IMeshTools_Parameters parameters;
    parameters.Angle = tessellation.angle_deg * std::numbers::pi / 180;
    parameters.AngleInterior = parameters.Angle;
    TopTools_DataMapOfShapeShape done;  // instances share their triangles, too
    std::size_t number = 0;
    for (const Body& body : bodies) {
      if (tell)
        tell({ImportStage::kTriangles, static_cast<double>(number++) / static_cast<double>(bodies.size())});
      const TopoDS_Shape own = body.shape.Located(TopLoc_Location());
      if (!done.IsBound(own)) {
        parameters.Deflection = std::min(*deflection, longest_side(own) / kFewestDeflections) / unit_m_;
        parameters.DeflectionInterior = parameters.Deflection;
        parameters.MinSize =
            parameters.Deflection / 10;  // edges shorter than that are not divided for the angle's sake
        done.Bind(own, with_triangles(own, parameters));
      }
      if (std::string wrong =
              add({body.path, body.also, done.Find(own).Moved(body.shape.Location()), body.colour});
          !wrong.empty())
        return bad_value(fmt::format("'{}' {}", file_, wrong));
    }
    if (mesh_.triangles.empty())
      return bad_value(fmt::format("'{}' has no faces of which triangles can be made", file_));
    if (flat_)
      report.notes.push_back(fmt::format("{} faces gave no triangles, the first is face {} of '{}'", flat_,
                                         first_flat_, flat_path_));
    report.notes.push_back(
        fmt::format("{} faces became triangles, about {:.4g} m from them at most, {:.4g}° between neighbours",
                    faces_, *deflection, tessellation.angle_deg));
    return std::move(mesh_);
  }

 private:
  static std::size_t faces_without_triangles(const TopoDS_Shape& shape) {
    std::size_t count = 0;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
      TopLoc_Location location;
      const Handle(Poly_Triangulation) triangulation =
          BRep_Tool::Triangulation(TopoDS::Face(it.Current()), location);
      if (triangulation.IsNull() || triangulation->NbTriangles() == 0) ++count;
    }
    return count;
  }

  /// The shape, or one of the same form that the library can make triangles of: it fails on some cones, and
  /// not where they are spline surfaces.
  static TopoDS_Shape with_triangles(const TopoDS_Shape& shape, const IMeshTools_Parameters& parameters) {
    BRepMesh_IncrementalMesh(shape, parameters);
    const std::size_t without = faces_without_triangles(shape);
    if (without == 0) return shape;
    try {
      const TopoDS_Shape splines = BRepBuilderAPI_NurbsConvert(shape, true).Shape();
      BRepMesh_IncrementalMesh(splines, parameters);
      return faces_without_triangles(splines) < without ? splines : shape;
    } catch (const Standard_Failure&) {
      return shape;
    }
  }

  /// Metres.
  double longest_side(const Bnd_Box& box) const {
    double low[3], high[3];
    box.Get(low[0], low[1], low[2], high[0], high[1], high[2]);
    return unit_m_ * std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  }
  double longest_side(const TopoDS_Shape& shape) const {
    Bnd_Box box;
    BRepBndLib::Add(shape, box, false);
    return box.IsVoid() ? INFINITY : longest_side(box);
  }

  /// Metres. What `auto` measures is a box of the exact shapes.
  Result<double> deflection_for(const std::vector<Body>& bodies, const Tessellation& tessellation) {
    if (tessellation.deflection_m > 0) return tessellation.deflection_m;
    std::vector<MeshPart> parts;
    for (const Body& body : bodies) parts.push_back({body.path, 0, 0, body.also});
    std::string node;
    if (!tessellation.part.empty()) {
      Result<std::string> found = find_node(parts, tessellation.part, file_);
      if (!found) return found.error();
      node = std::move(*found);
    }
    Bnd_Box box;
    for (const Body& body : bodies)
      if (node.empty() || is_below(body.path, node)) BRepBndLib::Add(body.shape, box, false);
    if (box.IsVoid()) return bad_value(fmt::format("'{}' has no faces, only curves or points", file_));
    const double longest = longest_side(box);
    if (!(longest > 0) || !std::isfinite(longest))
      return bad_value(fmt::format("'{}' is {} m long; it can't be made of triangles", file_, longest));
    return longest / kDeflectionsPerSide;
  }

  std::string add(const Body& body) {
    const std::size_t first = mesh_.triangles.size();
    std::size_t number = 0;
    for (TopExp_Explorer it(body.shape, TopAbs_FACE); it.More(); it.Next(), ++number) {
      const TopoDS_Face& face = TopoDS::Face(it.Current());
      TopLoc_Location location;
      const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
      ++faces_;
      if (triangulation.IsNull() || triangulation->NbTriangles() == 0) {
        if (++flat_ == 1) first_flat_ = number, flat_path_ = body.path;
        continue;
      }
      if (std::string wrong = add(*triangulation, location.Transformation(),
                                  face.Orientation() == TopAbs_REVERSED, body.path);
          !wrong.empty())
        return wrong;
    }
    if (mesh_.triangles.size() > first)
      mesh_.parts.push_back({body.path, static_cast<std::uint32_t>(first),
                             static_cast<std::uint32_t>(mesh_.triangles.size() - first), body.also,
                             body.colour});
    return {};
  }

  std::string add(const Poly_Triangulation& triangulation, const gp_Trsf& transform, bool reversed,
                  const std::string& path) {
    const std::size_t base = mesh_.vertices.size(), nodes = static_cast<std::size_t>(triangulation.NbNodes()),
                      count = static_cast<std::size_t>(triangulation.NbTriangles());
    if (mesh_.triangles.size() + count > kMaxTriangles || base + nodes > 3 * kMaxTriangles)
      return fmt::format("becomes more than {} triangles; a larger tessellation makes fewer", kMaxTriangles);
    for (int i = 1; i <= triangulation.NbNodes(); ++i) {
      const gp_Pnt point = triangulation.Node(i).Transformed(transform);
      const Vec3 metres = unit_m_ * Vec3(point.X(), point.Y(), point.Z());
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(metres[k]) <= kLargestCoordinate))
          return fmt::format("has coordinate {} m in '{}', which is not a number within ±{} m", metres[k],
                             path, kLargestCoordinate);
      mesh_.vertices.push_back(metres);
    }
    const bool turned =
        reversed != (transform.VectorialPart().Determinant() < 0);  // a mirror turns faces round
    for (int i = 1; i <= triangulation.NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      triangulation.Triangle(i).Get(a, b, c);
      if (turned) std::swap(b, c);
      const auto vertex = [&](int node) {
        return static_cast<std::uint32_t>(base + static_cast<std::size_t>(node) - 1);
      };
      mesh_.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    }
    return {};
  }

  const std::string& file_;
  double unit_m_;
  Mesh mesh_;
  std::size_t faces_ = 0, flat_ = 0, first_flat_ = 0;
  std::string flat_path_;
};

Format format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  if (ending == ".igs" || ending == ".iges") return Format::kIges;
  return ending == ".brep" || ending == ".brp" ? Format::kBrep : Format::kStep;
}

}  // namespace

Result<Mesh> read_mesh(const std::string& path, double scale, ImportReport& report, const std::string& folder,
                       const Tessellation& tessellation, const TellHowFar& tell, bool colours) {
  report = {path, {}};
  const Format format = format_of(path);
  {
    const Result<FileView> file = FileView::open(path);
    if (!file) return file.error();
    const std::string_view bytes = file->bytes();
    if (const std::string wrong = distrust(format, bytes); !wrong.empty())
      return bad_value(fmt::format("'{}' {}", path, wrong));
    if (!folder.empty() && bytes.find("DOCUMENT_FILE") != std::string_view::npos)
      return bad_value(fmt::format("'{}' names other files (DOCUMENT_FILE); export it as one file", path));
  }
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  try {
    const std::string name = clean_name(std::filesystem::path(path).stem().string());
    Result<std::vector<Body>> bodies = format == Format::kStep ? read_step(path, report, tell, colours)
                                       : format == Format::kIges
                                           ? read_iges(path, name, report, tell, colours)
                                           : read_brep(path, name, tell);
    if (!bodies) return bodies.error();
    return Triangulator(path, scale * (format == Format::kBrep ? 1 : kMetresPerMillimetre))
        .run(*bodies, tessellation, report, tell);
  } catch (const Standard_Failure& failure) {
    return bad_value(fmt::format(
        "'{}' can't be read: {}", path,
        one_line(failure.GetMessageString() && *failure.GetMessageString() ? failure.GetMessageString()
                                                                           : failure.DynamicType()->Name())));
  } catch (const std::exception& error) {
    return bad_value(fmt::format("'{}' can't be read: {}", path, one_line(error.what())));
  }
}

}  // namespace palpate
