// read_mesh() of CAD files, STEP, IGES and BREP, for the program palpate-import-cad: OpenCASCADE reads and
// triangulates them.
#include <fmt/format.h>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
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
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <vector>

#include "model/files/file_view.h"
#include "model/files/one_line.h"
#include "model/import/cad_bodies.h"
#include "model/import/cad_triangles.h"
#include "model/import/mesh_read.h"
#include "model/import/part_names.h"

namespace palpate {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;
constexpr double kSewingMm =
    0.01;  ///< IGES faces whose edges are nearer belong together (chosen: what exporters round to)

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

/// "MILLIMETRE" as "millimetre".
std::string unit_name(const char* text) {
  std::string out = clean_name(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return out;
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
  const Result<FileView> file = FileView::open(path);
  if (!file) return file.error();
  // At a file's end the library looks for what it misses without end; a last number ends with its line.
  std::istringstream in(std::string(file->bytes()) + '\n');
  in.exceptions(std::ios::eofbit);
  try {
    BRepTools::Read(shape, in, BRep_Builder(), progress_of(progress));
  } catch (const std::ios_base::failure&) {
    return bad_value(fmt::format("'{}' is cut short: it ends before its shapes do", path));
  }
  if (shape.IsNull())
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
    const bool is_unknown = format == Format::kBrep && scale == 1;
    const FileUnit unit{scale * (format == Format::kBrep ? 1 : kMetresPerMillimetre),
                        is_unknown ? "file units" : "m"};
    return triangles_of(*bodies, path, unit, tessellation, report, tell);
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
