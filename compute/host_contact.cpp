#include "compute/host_contact.h"

namespace palpate {

using namespace gpu;   // names of shaders/shared/frame.h

Result<std::unique_ptr<HostContact>> HostContact::make(VulkanDevice& device, const SceneGeometry& geometry, const PreparedScene& scene,
                                                       const RunTree& runs, HostAreas& areas, NearRays& rays) {
  std::unique_ptr<HostContact> out(new HostContact(geometry, areas, rays, runs));
  auto sets = HostSets::make(device, geometry, scene, runs.order());
  if (!sets) return sets.error();
  out->sets_ = std::move(*sets);
  out->work_.resize(kMaxFrameAreas);
  out->members_.resize(kMostCandidates);
  return out;
}

bool HostContact::decide(PosedTool& tool, const NearLists& near) {
  return sets_.decide(tool, near, areas_.marks(), areas_.most_statics(), found_);
}

bool HostContact::join(PosedTool& tool, const Held* held) {
  slots_.resize(found_.statics.size());
  lists_ = {.mobiles = found_.mobiles, .samples = found_.samples, .statics = found_.statics, .areas = work_, .slots = slots_, .members = members_, .numbered = true};
  return areas_.solve(tool, held, lists_, answer_);
}

bool HostContact::trace(PosedTool& tool) {
  risen_.clear();
  return heights_.sum(tool, lists_, areas_, risen_);
}

bool HostContact::follow(PosedTool& tool) {
  if (!follow_.needles(tool, heights_, lists_, areas_, found_.pairs, answer_.areas, risen_)) return false;
  follow_.pierces(lists_, answer_.areas, risen_, pierces_);
  return true;
}

bool HostContact::finish(std::uint32_t areas) {
  result_.state = found_.state;
  result_.flags = 0;
  result_.swallowed_direction = Int3(0);
  result_.swallowed_height = 0;
  result_.pair_count = static_cast<std::uint32_t>(found_.pairs.size());
  result_.static_count = static_cast<std::uint32_t>(found_.statics.size());
  result_.mobile_count = static_cast<std::uint32_t>(found_.mobiles.size());
  result_.sample_count = static_cast<std::uint32_t>(found_.samples.size());
  result_.member_count = areas == 0 ? 0 : answer_.members;
  result_.pierce_count = areas == 0 ? 0 : static_cast<std::uint32_t>(pierces_.size());
  result_.area_count = areas;
  for (std::uint32_t i = 0; i < areas; ++i) {
    const AreaWork& from = work_[i];
    AreaResult& to = result_.areas[i];
    to.id = from.id;
    to.flags = from.flags;
    to.direction = from.direction;
    to.sheet_sign = from.sheet_sign;
    to.rays = from.rays;
    to.max_height = from.max_height;
    to.height_sum = from.height_sum;
    to.weight_sum = from.weight_sum;
    to.faded_sum = from.faded_sum;
    to.faded_rest = from.faded_rest;
    to.weight_slope = from.weight_slope;
    to.height_slope = from.height_slope;
    for (int k = 0; k < 3; ++k) {
      to.moment_low[k] = from.moment_low[k];
      to.moment_high[k] = from.moment_high[k];
      to.voxel_sum[k] = from.voxel_sum[k];
    }
    to.voxel_count = from.voxel_count;
  }
  return true;
}

}  // namespace palpate
