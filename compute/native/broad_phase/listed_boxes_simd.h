// Included by listed_boxes.cpp alone, once for each processor's code (processor.h); so it guards nothing and
// includes nothing. kWidth: words in a vector of the processor's; spread() repeats four of them in it.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

// Of sixteen boxes, those that meet the plane: a byte each, all bits or none. A box lies on one side of it
// when the corner does that is nearest to the other. Bytes are turned into floats where they lie in their
// words, each fourth of a vector another byte's.
static Bytes meet_plane(const ListLook& look, const PlaneRows& rows, std::size_t first) {
  Words behind[3], before[3];
  for (std::size_t k = 0; k < 3; ++k) {
    Four four;
    std::memcpy(&four, rows.behind[k] + first, sizeof four);
    spread(four, behind[k]);
    std::memcpy(&four, rows.before[k] + first, sizeof four);
    spread(four, before[k]);
  }
  Four out{};
  for (std::size_t byte = 0; byte < 4; byte += kWidth / 4) {
    Words shift;
    for (std::size_t lane = 0; lane < kWidth; ++lane)
      shift[lane] = static_cast<std::int32_t>(8 * (byte + lane / 4));
    Floats least = Floats{} + look.plane, most = least;
    for (std::size_t k = 0; k < 3; ++k) {
      least += look.facing[k] * __builtin_convertvector(behind[k] >> shift & 0xFF, Floats);
      most += look.facing[k] * __builtin_convertvector(before[k] >> shift & 0xFF, Floats);
    }
    out |= gather((least <= look.slack) & (most >= -look.slack) & 0xFF << shift);
  }
  return (Bytes)out;
}

static std::uint64_t near_boxes(const ListLook& look, const std::uint8_t* boxes, std::size_t stride,
                                std::size_t count) {
  Bytes own[6];
  for (std::size_t k = 0; k < 6; ++k)
    own[k] = Bytes{} + static_cast<std::uint8_t>(std::clamp(look.box[k], 0, kVoxelParts - 1));
  PlaneRows rows;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint8_t *low = boxes + k * stride, *high = low + 3 * stride;
    const bool up = look.facing[k] > 0;
    rows.behind[k] = up ? low : high;
    rows.before[k] = up ? high : low;
  }
  std::uint64_t out = 0;
  for (std::size_t first = 0; first < count; first += kLanes) {
    Bytes its[6];
    for (std::size_t k = 0; k < 6; ++k) std::memcpy(&its[k], boxes + k * stride + first, sizeof its[k]);
    const Bytes meet = (Bytes)(its[0] <= own[3]) & (Bytes)(its[1] <= own[4]) & (Bytes)(its[2] <= own[5]) &
                       (Bytes)(own[0] <= its[3]) & (Bytes)(own[1] <= its[4]) & (Bytes)(own[2] <= its[5]);
    const auto any = (Halves)meet;
    if ((any[0] | any[1]) == 0) continue;
    const auto both = (Halves)(meet & meet_plane(look, rows, first));
    for (std::size_t half = 0; half < 2; ++half)  // a bit a byte
      out |= (both[half] & 0x0101010101010101u) * 0x0102040810204080u >> 56 << (first + 8 * half);
  }
  return count < kMostBoxes ? out & ((std::uint64_t{1} << count) - 1) : out;
}
