// Writes a STEP file of boxes and cylinders, millimetres, by OpenCASCADE's own writer: write_step OUT < LINES
// (service/viewer/tests/gearbox.mjs has the lines). For the tutorial's assembly.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_PrinterOStream.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>
#include <string>

namespace {

TDF_Label called(const TDF_Label& label, const std::string& name) {
  TDataStd_Name::Set(label, name.c_str());
  return label;
}

TopoDS_Shape cylinder(const gp_Pnt& at, const gp_Dir& axis, double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(at, axis), radius, height).Shape();
}

/// The rest of a line: a box or a cylinder. Null: neither.
TopoDS_Shape solid_of(std::istringstream& line) {
  std::string kind, axis;
  double x = 0, y = 0, z = 0;
  line >> kind >> x >> y >> z;
  const gp_Pnt at(x, y, z);
  if (kind == "box") {
    double dx = 0, dy = 0, dz = 0;
    if (!(line >> dx >> dy >> dz)) return {};
    return BRepPrimAPI_MakeBox(at, dx, dy, dz).Shape();
  }
  double radius = 0, height = 0, bore = 0;
  if (kind != "cylinder" || !(line >> axis >> radius >> height >> bore)) return {};
  const gp_Dir way = axis == "y" ? gp::DY() : axis == "x" ? gp::DX() : gp::DZ();
  const TopoDS_Shape full = cylinder(at, way, radius, height);
  return bore > 0 ? BRepAlgoAPI_Cut(full, cylinder(at, way, bore, height)).Shape() : full;
}

int write(const char* out) {
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_PrinterOStream));
  const Handle(TDocStd_Document) document = new TDocStd_Document("MDTV-XCAF");
  XCAFDoc_DocumentTool::Set(document->Main(), false);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TDF_Label root = called(shapes->NewShape(), "gearbox");
  std::map<std::string, TDF_Label> groups;
  std::string text;
  while (std::getline(std::cin, text)) {
    std::istringstream line(text);
    std::string name, above, colour;
    line >> name >> above >> colour;
    const TopoDS_Shape solid = solid_of(line);
    unsigned rgb = 0;
    if (solid.IsNull() || std::sscanf(colour.c_str(), "#%6x", &rgb) != 1) {
      std::cerr << "no solid: " << text << "\n";
      return 1;
    }
    const TDF_Label part = called(shapes->AddShape(solid, false), name);
    colours->SetColor(part,
                      Quantity_Color((rgb >> 16 & 255u) / 255.0, (rgb >> 8 & 255u) / 255.0,
                                     (rgb & 255u) / 255.0, Quantity_TOC_sRGB),
                      XCAFDoc_ColorSurf);
    TDF_Label parent = root;
    if (above != "-") {
      if (!groups.contains(above)) groups[above] = called(shapes->NewShape(), above);
      parent = groups[above];
    }
    called(shapes->AddComponent(parent, part, TopLoc_Location()), name);
  }
  for (const auto& [name, group] : groups) called(shapes->AddComponent(root, group, TopLoc_Location()), name);
  shapes->UpdateAssemblies();
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.unit", "MM");
  STEPCAFControl_Writer writer;
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  return writer.Transfer(document, STEPControl_AsIs) && writer.Write(out) == IFSelect_RetDone ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "write_step OUT < LINES\n";
    return 2;
  }
  return write(arguments[1]);
}
