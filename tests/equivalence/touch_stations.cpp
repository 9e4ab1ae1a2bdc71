#include "tests/equivalence/touch_stations.h"

#include <algorithm>
#include <cmath>

#include "cpu_ref/exact.h"
#include "tests/equivalence/touching_poses.h"

// The argument. Choose coordinates (x, y, z) by an invertible linear map, which keeps what intersects and
// what does not. The tool's triangle lies in z ≤ 0 and meets z = 0 in one feature of its own: a corner, an
// edge, or all of it. The static triangle lies in z ≥ 0 and meets z = 0 in one feature. So the two have in
// common what their features have in common within the plane z = 0, and the features are a few small numbers
// whose relation can be seen. A step of the tool towards smaller z leaves nothing in common, and when both
// lie within z = 0, a step towards any other z does.
namespace palpate::equivalence {
namespace {

using cpu_ref::cross;
using cpu_ref::dot;
using cpu_ref::Int128;

/// Lattice vectors that (8, 0, 0), (0, 8, 0) and (0, 0, 8) stand for.
struct Frame {
  Long3 x, y, z;
  Int3 at(const Int3& c) const {
    return Int3((x * std::int64_t{c.x} + y * std::int64_t{c.y} + z * std::int64_t{c.z}) / std::int64_t{8});
  }
  Int128 volume() const { return dot(cross(x, y), z); }
  /// Sign of a step's z.
  int height_sign(const Int3& step) const {
    return cpu_ref::sign(dot(cross(x, y), Long3(step))) * cpu_ref::sign(volume());
  }
  /// The largest |coordinate| of a step, in eighths.
  double size(const Int3& step) const {
    const double v = std::fabs(static_cast<double>(volume()));
    const Long3 s(step);
    const double a = static_cast<double>(dot(cross(y, z), s)), b = static_cast<double>(dot(cross(z, x), s)),
                 c = static_cast<double>(dot(cross(x, y), s));
    return 8 * std::max({std::fabs(a), std::fabs(b), std::fabs(c)}) / v;
  }
};

/// Which of its features the tool has in z = 0. Its corners are (0,0,0), (8,0,·), (0,8,·), with −8 where they
/// lie below.
enum class Feature : std::uint8_t { kVertex, kEdge, kFace };

Feature feature_of(Touch touch) {
  return touch <= Touch::kVertexFace ? Feature::kVertex
         : touch <= Touch::kEdgeFace ? Feature::kEdge
                                     : Feature::kFace;
}

/// corner + p = at(8, 0, z1), corner + q = at(0, 8, z2) with z = −8 where the corner lies below the plane.
Frame frame_for(const TouchShape& s, Feature feature) {
  const Long3 p(s.p), q(s.q), w(s.w);
  return {feature == Feature::kVertex ? p + w : p, feature == Feature::kFace ? q : q + w, w};
}

bool coplanar(Touch touch) { return touch >= Touch::kCoplanarOverlap; }

/// The static triangle in eighths, and whether it meets the tool.
struct Made {
  Int3 a, b, c;
  bool meets = true;
  bool deep = false;  ///< by a margin of 2 eighths, should the tool move up by less than half of one
};

/// A corner above z = 0, no flatter than 45 degrees seen from `from` when `steep`.
Int3 above(Random& r, const Int3& from) {
  return {from.x + r.between(-8, 8), from.y + r.between(-8, 8), r.between(8, 16)};
}

/// Two corners above the plane that with `from` make an area.
Made cone(Random& r, const Int3& from) {
  Made made{from, above(r, from), {}};
  do made.c = above(r, from);
  while (cross(Long3(made.b - from), Long3(made.c - from)) == Long3(0));
  return made;
}

/// A direction within the plane, not along x.
Int3 across(Random& r) {
  const std::int32_t x = r.between(-5, 5), y = r.between(1, 5);
  return {x, r.below(2) != 0 ? y : -y, 0};
}

/// A triangle of z = 0 around a point, by 2 eighths or more on every side: (−8, −8), (8, −8) and (0, 8) at
/// least.
Made around(Random& r, const Int3& point) {
  const std::int32_t y0 = r.between(-16, -8), x0 = r.between(-16, -8), y1 = r.between(-16, -8),
                     x1 = r.between(8, 16), y2 = r.between(8, 16);
  return {point + Int3(x0, y0, 0), point + Int3(x1, y1, 0), point + Int3(0, y2, 0)};
}

Made make(Touch touch, Random& r) {
  switch (touch) {
    case Touch::kVertexVertex:
      return cone(r, Int3(0));
    case Touch::kVertexEdge: {  // an edge through the origin
      const Int3 w = across(r);
      return {w * -r.between(1, 3), w * r.between(1, 3), above(r, Int3(0))};
    }
    case Touch::kVertexFace: {
      Made made = around(r, Int3(0));
      made.deep = true;
      return made;
    }
    case Touch::kEdgeVertex:
      return cone(r, {r.between(0, 8), 0, 0});  // the tool's edge is (0,0,0) … (8,0,0)
    case Touch::kEdgeEdge: {
      const Int3 w = across(r), at(r.between(0, 8), 0, 0);
      return {at - w * r.between(1, 3), at + w * r.between(1, 3), above(r, at)};
    }
    case Touch::kEdgeEdgeBetweenPoints: {  // crosses y = 0 at x = at + 1/2, or at + 1/3
      const std::int32_t at = r.between(0, 7);
      return r.below(2) != 0 ? Made{{at, -1, 0}, {at + 1, 1, 0}, above(r, Int3(at, 0, 0))}
                             : Made{{at, -1, 0}, {at + 1, 2, 0}, above(r, Int3(at, 0, 0))};
    }
    case Touch::kEdgeSliding: {  // along y = 0: [from, from + length] and [0, 8]
      const std::int32_t length = r.between(1, 8), from = r.between(-length - 2, 10);
      Made made{{from, 0, 0}, {from + length, 0, 0}, above(r, Int3(from, 0, 0))};
      made.meets = from <= 8 && from + length >= 0;
      return made;
    }
    case Touch::kEdgeFace: {  // the tool's edge strictly within: the sides pass beyond x = −2 and 10 at every
                              // |y| ≤ 2
      Made made{{r.between(-40, -30), r.between(-20, -12), 0},
                {r.between(38, 48), r.between(-20, -12), 0},
                {4, r.between(14, 20), 0}};
      made.deep = true;
      return made;
    }
    case Touch::kFaceVertex: {  // (2 … 3, 2 … 3) lies 2 eighths within the tool's sides x = 0, y = 0, and 1.4
                                // within x + y = 8
      Made made = cone(r, {r.between(2, 3), r.between(2, 3), 0});
      made.deep = true;
      return made;
    }
    case Touch::kFaceEdge:
      return {{1, r.between(1, 2), 0}, {r.between(3, 5), r.between(1, 2), 0}, above(r, Int3(2, 2, 0))};
    case Touch::kCoplanarOverlap:
      return around(r, {r.between(1, 3), r.between(1, 3), 0});
    case Touch::kCoplanarVertexOnEdge:  // all else of it has y < 0
      return {{r.between(0, 8), 0, 0},
              {r.between(-8, 0), r.between(-8, -1), 0},
              {r.between(9, 16), r.between(-8, -1), 0}};
    case Touch::kCoplanarSharedEdge: {
      const std::int32_t length = r.between(1, 12), from = r.between(-length, 8);
      return {{from, 0, 0}, {from + length, 0, 0}, {r.between(-8, 8), r.between(-8, -1), 0}};
    }
    case Touch::kCoplanarApart: {  // y ≤ −1 against y ≥ 0
      Made made{{r.between(0, 8), -1, 0},
                {r.between(-8, 0), r.between(-9, -2), 0},
                {r.between(9, 16), r.between(-9, -2), 0}};
      made.meets = false;
      return made;
    }
    case Touch::kIdentical:
    case Touch::kCount:
      break;
  }
  const Int3 corners[3] = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  const int first = r.between(0, 2), turn = r.between(1, 2);
  return {corners[first], corners[(first + turn) % 3], corners[(first + 2 * turn) % 3]};
}

Int3 unit_step(int i) {
  Int3 step(0);
  step[i % 3] = i < 3 ? 1 : -1;
  return step;
}

/// The triangle of one station, in the tool's frame.
Station make_station(const TouchShape& shape, Touch touch, Random& random) {
  const Frame frame = frame_for(shape, feature_of(touch));
  Made made = make(touch, random);
  Station station;
  station.touch = touch;
  station.meets = made.meets;
  station.triangle = {frame.at(made.a), frame.at(made.b), frame.at(made.c)};
  for (int k = 0, first = random.between(0, 5); k < 6; ++k) {
    const Int3 step = unit_step((first + k) % 6);
    const int height = frame.height_sign(step);
    if (height < 0 || (height != 0 && coplanar(touch))) station.apart = step;
    if (height > 0 && made.deep && frame.size(step) < 0.5) station.into = step;
  }
  return station;
}

/// The largest |coordinate| along each axis.
Int3 reach_of(const LatticeTriangle& t) {
  return glm::max(glm::abs(t.a), glm::max(glm::abs(t.b), glm::abs(t.c)));
}

}  // namespace

TouchScene make_touch_scene(const TouchShape& shape, const TouchLayout& layout, Random& random) {
  TouchScene scene;
  scene.tool = {{Int3(0), shape.p, shape.q}};
  Int3 reach = reach_of(scene.tool[0]);
  const int first = random.between(0, static_cast<int>(Touch::kCount) - 1);
  for (int i = 0; i < layout.count; ++i) {
    const auto touch = static_cast<Touch>((first + i) % static_cast<int>(Touch::kCount));
    scene.stations.push_back(make_station(shape, touch, random));
    reach = glm::max(reach, reach_of(scene.stations.back().triangle));
  }
  if (!layout.slender) reach = Int3(std::max({reach.x, reach.y, reach.z}));
  const std::int32_t largest = std::max({reach.x, reach.y, reach.z});
  scene.voxel = layout.voxel != 0 ? layout.voxel : std::max(8, largest / 4 * 2);
  // Boxes of neighbours stay apart by more than a step; a multiple of the voxel where voxels are chosen.
  Int3 between = 2 * reach + Int3(8);
  if (layout.voxel != 0) between = (between / layout.voxel + Int3(1)) * layout.voxel;
  const LatticePose common = quarter_turns(random);
  Int3 low(INT32_MAX), high(INT32_MIN);
  for (int i = 0; i < layout.count; ++i) {
    Station& station = scene.stations[static_cast<std::size_t>(i)];
    station.pose = layout.slender ? common : quarter_turns(random);
    const Int3 place = between * (layout.slender ? Int3(0, i, 0) : Int3(i % 2, i / 2 % 2, i / 4));
    station.pose.translation = layout.slender ? transform(common, place) : place;
    low = glm::min(low, station.pose.translation);
    high = glm::max(high, station.pose.translation);
  }
  // The grid's border lies within 11 voxels of the box.
  const std::int32_t room = kLatticeReach - 12 * scene.voxel - largest;
  const std::int32_t voxel = scene.voxel;
  Int3 offset = -(low + high) / 2 / voxel * voxel;
  if (layout.corner > 0) offset = (Int3(room) - high) / voxel * voxel;
  if (layout.corner < 0) offset = (Int3(-room) - low) / voxel * voxel;
  for (Station& station : scene.stations) {
    station.pose.translation += offset;
    const LatticeTriangle& t = station.triangle;
    station.triangle = {transform(station.pose, t.a), transform(station.pose, t.b),
                        transform(station.pose, t.c)};
    scene.mockup.push_back(station.triangle);
  }
  return scene;
}

LatticePose station_pose(const std::vector<Station>& stations, Random& random, Known& known) {
  const std::uint64_t index = random.below(stations.size());
  const Station& station = stations[index];
  LatticePose pose = station.pose;
  bool meets = station.meets;
  const std::uint64_t way = random.below(5);
  Int3 step(0);
  if (way == 0) {
    step = station.apart;
    meets = false;
  } else if (way <= 2) {
    step = station.into;  // 0 if there is none: then simply the touch
  }
  pose.translation = Int3(0);
  pose.translation = station.pose.translation + transform(pose, step);
  known.pairs.emplace();
  if (meets) known.pairs->push_back({static_cast<std::uint32_t>(index), 0});
  return pose;
}

}  // namespace palpate::equivalence
