#include "model/import/cad_triangles.h"

#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/lattice/lattice_build.h"
#include "model/mesh/weld.h"

namespace palpate {
namespace {

constexpr double kFewestDeflections = 8;  ///< no body is made of triangles more coarsely than this part of
                                          ///< its longest side, whatever is asked for (chosen)

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
    const BRepMesh_IncrementalMesh made(shape, parameters);
    const std::size_t without = faces_without_triangles(shape);
    if (without == 0) return shape;
    try {
      const TopoDS_Shape splines = BRepBuilderAPI_NurbsConvert(shape, true).Shape();
      const BRepMesh_IncrementalMesh made_anew(splines, parameters);
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

}  // namespace

Result<Mesh> triangles_of(const std::vector<Body>& bodies, const std::string& file, double unit_m,
                          const Tessellation& tessellation, ImportReport& report, const TellHowFar& tell) {
  return Triangulator(file, unit_m).run(bodies, tessellation, report, tell);
}

}  // namespace palpate
