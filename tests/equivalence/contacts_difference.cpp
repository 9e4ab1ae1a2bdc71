#include "tests/equivalence/contacts_difference.h"

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
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) field(name + "[" + std::to_string(i) + "]", a[i], b[i]);
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

void compare_areas(Finder& find, const std::string& name, const ContactArea& a, const ContactArea& b) {
  find.field(name + ".id", a.id, b.id);
  find.list(name + ".static_ids", a.static_ids, b.static_ids);
  find.field(name + ".zones.size", a.zones.size(), b.zones.size());
  for (std::size_t i = 0; i < a.zones.size() && i < b.zones.size(); ++i)
    find.list(name + ".zones[" + std::to_string(i) + "]", a.zones[i], b.zones[i]);
  find.list(name + ".mobile_ids", a.mobile_ids, b.mobile_ids);
  find.field(name + ".sheet_sign", static_cast<int>(a.sheet_sign), static_cast<int>(b.sheet_sign));
  find.field(name + ".flags", a.flags, b.flags);
  find.field(name + ".direction", a.direction, b.direction);
  find.field(name + ".rays", a.rays, b.rays);
  find.field(name + ".max_height", a.max_height, b.max_height);
  find.field(name + ".weight_sum", a.weight_sum, b.weight_sum);
  find.field(name + ".height_sum", a.height_sum, b.height_sum);
  find.field(name + ".faded_sum", a.faded_sum, b.faded_sum);
  find.field(name + ".faded_rest", a.faded_rest, b.faded_rest);
  find.field(name + ".weight_slope", a.weight_slope, b.weight_slope);
  find.field(name + ".height_slope", a.height_slope, b.height_slope);
  for (std::size_t k = 0; k < 3; ++k) {
    find.field(name + ".moment.low", a.moment[k].low, b.moment[k].low);
    find.field(name + ".moment.high", a.moment[k].high, b.moment[k].high);
    find.field(name + ".voxel_sum", a.voxel_sum[k], b.voxel_sum[k]);
  }
  find.field(name + ".voxel_count", a.voxel_count, b.voxel_count);
  find.list(name + ".pierces", a.pierces, b.pierces);
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
  find.field("areas.size", a.areas.size(), b.areas.size());
  for (std::size_t i = 0; i < a.areas.size() && i < b.areas.size(); ++i)
    compare_areas(find, "areas[" + std::to_string(i) + "]", a.areas[i], b.areas[i]);
  find.field("flags", a.flags, b.flags);
  find.field("swallowed_direction", a.swallowed_direction, b.swallowed_direction);
  find.field("swallowed_height", a.swallowed_height, b.swallowed_height);
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
