#include "tests/equivalence/digest.h"

#include <array>
#include <bit>
#include <vector>

namespace palpate::equivalence {
namespace {

void add(Digest& digest, std::int64_t value) { digest.add(static_cast<std::uint64_t>(value)); }
void add(Digest& digest, const Int3& v) {
  for (int k = 0; k < 3; ++k) add(digest, std::int64_t{v[k]});
}
void add(Digest& digest, double value) { digest.add(std::bit_cast<std::uint64_t>(value)); }
void add(Digest& digest, const Vec3& v) {
  for (int k = 0; k < 3; ++k) add(digest, v[k]);
}
template <class T>
void add(Digest& digest, const std::vector<T>& list) {
  digest.add(list.size());
  for (const T& entry : list) digest.add(static_cast<std::uint64_t>(entry));
}

void add(Digest& digest, const std::array<WideSum, 3>& sums) {
  for (const WideSum& sum : sums) {
    add(digest, sum.low);
    add(digest, sum.high);
  }
}
void add(Digest& digest, const CarrierSums& carrier) {
  for (const std::uint32_t word : {carrier.id, carrier.samples, carrier.max_depth}) digest.add(word);
  add(digest, carrier.weight_sum);
  add(digest, carrier.depth_sum);
  add(digest, carrier.push);
  add(digest, carrier.moment);
}

}  // namespace

void add(CaseHashes& hashes, const VoxelPartition& partition) {
  Digest& d = hashes.preparation;
  add(d, partition.grid.origin);
  add(d, std::int64_t{partition.grid.size});
  add(d, partition.grid.bricks);
  add(d, partition.classes);
  add(d, partition.boundary_voxels);
  add(d, partition.list_begin);
  add(d, partition.list_triangles);
}

void add(CaseHashes& hashes, const Contacts& contacts) {
  Digest& sets = hashes.sets;
  sets.add(contacts.contact);
  sets.add(contacts.truncated);
  for (const char* c = contacts.truncated_capacity; *c != 0; ++c) sets.add(static_cast<unsigned char>(*c));
  sets.add(contacts.pairs);
  for (const auto* set :
       {&contacts.cst, &contacts.bst, &contacts.cmt, &contacts.bmt, &contacts.imt, &contacts.est})
    add(sets, *set);
  sets.add(contacts.flags);

  Digest &areas = hashes.areas, &sums = hashes.sums;
  areas.add(contacts.areas.size());
  for (const ContactArea& area : contacts.areas) {
    areas.add(area.id);
    areas.add(area.zones.size());
    for (const auto& zone : area.zones) add(areas, zone);
    add(areas, area.static_ids);
    add(areas, area.mobile_ids);
    areas.add(area.flags);

    add(sums, area.direction);
    sums.add(area.rays);
    sums.add(area.max_height);
    add(sums, area.height_sum);
    add(sums, area.field);
    for (const std::int64_t component : area.voxel_sum) add(sums, component);
    sums.add(area.voxel_count);
  }
  for (const FieldBin& bin : contacts.field.bins) {
    sums.add(bin.samples);
    add(sums, bin.push);
    add(sums, bin.turn);
    add(sums, bin.give);
    for (const std::int64_t sum : bin.give_at) add(sums, sum);
    for (const std::int64_t sum : bin.give_spread) add(sums, sum);
  }
  for (const std::uint32_t word :
       {contacts.field.max_depth, contacts.field.deepest_static, contacts.field.deepest_mobile})
    sums.add(word);
  sums.add(contacts.carriers.size());
  for (const CarrierSums& carrier : contacts.carriers) add(sums, carrier);
  add(sums, contacts.ignored_touched);
}

void add(CaseHashes& hashes, const ContactResponse& response) {
  Digest& d = hashes.response;
  d.add(response.contact);
  d.add(response.flags);
  add(d, response.gc);
  add(d, response.wrench.force);
  add(d, response.wrench.torque);
  d.add(response.areas.size());
  for (const AreaResponse& area : response.areas) {
    d.add(area.id);
    add(d, area.normal);
    add(d, area.depth);
    add(d, area.max_depth);
    add(d, area.slope);
    add(d, area.point);
    add(d, area.force);
    add(d, area.torque);
    d.add(area.flags);
  }
  d.add(response.planes.size());
  for (const ContactPlane& plane : response.planes) {
    add(d, plane.normal);
    add(d, plane.lever);
    add(d, plane.force);
    add(d, plane.stiffness);
  }
}

}  // namespace palpate::equivalence
