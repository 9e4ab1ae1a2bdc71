#include "compute/scene/tool_order.h"

#include <algorithm>
#include <utility>

#include "model/lattice/lattice.h"

namespace palpate {
namespace {

/// The low 20 bits of v, two zeros between each.
std::uint64_t spread(std::uint64_t v) {
  std::uint64_t out = 0;
  for (unsigned bit = 0; bit < 20; ++bit) out |= (v >> bit & 1u) << (3 * bit);
  return out;
}

}  // namespace

std::vector<std::uint32_t> order_in_space(const LatticeMesh& mesh) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(mesh.triangles.size());
  for (std::uint32_t id = 0; id < keys.size(); ++id) {
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
      // Three coordinates within ±2^28: moved up by 3 · 2^28 the sum is below 2^31; its 20 leading bits are
      // enough.
      const std::int64_t sum = std::int64_t{mesh.corner(id, 0)[k]} + mesh.corner(id, 1)[k] +
                               mesh.corner(id, 2)[k] + 3 * std::int64_t{kLatticeReach};
      code |= spread(static_cast<std::uint64_t>(sum) >> 11) << k;
    }
    keys[id] = {code, id};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> out(keys.size());
  std::transform(keys.begin(), keys.end(), out.begin(), [](const auto& key) { return key.second; });
  return out;
}

}  // namespace palpate
