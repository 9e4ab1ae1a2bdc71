#include "tests/equivalence/contacts_difference.h"

#include <array>
#include <sstream>
#include <vector>

namespace palpate {
namespace {

/// Remembers the first field that differed.
class Finder {
 public:
  template <class T>
  void field(const std::string& name, const T& a, const T& b) {
    if (!found_.empty() || a == b) return;
    std::ostringstream text;
    text << name << ": ";
    print(text, a);
    text << ", ";
    print(text, b);
    found_ = text.str();
  }
  template <class T>
  void list(const std::string& name, const std::vector<T>& a, const std::vector<T>& b) {
    if (a == b) return;
    field(name + ".size", a.size(), b.size());
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
      field(name + "[" + std::to_string(i) + "]", a[i], b[i]);
  }
  const std::string& found() const { return found_; }

 private:
  template <class T>
  static void print(std::ostringstream& text, const T& v) {
    text << +v;
  }
  static void print(std::ostringstream& text, VoxelClass v) { text << static_cast<int>(v); }
  static void print(std::ostringstream& text, const Int3& v) { text << v.x << ' ' << v.y << ' ' << v.z; }
  static void print(std::ostringstream& text, const std::string& v) { text << v; }
  std::string found_;
};

void compare_sums(Finder& find, const std::string& name, const std::array<WideSum, 3>& a,
                  const std::array<WideSum, 3>& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    find.field(name + ".low", a[k].low, b[k].low);
    find.field(name + ".high", a[k].high, b[k].high);
  }
}

void compare_carriers(Finder& find, const std::string& name, const CarrierSums& a, const CarrierSums& b) {
  find.field(name + ".id", a.id, b.id);
  find.field(name + ".samples", a.samples, b.samples);
  find.field(name + ".max_depth", a.max_depth, b.max_depth);
  find.field(name + ".weight_sum", a.weight_sum, b.weight_sum);
  find.field(name + ".depth_sum", a.depth_sum, b.depth_sum);
  compare_sums(find, name + ".push", a.push, b.push);
  compare_sums(find, name + ".moment", a.moment, b.moment);
}

void compare_fields(Finder& find, const FieldSums& a, const FieldSums& b) {
  for (std::size_t i = 0; i < kFieldBins; ++i) {
    const std::string name = "field.bins[" + std::to_string(i) + "]";
    find.field(name + ".samples", a.bins[i].samples, b.bins[i].samples);
    compare_sums(find, name + ".push", a.bins[i].push, b.bins[i].push);
    compare_sums(find, name + ".turn", a.bins[i].turn, b.bins[i].turn);
    find.field(name + ".give", a.bins[i].give, b.bins[i].give);
    for (std::size_t k = 0; k < 3; ++k)
      find.field(name + ".give_at", a.bins[i].give_at[k], b.bins[i].give_at[k]);
    for (std::size_t k = 0; k < 6; ++k)
      find.field(name + ".give_spread", a.bins[i].give_spread[k], b.bins[i].give_spread[k]);
  }
  find.field("field.max_depth", a.max_depth, b.max_depth);
  find.field("field.deepest_static", a.deepest_static, b.deepest_static);
  find.field("field.deepest_mobile", a.deepest_mobile, b.deepest_mobile);
}

void compare_areas(Finder& find, const std::string& name, const ContactArea& a, const ContactArea& b) {
  find.field(name + ".id", a.id, b.id);
  find.list(name + ".static_ids", a.static_ids, b.static_ids);
  find.field(name + ".zones.size", a.zones.size(), b.zones.size());
  for (std::size_t i = 0; i < a.zones.size() && i < b.zones.size(); ++i)
    find.list(name + ".zones[" + std::to_string(i) + "]", a.zones[i], b.zones[i]);
  find.list(name + ".mobile_ids", a.mobile_ids, b.mobile_ids);
  find.field(name + ".flags", a.flags, b.flags);
  find.field(name + ".direction", a.direction, b.direction);
  find.field(name + ".rays", a.rays, b.rays);
  find.field(name + ".max_height", a.max_height, b.max_height);
  find.field(name + ".height_sum", a.height_sum, b.height_sum);
  for (std::size_t k = 0; k < 3; ++k) {
    find.field(name + ".voxel_sum", a.voxel_sum[k], b.voxel_sum[k]);
  }
  find.field(name + ".voxel_count", a.voxel_count, b.voxel_count);
  compare_carriers(find, name + ".field", a.field, b.field);
}

}  // namespace

std::string first_difference(const Contacts& a, const Contacts& b) {
  Finder find;
  find.field("truncated", a.truncated, b.truncated);
  find.field("truncated_capacity", std::string(a.truncated_capacity), std::string(b.truncated_capacity));
  find.field("pairs", a.pairs, b.pairs);
  find.list("cst", a.cst, b.cst);
  find.list("cmt", a.cmt, b.cmt);
  find.list("imt", a.imt, b.imt);
  find.list("bmt", a.bmt, b.bmt);
  find.list("bst", a.bst, b.bst);
  find.list("est", a.est, b.est);
  find.field("contact", a.contact, b.contact);
  compare_fields(find, a.field, b.field);
  find.list("ignored_touched", a.ignored_touched, b.ignored_touched);
  find.field("carriers.size", a.carriers.size(), b.carriers.size());
  for (std::size_t i = 0; i < a.carriers.size() && i < b.carriers.size(); ++i)
    compare_carriers(find, "carriers[" + std::to_string(i) + "]", a.carriers[i], b.carriers[i]);
  find.field("areas.size", a.areas.size(), b.areas.size());
  for (std::size_t i = 0; i < a.areas.size() && i < b.areas.size(); ++i)
    compare_areas(find, "areas[" + std::to_string(i) + "]", a.areas[i], b.areas[i]);
  find.field("flags", a.flags, b.flags);
  return find.found();
}

std::string first_difference(const VoxelPartition& a, const VoxelPartition& b) {
  Finder find;
  find.field("grid.origin", a.grid.origin, b.grid.origin);
  find.field("grid.size", a.grid.size, b.grid.size);
  find.field("grid.bricks", a.grid.bricks, b.grid.bricks);
  find.list("classes", a.classes, b.classes);
  find.list("boundary_voxels", a.boundary_voxels, b.boundary_voxels);
  find.list("list_begin", a.list_begin, b.list_begin);
  find.list("list_triangles", a.list_triangles, b.list_triangles);
  return find.found();
}

}  // namespace palpate
