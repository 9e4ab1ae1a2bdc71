#include "compute/gpu/frame/plan.h"

namespace palpate {

Plan frame_plan(const Plan& plan, bool has_internal) {
  Plan out = plan;
  if (plan.spare_absent && !has_internal) out.imt = false;
  return out;
}

std::vector<SpecConstant> plan_constants(const Plan& plan) {
  std::vector<SpecConstant> out;
  if (!plan.transform_rotates) out.push_back({16, 0});
  if (!plan.imt) out.push_back({17, 0});
  if (!plan.zones) out.push_back({18, 0});
  if (!plan.contact_point) out.push_back({19, 0});
  return out;
}

}  // namespace palpate
