#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "model/contact/contacts.h"
#include "shaders/shared/frame.h"

namespace palpate {

/// What a finished frame left in mapped memory.
struct FrameOutput {
  const gpu::FrameResult* result = nullptr;
  const gpu::StaticResult* statics = nullptr;
  const gpu::MobileResult* mobiles = nullptr;
  const gpu::AreaMember* members = nullptr;
  bool areas = true;  ///< `paper`: the device has made them
};

/// Puts frames' outputs in the order that Contacts asks for: ids ascending, areas by id, zones by first id.
/// Keeps the memory of areas that an answer no longer has for later ones, so that it allocates only when a
/// contact is larger than all before. One thread.
class FrameDecoder {
 public:
  /// Writes all of `out` but its times. A frame that overflowed becomes a truncated one without areas, and
  /// without sets unless they were complete. Where Contacts::lists is false, sets, zones and mobile ids stay
  /// empty.
  void decode(const FrameOutput& output, Contacts& out);
  /// Empties all of `out` but its times: free of contact.
  void clear(Contacts& out);

 private:
  void decode_sets(const FrameOutput& output, Contacts& out);
  void decode_areas(const FrameOutput& output, Contacts& out);
  std::vector<std::uint32_t>& new_zone(ContactArea& area);

  template <class Entry, class Id>
  std::span<const Entry> by_id(std::span<const Entry> entries, Id id, std::vector<Entry>& sorted);

  std::span<const gpu::StaticResult> statics_;  ///< of the present output, by id
  std::vector<gpu::StaticResult> sorted_statics_;
  std::vector<gpu::MobileResult> sorted_mobiles_;
  std::vector<gpu::AreaMember> sorted_members_;
  std::vector<std::uint64_t> keys_, spare_keys_;
  std::vector<std::uint32_t> zone_of_;  ///< by label: position in its area's zones
  std::vector<ContactArea> spare_areas_;
  std::vector<std::vector<std::uint32_t>> spare_zones_;
};

}  // namespace palpate
