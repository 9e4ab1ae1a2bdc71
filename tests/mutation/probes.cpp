#include "tests/mutation/probes.h"

#include <bit>
#include <stdexcept>

#include "cpu_ref/box_tree.h"
#include "cpu_ref/brick_classes.h"
#include "cpu_ref/direction.h"
#include "cpu_ref/partition.h"
#include "cpu_ref/ray.h"
#include "cpu_ref/samples.h"
#include "cpu_ref/triangle_cube.h"
#include "cpu_ref/triangle_triangle.h"
#include "model/contact/response.h"
#include "model/mesh/smooth_angle.h"
#include "model/scene/geometry_build.h"
#include "tests/compute/geometry_cases.h"

namespace palpate::mutation {
namespace {

using namespace cpu_ref;

/// Answers one after the other, in one number (FNV-1a).
class Sum {
 public:
  void add(std::int64_t answer) {
    for (int byte = 0; byte < 8; ++byte)
      value_ = (value_ ^ static_cast<std::uint8_t>(answer >> (8 * byte))) * 0x100000001b3u;
  }
  void add(const Int3& p) {
    for (int k = 0; k < 3; ++k) add(p[k]);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

Triangle any_triangle(LatticePoints& points) {
  Int3 c[3];
  points.triangle(c);
  return Triangle(c[0], c[1], c[2]);
}

/// A triangle and a segment of its plane, on a grid of 5² that lies across any axis.
std::uint64_t coplanar_segments() {
  Sum sum;
  LatticePoints points(11);
  for (int i = 0; i < 30000; ++i) {
    Int3 c[5];
    Triangle triangle;
    const int axis = i % 3, lean = i % 2;  // half of the planes are askew
    do {
      for (Int3& p : c) {
        p[(axis + 1) % 3] = points.within(2);
        p[(axis + 2) % 3] = points.within(2);
        p[axis] = lean * (p[(axis + 1) % 3] - 2 * p[(axis + 2) % 3]);
      }
      triangle = Triangle(c[0], c[1], c[2]);
    } while (triangle.collapsed());
    sum.add(segment_meets_triangle(c[3], c[4], triangle));
  }
  return sum.value();
}

std::uint64_t segments_and_triangles() {
  Sum sum;
  LatticePoints points(12);
  for (int i = 0; i < 30000; ++i) {
    points.choose();
    const Triangle triangle = any_triangle(points);
    const Int3 p = points.point(), q = points.point();
    sum.add(segment_meets_triangle(p, q, triangle));
  }
  return sum.value();
}

std::uint64_t pairs_of_triangles() {
  Sum sum;
  LatticePoints points(13);
  for (int i = 0; i < 30000; ++i) {
    points.choose();
    const Triangle s = any_triangle(points), t = any_triangle(points);
    sum.add(triangles_intersect(s, t));
  }
  return sum.value();
}

std::uint64_t boxes() {
  Sum sum;
  LatticePoints points(14);
  for (int i = 0; i < 30000; ++i) {
    points.choose();
    const Triangle triangle = any_triangle(points);
    Box box;
    box.include(points.point());
    box.include(points.point());
    sum.add(segment_meets_box(triangle[0], triangle[1], box));
    sum.add(triangle_meets_box(triangle, box));
    sum.add(triangle.box().meets(box));
  }
  return sum.value();
}

std::uint64_t rays() {
  Sum sum;
  LatticePoints points(15);
  for (int i = 0; i < 30000; ++i) {
    points.choose();
    const Triangle triangle = any_triangle(points);
    const Int3 p = points.point();
    Int3 along(0);
    if (i % 2 == 0)
      along[i / 2 % 3] = i % 4 < 2 ? 1 << 28 : -(1 << 28);
    else
      do along = Int3(points.within(2), points.within(2), points.within(2)) * (1 << 27);
      while (std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)}) < 1 << 28);
    sum.add(line_passes(p, along, triangle));
    const auto crossing = ray_crosses(p, along, triangle);
    sum.add(crossing ? crossing->sign : 0);
    const auto at = ray_crosses_at(p, along, triangle);
    sum.add(at ? at->sign : 0);
    if (at) sum.add(at->height);
  }
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) sum.add(first_sign(Long3(x, y, z)));
  return sum.value();
}

std::uint64_t projections() {
  Sum sum;
  LatticePoints points(16);
  for (int i = 0; i < 30000; ++i) {
    points.choose();
    const Triangle triangle = any_triangle(points);
    const Int3 g = points.point();
    for (int axis = 0; axis < 3; ++axis) {
      if (triangle.normal[axis] == 0) continue;
      const bool holds = projection_holds(triangle, axis, g[(axis + 1) % 3], g[(axis + 2) % 3]);
      sum.add(holds);
      if (holds) sum.add(raised(triangle, axis, g[(axis + 1) % 3], g[(axis + 2) % 3]));
    }
  }
  return sum.value();
}

/// Samples of a triangle, with and without a box that cuts through them.
std::uint64_t samples() {
  Sum sum;
  LatticePoints points(17);
  for (int i = 0; i < 3000; ++i) {
    LatticeMesh mesh;
    do
      mesh.vertices = {Int3(points.within(40), points.within(40), points.within(40)),
                       Int3(points.within(40), points.within(40), points.within(40)),
                       Int3(points.within(40), points.within(40), points.within(40))};
    while (Triangle(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]).collapsed());
    mesh.triangles = {{0, 1, 2}};
    mesh.flags = {0};
    const Long3 n = Triangle(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]).normal;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
    mesh.sample_axis = {static_cast<std::uint8_t>(axis)};
    Box clip;
    clip.include(Int3(points.within(30), points.within(30), points.within(30)));
    clip.include(Int3(points.within(30), points.within(30), points.within(30)));
    for_each_sample(mesh, 0, 5, clip, [&](const Int3& p) { sum.add(p); });
    for_each_sample(mesh, 0, 7, triangle_of(mesh, 0).box(), [&](const Int3& p) { sum.add(p); });
  }
  return sum.value();
}

std::uint64_t directions() {
  Sum sum;
  LatticePoints points(18);
  for (int i = 0; i < 20000; ++i) {
    const int places = i % 60;
    Long3 v;
    for (int k = 0; k < 3; ++k) v[k] = points.within(1 << 28) * (std::int64_t{1} << 32) >> places;
    if (i % 5 == 0) v[i % 3] = (std::int64_t{1} << places) * (i % 2 == 0 ? 1 : -1);
    if (v == Long3(0)) continue;
    sum.add(normalise(v));
  }
  return sum.value();
}

/// Boxes that meet a long or a wide one, and each other, of trees of a hundred far apart and close together.
std::uint64_t trees() {
  Sum sum;
  LatticePoints points(21);
  for (int i = 0; i < 40; ++i) {
    points.choose();
    std::vector<Box> boxes(100), others(30);
    for (auto* list : {&boxes, &others})
      for (Box& box : *list) {
        const Int3 p = points.point();
        box.include(p);
        box.include(p + Int3(points.within(1 << 20), points.within(1 << 20), points.within(1 << 20)));
      }
    boxes[7] = Box();  // empty: never found
    BoxTree tree, other;
    tree.build(boxes);
    other.build(others);
    for (Box query : others) {
      query.min[i % 3] = -(1 << 28);  // long
      query.max[i % 3] = 1 << 28;
      std::vector<std::uint32_t> found;
      tree.meeting(query, found);
      for (const std::uint32_t id : found) sum.add(id);
      sum.add(-1);
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    BoxTree::meeting_pairs(tree, other, pairs);
    for (const auto& [a, b] : pairs) sum.add(std::int64_t{a} << 32 | b);
  }
  return sum.value();
}

/// Normals at, just below and just above the angles that have an exact cosine, short and as long as they
/// come.
std::uint64_t smooth_angles() {
  Sum sum;
  for (const double degrees : {-1.0, -1e-9, 0.0, 20.0, 30.0, 45.0, 60.0, 89.9, 90.0, 90.001}) {
    const auto angle = make_smooth_angle(degrees);
    sum.add(angle ? 1 : 0);
    if (!angle) continue;
    sum.add(angle->cos2_numerator);
    sum.add(angle->cos2_denominator);
    LatticePoints points(22);
    for (int i = 0; i < 4000; ++i) {
      const int shift = i % 4 == 0 ? 0 : i % 4 == 1 ? 20 : 56;
      Long3 n[2];
      for (Long3& v : n) do
          v = Long3(points.within(3), points.within(3), points.within(3));
        while (v == Long3(0));
      for (Long3& v : n)
        for (int k = 0; k < 3; ++k) v[k] = (v[k] << shift) + (i % 3 == 0 ? points.within(1) : 0);
      if (n[0] != Long3(0) && n[1] != Long3(0)) sum.add(smooth(n[0], n[1], *angle));
    }
  }
  return sum.value();
}

/// Handfuls of triangles on a tiny grid: edges of one to four triangles, folds, repeated faces, collapsed
/// ones, two parts.
std::uint64_t handfuls() {
  Sum sum;
  LatticePoints points(23);
  for (int i = 0; i < 1500; ++i) {
    Mesh mesh;
    const int reach = 1 + i % 2;
    for (int v = 0; v < 7; ++v)
      mesh.vertices.emplace_back(Int3(points.within(reach), points.within(reach), points.within(reach)));
    const std::uint32_t count = 4 + static_cast<std::uint32_t>(i % 9);
    for (std::uint32_t t = 0; t < count; ++t) {
      std::array<std::uint32_t, 3> corners{};
      for (auto& corner : corners) corner = static_cast<std::uint32_t>(points.within(3) + 3);
      mesh.triangles.push_back(corners);
      if (i % 5 == 0) mesh.triangles.push_back({corners[0], corners[2], corners[1]});
      if (i % 7 == 0 && t == 0) mesh.triangles.push_back(corners);
    }
    // A tetrahedron too, so that something has an inside.
    mesh.vertices.insert(mesh.vertices.end(),
                         {Vec3(-4, -3, -3), Vec3(5, -3, -3), Vec3(0, 5, -3), Vec3(0, 0, 6)});
    for (const auto& face : {std::array<std::uint32_t, 3>{7, 9, 8}, {7, 8, 10}, {8, 9, 10}, {9, 7, 10}})
      if (i % 3 != 0) mesh.triangles.push_back(face);
    const auto all = static_cast<std::uint32_t>(mesh.triangles.size());
    mesh.parts = {{"a", 0, all / 2}, {"b", all / 2, all - all / 2}};
    Lattice lattice;
    lattice.step_m = 1;
    MeshReport report;
    const auto built = build_lattice_mesh(mesh, lattice, SmoothAngle{3, 4}, report);
    sum.add(built ? 1 : 0);
    if (!built) continue;
    for (const auto& t : built->triangles)
      for (const std::uint32_t v : t) sum.add(v);
    for (const auto f : built->flags) sum.add(f);
    for (const auto n : built->neighbours) sum.add(n);
    for (const auto n : built->neighbour_begin) sum.add(n);
    sum.add(built->closed);
    for (const std::uint32_t n :
         {report.duplicate, report.open_edges, report.nonmanifold_edges, report.collapsed})
      sum.add(n);
    sum.add(static_cast<std::int64_t>(report.largest_gap_m * 0x1p20));
    for (const auto& part : report.parts)
      sum.add(part.closed + 2 * part.sheet + 4 * part.turned + 8 * part.orientable);
  }
  return sum.value();
}

/// Responses to answers made up of small numbers: areas with and without rays, direction and voxels, that
/// pierce each other, and that were loud, silent or not there in the frame before.
std::uint64_t responses() {
  Sum sum;
  LatticePoints points(24);
  const auto below = [&](int count) { return (points.within(1 << 20) + (1 << 20)) % count; };
  const auto add = [&](const Vec3& v) {
    for (int k = 0; k < 3; ++k) sum.add(std::bit_cast<std::int64_t>(v[k]));
  };
  SceneGeometry geometry;
  geometry.lattice.step_m = 0.25;
  geometry.tool_gc_m = Vec3(3, 4, 5);
  geometry.tool_centre_m = Vec3(1, -2, 7);
  geometry.sample_spacing = 3;
  geometry.tool_radius = 40;
  geometry.reference_area_m2 = 2;
  LatticePose pose;
  for (int k = 0; k < 3; ++k) pose.rotation_q30[k][(k + 1) % 3] = 1 << 30;
  pose.translation = Int3(8, -9, 10);
  for (int i = 0; i < 4000; ++i) {
    Contacts contacts;
    contacts.contact = below(8) != 0;
    contacts.truncated = below(16) == 0;
    const int count = 1 + below(4);
    for (int a = 0; a < count; ++a) {
      ContactArea area;
      area.id = static_cast<std::uint32_t>(4 * a);
      for (std::uint32_t s = 0; s < 4; ++s)
        if (below(3) != 0) area.static_ids.push_back(area.id + s);
      if (below(5) != 0) area.direction = Int3(points.within(2), points.within(2), points.within(2));
      area.rays = static_cast<std::uint32_t>(below(3));
      area.max_height = static_cast<std::uint32_t>(below(3)) << 29;
      area.height_sum = below(4) == 0 ? 0 : std::int64_t{1 + below(3)} << 28;
      area.field.samples = static_cast<std::uint32_t>(below(3));
      area.field.max_depth = static_cast<std::uint32_t>(below(1000));
      area.field.weight_sum = below(4) == 0 ? 0 : std::int64_t{1 + below(2)} << 24;
      area.field.depth_sum = below(4) == 0 ? 0 : 1 + below(1 << 20);
      for (auto* sums : {&area.field.push, &area.field.moment})
        for (auto& term : *sums) term = {below(1000), points.within(10)};
      area.voxel_count = static_cast<std::uint32_t>(below(3));
      for (auto& voxel : area.voxel_sum) voxel = points.within(100);
      if (area.voxel_count == 0) area.voxel_sum = {};
      contacts.areas.push_back(area);
    }
    for (int b = below(4); b > 0; --b) {
      FieldBin& bin = contacts.field.bins[static_cast<std::size_t>(below(static_cast<int>(kFieldBins)))];
      bin.samples = 1;
      for (auto* sums : {&bin.push, &bin.turn})
        for (auto& term : *sums) term = {below(1000), points.within(10)};
      bin.give = below(1000);
      for (auto& term : bin.give_at) term = points.within(100);
      for (auto& term : bin.give_spread) term = points.within(10000);
    }
    ContactResponse response;
    respond(contacts, pose, geometry, i % 3 == 0 ? Profile::kPaper : Profile::kRefined, 1000, response);
    add(response.gc);
    add(response.wrench.force);
    add(response.wrench.torque);
    sum.add(response.flags);
    sum.add(response.contact);
    for (const AreaResponse& area : response.areas) {
      for (const Vec3& v :
           {area.normal, area.point, area.force, area.torque, Vec3(area.depth, area.max_depth, area.slope)})
        add(v);
      sum.add(area.id);
      sum.add(area.flags);
    }
    for (const ContactPlane& plane : response.planes)
      for (const Vec3& v : {plane.normal, plane.lever, Vec3(plane.force, plane.stiffness, 0)}) add(v);
  }
  return sum.value();
}

/// Floods of bricks some of which are told apart, from every corner of the grid.
std::uint64_t floods() {
  Sum sum;
  LatticePoints points(19);
  constexpr VoxelClass kOpen{8}, kWall{1}, kTo{2};
  const auto inside = [](VoxelClass c) { return c == kOpen; };
  for (int i = 0; i < 60; ++i) {
    const Int3 bricks(2 + i % 2, 2 + i / 2 % 2, 2 + i / 4 % 2), size = bricks * kBrickSide;
    BrickClasses classes(bricks, kOpen);
    // Walls of one voxel along the bricks' faces and through them, with a hole each; and whole bricks.
    for (int wall = 0; wall < 6; ++wall) {
      const int k = (i + wall) % 3, at = (points.within(3) + 3) * 4 % size[k];
      const Int3 hole((points.within(100) + 100) % size.x, (points.within(100) + 100) % size.y,
                      (points.within(100) + 100) % size.z);
      Int3 v;
      for (v.z = 0; v.z < size.z; ++v.z)
        for (v.y = 0; v.y < size.y; ++v.y)
          for (v.x = 0; v.x < size.x; ++v.x) {
            const bool in_hole = v[(k + 1) % 3] == hole[(k + 1) % 3] && v[(k + 2) % 3] == hole[(k + 2) % 3];
            if (v[k] == at + wall % 2 * 3 && !in_hole && wall < i % 6 + 1) classes.set(v, kWall);
          }
    }
    const Int3 start(i % 2 * (size.x - 1), i / 2 % 2 * (size.y - 1), i / 4 % 2 * (size.z - 1));
    std::int64_t seen = 0;
    if (inside(classes.at(start)))
      classes.flood(start, kTo, inside, [&](const Int3&, VoxelClass, int voxels) { seen += voxels; });
    sum.add(seen);
    Int3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x) sum.add(static_cast<int>(classes.at(v)));
  }
  return sum.value();
}

}  // namespace

const std::vector<Probe>& probes() {
  static const std::vector<Probe> all{{"coplanar_segments", coplanar_segments},
                                      {"segments_and_triangles", segments_and_triangles},
                                      {"pairs_of_triangles", pairs_of_triangles},
                                      {"boxes", boxes},
                                      {"rays", rays},
                                      {"projections", projections},
                                      {"samples", samples},
                                      {"directions", directions},
                                      {"trees", trees},
                                      {"floods", floods}};
  return all;
}

const std::vector<Probe>& host_probes() {
  static const std::vector<Probe> all{
      {"smooth_angles", smooth_angles}, {"handfuls", handfuls}, {"responses", responses}};
  return all;
}

std::uint64_t probe_ways_out(const LatticeMesh& mesh, const VoxelGrid& grid) {
  const auto partition = make_partition(mesh, grid, 0, {});
  if (!partition) throw std::runtime_error(partition.error().sentence);
  Sum sum;
  LatticePoints points(20);
  const Int3 size = grid.voxels() * grid.size;
  for (int i = 0; i < 400; ++i) {
    Int3 p;
    for (int k = 0; k < 3; ++k) {
      const int reach =
          i % 8 == 0 ? size[k] : size[k] / (2 + i % 3);  // some off the grid, most near its middle
      p[k] = grid.origin[k] + size[k] / 2 + points.within(reach);
      if (i % 4 == 1)
        p[k] -= (p[k] - grid.origin[k]) % grid.size;  // corners of voxels: as near to one as to another
      if (i % 4 == 2 || (i % 4 == 3 && k != i / 4 % 3))
        p[k] += grid.size / 2 - (p[k] - grid.origin[k]) % grid.size;                  // centres
      if (i % 4 == 3 && k == i / 4 % 3) p[k] -= (p[k] - grid.origin[k]) % grid.size;  // middles of faces
    }
    const Long3 out = partition->to_nearest_external(p);
    for (int k = 0; k < 3; ++k) sum.add(out[k]);
    sum.add(static_cast<int>(partition->class_of(p)));
    if (const Int3 voxel = partition->holding(p); partition->in_grid(voxel)) {
      sum.add(static_cast<std::int64_t>(partition->listed(partition->number(voxel)).size()));
      const Int3 end = glm::min(voxel + Int3(1 + i % 5), grid.voxels());
      sum.add(partition->block_is_external(voxel, end));
    }
  }
  return sum.value();
}

}  // namespace palpate::mutation
