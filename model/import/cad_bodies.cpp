#include "model/import/cad_bodies.h"

#include <BRep_Builder.hxx>
#include <Quantity_Color.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include <algorithm>
#include <cmath>
#include <map>

namespace palpate {
namespace {

std::string text_of(const TCollection_ExtendedString& text) {
  std::string out(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  char* begin = out.data();
  out.resize(static_cast<std::size_t>(text.ToUTF8CString(begin)));
  return clean_name(out.c_str());
}

std::string label_name(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? text_of(name->Get()) : std::string();
}

TopoDS_Shape together(const std::vector<TopoDS_Shape>& shapes) {
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  for (const TopoDS_Shape& shape : shapes) builder.Add(all, shape);
  return all;
}

}  // namespace

Colour Colours::of(const TDF_Label& label) const {
  Quantity_Color colour;
  if (!tool_->GetColor(label, XCAFDoc_ColorSurf, colour) && !tool_->GetColor(label, XCAFDoc_ColorGen, colour))
    return {};
  double rgb[3];
  colour.Values(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB);
  std::uint32_t out = 0;
  for (const double part : rgb)
    out = out << 8 | static_cast<std::uint32_t>(std::lround(255 * std::clamp(part, 0.0, 1.0)));
  return out;
}

void Colours::learn(const TDF_Label& product) {
  TDF_LabelSequence within;
  XCAFDoc_ShapeTool::GetSubShapes(product, within);
  for (const TDF_Label& label : within) learn(XCAFDoc_ShapeTool::GetShape(label), of(label));
}

void Colours::learn(const TopoDS_Shape& shape, const Colour& colour) {
  if (colour && !shape.IsNull()) known_.Bind(shape.Located(TopLoc_Location()), static_cast<int>(*colour));
}

Colour Colours::of(const TopoDS_Shape& body) const {
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

void Bodies::add(const TDF_Label& label, const TopLoc_Location& above, const std::string& folder,
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

void Bodies::add(const TopoDS_Shape& shape, const std::string& path, const std::string& also,
                 const Colour& colour, const Colour& inherited) {
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

std::vector<Body> bodies_of(const Handle(TDocStd_Document) & document,
                            std::function<std::string(const TopoDS_Shape&)> name_of, Colours& colours) {
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
  Bodies bodies(std::move(name_of), colours);
  SiblingNames names;
  for (const TDF_Label& root : roots) bodies.add(root, {}, {}, names, {});
  return bodies.take();
}

}  // namespace palpate
