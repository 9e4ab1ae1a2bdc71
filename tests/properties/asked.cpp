#include "tests/properties/asked.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "compute/gpu/gpu_backend.h"
#include "cpu_ref/ref_backend.h"
#include "model/lattice/triangle.h"
#include "model/mesh/patches.h"
#include "model/scene/geometry_build.h"

namespace palpate::properties {
namespace {

CollisionBackend& backend() {
  static const std::unique_ptr<CollisionBackend> made = [] {
    const char* name = std::getenv("PALPATE_BACKEND");
    if (name == nullptr || std::string_view(name) != "gpu") return make_ref_backend();
    GpuOptions options;
    options.validation = true;
    auto gpu = make_gpu_backend(options);
    if (!gpu) throw std::runtime_error(gpu.error().sentence);
    return std::move(*gpu);
  }();
  return *made;
}

/// Welded, oriented and with normals, as at load; a metre is a step.
LatticeMesh built(const Body& body) {
  Mesh mesh;
  for (const Corners& triangle : body) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Int3& corner : triangle) mesh.vertices.emplace_back(corner);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.parts.push_back({"", 0, static_cast<std::uint32_t>(body.size())});
  MeshReport report;
  Lattice lattice;
  lattice.step_m = 1;
  Result<LatticeMesh> out = build_lattice_mesh(mesh, lattice, SmoothAngle(), report);
  if (!out) throw std::runtime_error(out.error().sentence);
  return std::move(*out);
}

template <class T>
T checked(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().sentence);
  return std::move(*result);
}
void checked(const Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().sentence);
}

std::uint32_t through(const std::vector<std::uint32_t>& map, std::uint32_t id) {
  return id < map.size() ? map[id] : id;
}

std::vector<std::uint32_t> through(const std::vector<std::uint32_t>& map, std::vector<std::uint32_t> ids) {
  for (std::uint32_t& id : ids) id = through(map, id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// The bodies are small: a sum fits into 64 bits.
std::int64_t value_of(const WideSum& sum) { return sum.high * (std::int64_t{1} << 32) + sum.low; }

std::string text_of(const ContactArea& area, Extent extent, const Mapping& mapping) {
  std::vector<std::vector<std::uint32_t>> zones;
  for (const auto& zone : area.zones) zones.push_back(through(mapping.statics, zone));
  std::sort(zones.begin(), zones.end());
  std::string text = fmt::format("area {} zones {}", through(mapping.statics, area.static_ids), zones);
  if (extent != Extent::kAll) return text;
  text += fmt::format(" mobile {} flags {:x} direction {} {} {} rays {} max {} heights {}",
                      through(mapping.mobiles, area.mobile_ids), area.flags, area.direction.x,
                      area.direction.y, area.direction.z, area.rays, area.max_height, area.height_sum);
  text += fmt::format(" field {} {} {} {}", area.field.samples, area.field.max_depth, area.field.weight_sum,
                      area.field.depth_sum);
  for (const auto* sums : {&area.field.push, &area.field.moment})
    for (const WideSum& sum : *sums) text += fmt::format(" {}", value_of(sum));
  for (int k = 0; k < 3; ++k)
    text += fmt::format(" {}", area.voxel_sum[static_cast<std::size_t>(k)] +
                                   mapping.shift[k] * std::int64_t{area.voxel_count});
  return text + fmt::format(" voxels {}", area.voxel_count);
}

std::string text_of(const FieldSums& field) {
  std::string text = fmt::format("deepest {}", field.max_depth);
  for (const FieldBin& bin : field.bins) {
    if (bin.samples == 0) continue;
    text += fmt::format(" bin {} {} {} {}", bin.samples, bin.give, bin.give_at, bin.give_spread);
    for (const auto* sums : {&bin.push, &bin.turn})
      for (const WideSum& sum : *sums) text += fmt::format(" {}", value_of(sum));
  }
  return text;
}

}  // namespace

std::vector<Answer> ask(const Question& question, const std::vector<LatticePose>& poses) {
  SceneGeometry geometry;
  geometry.lattice.step_m = 1;
  geometry.mockup = built(question.mockup);
  geometry.tool = built(question.tool);
  geometry.mockup_grid = make_grid(geometry.mockup.box_min, geometry.mockup.box_max, question.voxel);
  geometry.tool_grid = make_grid(geometry.tool.box_min, geometry.tool.box_max, question.voxel);
  geometry.sample_spacing = question.spacing;
  geometry.contact_samples = 12;  // few, so that many contacts are sampled coarsely
  weigh_for_field(geometry.sample_spacing, find_tips(geometry.sample_spacing, geometry.mockup),
                  geometry.mockup);
  weigh_for_field(geometry.sample_spacing, find_tips(geometry.sample_spacing, geometry.tool), geometry.tool);
  count_grid_samples(geometry.sample_spacing, geometry.tool);
  geometry.reference_area_m2 = 1;
  geometry.tool_gyration_m = 1;
  double radius = 0;
  for (const Int3& v : geometry.tool.vertices) radius = std::max(radius, glm::length(Vec3(v)));
  geometry.tool_radius = static_cast<std::int32_t>(std::ceil(radius)) + 3;  // as build_geometry does
  Plan plan;
  plan.profile = question.profile;
  plan.est = question.profile == Profile::kRefined;
  checked(backend().prepare(geometry, plan, {}));
  std::vector<Answer> answers;
  for (const LatticePose& pose : poses) {
    Answer& answer = answers.emplace_back();
    checked(backend().query(pose, nullptr, answer.contacts));
    answer.pairs = checked(backend().pairs());
    answer.partition = checked(backend().partition(false));
    respond(answer.contacts, pose, geometry, question.profile, kStiffness, answer.response);
    if (answer.contacts.truncated) throw std::runtime_error("a small scene was truncated");
  }
  return answers;
}

Answer ask(const Question& question) { return std::move(ask(question, {question.pose}).front()); }

std::string text_of(const Answer& answer, Extent extent, const Mapping& mapping) {
  const Contacts& c = answer.contacts;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [s, m] : answer.pairs)
    pairs.emplace_back(through(mapping.statics, s), through(mapping.mobiles, m));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const auto statics = [&](const auto& ids) { return through(mapping.statics, ids); };
  const auto mobiles = [&](const auto& ids) { return through(mapping.mobiles, ids); };
  std::string text = fmt::format("pairs {}\ncst {}\ncmt {}\n", pairs, statics(c.cst), mobiles(c.cmt));
  if (extent >= Extent::kVoxels)
    text += fmt::format("imt {}\nbmt {}\nbst {}\n", mobiles(c.imt), mobiles(c.bmt), statics(c.bst));
  if (extent >= Extent::kSets) text += fmt::format("est {}\ncontact {}\n", statics(c.est), c.contact);
  if (extent < Extent::kAreas) return text;
  std::vector<std::string> areas;
  for (const ContactArea& area : c.areas) areas.push_back(text_of(area, extent, mapping));
  if (extent == Extent::kAreas) std::sort(areas.begin(), areas.end());
  text += fmt::format("{}\n", fmt::join(areas, "\n"));
  if (extent == Extent::kAll) text += fmt::format("flags {:x} {}\n", c.flags, text_of(c.field));
  return text;
}

std::vector<std::array<std::int32_t, 3>> voxels_of(const Answer& answer, VoxelClass wanted,
                                                   const std::function<Int3(const Int3&)>& place) {
  const VoxelGrid& grid = answer.partition.grid;
  const Int3 n = grid.voxels();
  std::vector<std::array<std::int32_t, 3>> found;
  std::size_t number = 0;
  for (std::int32_t z = 0; z < n.z; ++z)
    for (std::int32_t y = 0; y < n.y; ++y)
      for (std::int32_t x = 0; x < n.x; ++x) {
        if (answer.partition.classes[number++] != wanted) continue;
        // Of the two corners of the cube that were its lowest and highest, the lowest now.
        const Int3 low = grid.origin + grid.size * Int3(x, y, z), high = low + grid.size;
        const Int3 p = place ? glm::min(place(low), place(high)) : low;
        found.push_back({p.x, p.y, p.z});
      }
  std::sort(found.begin(), found.end());
  return found;
}

Body mapped(const Body& body, const std::function<Int3(const Int3&)>& f, bool turned) {
  Body out;
  for (const Corners& t : body)
    out.push_back(turned ? Corners{f(t[0]), f(t[2]), f(t[1])} : Corners{f(t[0]), f(t[1]), f(t[2])});
  return out;
}

Body moved(const Question& question) {
  Body out;
  for (const Corners& t : question.tool)
    if (!collapsed(t))
      out.push_back(
          {transform(question.pose, t[0]), transform(question.pose, t[1]), transform(question.pose, t[2])});
  return out;
}

bool collapsed(const Corners& triangle) {
  return raw_normal(triangle[0], triangle[1], triangle[2]) == Long3(0);
}

}  // namespace palpate::properties
