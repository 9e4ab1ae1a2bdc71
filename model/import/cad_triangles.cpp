#include "model/import/cad_triangles.h"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "model/import/bad_coordinate.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr double kFewestDeflections = 8;  ///< no body is made of triangles more coarsely than this part of
                                          ///< its longest side, whatever is asked for (chosen)

class Triangulator {
 public:
  Triangulator(const std::string& file, const FileUnit& unit)
      : file_(file), unit_m_(unit.metres), unit_name_(unit.name) {}

  Result<Mesh> run(const std::vector<Body>& bodies, const Tessellation& tessellation, ImportReport& report,
                   const TellHowFar& tell) {
    const Result<double> deflection = deflection_for(bodies, tessellation);
    if (!deflection) return deflection.error();
    IMeshTools_Parameters parameters;
    parameters.Angle = tessellation.angle_deg * std::numbers::pi / 180;
    parameters.AngleInterior = parameters.Angle;
    TopTools_DataMapOfShapeShape done;  // instances share their triangles, too
    std::size_t number = 0;
    double largest = 0;  // deflection, m
    for (const Body& body : bodies) {
      if (tell)
        tell({ImportStage::kTriangles, static_cast<double>(number++) / static_cast<double>(bodies.size())});
      const TopoDS_Shape own = body.shape.Located(TopLoc_Location());
      if (!done.IsBound(own)) {
        const double used = std::min(*deflection, longest_side(own) / kFewestDeflections);
        largest = std::max(largest, used);
        parameters.Deflection = used / unit_m_;
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
      return bad_value(
          fmt::format("'{}' has no faces of which triangles can be made (at most {:.3g} {} from them)", file_,
                      *deflection, unit_name_));
    if (flat_)
      report.notes.push_back(fmt::format("{} faces gave no triangles, the first is face {} of '{}'", flat_,
                                         first_flat_, flat_path_));
    report.notes.push_back(fmt::format(
        "{} faces became triangles, to lie within about {:.4g} {} of them, {:.4g}° between neighbours",
        faces_, largest, unit_name_, tessellation.angle_deg));
    return std::move(mesh_);
  }

 private:
  using Link = std::pair<int, int>;  ///< nodes of a triangulation, ascending

  /// Whether a face's triangles end at its edges and nowhere else, but for what is as short as `least`.
  static bool is_covered(const TopoDS_Face& face, double least) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return false;
    std::vector<Link> sides, border;  // of triangles; of the face
    const auto add = [&](std::vector<Link>& to, int a, int b) {
      if (triangulation->Node(a).Distance(triangulation->Node(b)) > least)
        to.emplace_back(std::min(a, b), std::max(a, b));
    };
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      int a = 0, b = 0, c = 0;
      triangulation->Triangle(i).Get(a, b, c);
      add(sides, a, b);
      add(sides, b, c);
      add(sides, c, a);
    }
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const Handle(Poly_PolygonOnTriangulation) edge =
          BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(it.Current()), triangulation, location);
      if (edge.IsNull()) continue;  // a cone's tip, or the like
      for (int i = 1; i < edge->NbNodes(); ++i) add(border, edge->Node(i), edge->Node(i + 1));
    }
    std::sort(sides.begin(), sides.end());
    std::sort(border.begin(), border.end());
    for (auto side = sides.begin(); side != sides.end();) {
      const auto next = std::find_if(side, sides.end(), [&](const Link& other) { return other != *side; });
      if (next - side == 1 && !std::binary_search(border.begin(), border.end(), *side)) return false;
      side = next;
    }
    return std::all_of(border.begin(), border.end(), [&](const Link& wanted) {
      return std::binary_search(sides.begin(), sides.end(), wanted);
    });
  }

  static std::size_t faces_not_covered(const TopoDS_Shape& shape, double least) {
    std::size_t count = 0;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
      if (!is_covered(TopoDS::Face(it.Current()), least)) ++count;
    return count;
  }

  /// The shape, or one of the same form that the library can make triangles of: of some cones it makes none,
  /// or leaves a part out, but not where they are spline surfaces.
  static TopoDS_Shape with_triangles(const TopoDS_Shape& shape, const IMeshTools_Parameters& parameters) {
    const BRepMesh_IncrementalMesh made(shape, parameters);
    const double least = parameters.Deflection / 1000;  // chosen: far below what triangles are off by
    const std::size_t wanting = faces_not_covered(shape, least);
    if (wanting == 0) return shape;
    try {
      const TopoDS_Shape splines = BRepBuilderAPI_NurbsConvert(shape, true).Shape();
      const BRepMesh_IncrementalMesh made_anew(splines, parameters);
      return faces_not_covered(splines, least) < wanting ? splines : shape;
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
    parts.reserve(bodies.size());
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
          return bad_coordinate(metres[k], fmt::format("'{}'", path));
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
  const char* unit_name_;
  Mesh mesh_;
  std::size_t faces_ = 0, flat_ = 0, first_flat_ = 0;
  std::string flat_path_;
};

}  // namespace

Result<Mesh> triangles_of(const std::vector<Body>& bodies, const std::string& file, const FileUnit& unit,
                          const Tessellation& tessellation, ImportReport& report, const TellHowFar& tell) {
  return Triangulator(file, unit).run(bodies, tessellation, report, tell);
}

}  // namespace palpate
