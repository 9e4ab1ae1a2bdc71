#pragma once
#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Shape.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/import/part_names.h"

namespace palpate {

using Colour = std::optional<std::uint32_t>;  ///< 0xrrggbb, sRGB

/// A body of the file where it stands in the assembly.
struct Body {
  std::string path, also;
  TopoDS_Shape shape;
  Colour colour;
};

/// What the file colours: products, instances, and solids, shells and faces within a product.
class Colours {
 public:
  Colours() = default;
  explicit Colours(const Handle(TDocStd_Document) & document)
      : tool_(XCAFDoc_DocumentTool::ColorTool(document->Main())) {}

  /// Of a product or an instance.
  Colour of(const TDF_Label& label) const;

  /// Learns what is coloured within a product.
  void learn(const TDF_Label& product);
  void learn(const TopoDS_Shape& shape, const Colour& colour);

  /// Of a body within a product that has no colour itself: of its solids, else of its shells, else of most of
  /// its faces that have one.
  Colour of(const TopoDS_Shape& body) const;

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
           SiblingNames& siblings, const Colour& inherited);

  /// A shape with several solids is so many bodies below `path`. `colour` is the whole shape's, `inherited`
  /// goes where nothing within has one.
  void add(const TopoDS_Shape& shape, const std::string& path, const std::string& also,
           const Colour& colour = {}, const Colour& inherited = {});

  std::vector<Body> take() { return std::move(bodies_); }

 private:
  std::function<std::string(const TopoDS_Shape&)> name_of_;
  Colours& colours_;
  std::vector<Body> bodies_;
};

/// All bodies of a document that a reader has filled.
std::vector<Body> bodies_of(const Handle(TDocStd_Document) & document,
                            std::function<std::string(const TopoDS_Shape&)> name_of, Colours& colours);

}  // namespace palpate
