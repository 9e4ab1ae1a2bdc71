#include "tests/equivalence/known.h"

namespace palpate::equivalence {
namespace {

std::string text_of(const Pairs& pairs) {
  std::string text = "{";
  for (std::size_t i = 0; i < pairs.size() && i < 8; ++i)
    text += (i > 0 ? ", " : "") + std::to_string(pairs[i].first) + " " + std::to_string(pairs[i].second);
  return text + (pairs.size() > 8 ? " …}" : "}");
}

template <class T>
std::string differ(const char* what, const T& known, const T& answered) {
  return std::string(what) + ": " + std::to_string(known) + " known, " + std::to_string(answered) +
         " answered";
}

}  // namespace

std::string first_difference(const Known& known, const Contacts& contacts, const Pairs& pairs) {
  if (known.pairs && *known.pairs != pairs)
    return "pairs: " + text_of(*known.pairs) + " known, " + text_of(pairs) + " answered";
  if (known.areas && *known.areas != contacts.areas.size())
    return differ("areas", *known.areas, contacts.areas.size());
  if (known.contact && *known.contact != contacts.contact)
    return differ("contact", *known.contact, contacts.contact);
  if (known.est && *known.est == contacts.est.empty())
    return differ("EST has members", *known.est, !contacts.est.empty());
  return "";
}

std::string judge_classes(const VoxelPartition& partition,
                          const std::function<VoxelClass(const Int3& lower)>& known) {
  const Int3 voxels = partition.grid.voxels();
  std::size_t i = 0;
  for (int z = 0; z < voxels.z; ++z)
    for (int y = 0; y < voxels.y; ++y)
      for (int x = 0; x < voxels.x; ++x, ++i) {
        const VoxelClass expected = known(partition.grid.origin + partition.grid.size * Int3(x, y, z));
        if (partition.classes[i] != expected)
          return "voxel (" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) +
                 "): class " + std::to_string(static_cast<int>(expected)) + " known, " +
                 std::to_string(static_cast<int>(partition.classes[i])) + " answered";
      }
  return "";
}

}  // namespace palpate::equivalence
