// Included by candidate_samples.cpp alone, once for each processor's code (processor.h); so it guards nothing
// and includes nothing. kWidth: floats in a vector of the processor's.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Doubles = double __attribute__((vector_size(8 * kWidth / 2)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));
using HalfWords = std::int32_t __attribute__((vector_size(2 * kWidth)));

// Of voxels of a brick, those whose centres lie in cells near the solid: their places in `voxels`, packed at
// the front of `near`.
static std::size_t near_voxels(const NearTurn& turn, const BrickVoxels& voxels, const NearCells& cells,
                               std::uint16_t* near) {
  constexpr std::size_t kHalf = kWidth / 2;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < voxels.count; begin += kHalf) {
    HalfWords code;
    std::memcpy(&code, voxels.bit + begin, sizeof code);
    const Doubles x = __builtin_convertvector(code & 7, Doubles),
                  y = __builtin_convertvector(code >> 3 & 7, Doubles),
                  z = __builtin_convertvector(code >> 6 & 7, Doubles);
    HalfWords may = HalfWords{} - 1, cell{};
    for (std::size_t k = 3; k-- > 0;) {
      const Doubles at =
          voxels.first_centre[k] + turn.column[k][0] * x + turn.column[k][1] * y + turn.column[k][2] * z;
      may &= __builtin_convertvector((at >= -cells.beyond) & (at <= cells.end[k] + cells.beyond), HalfWords);
      const Doubles low = at < 0 ? Doubles{} : at, last = Doubles{} + (cells.end[k] - 1);
      cell = cell * cells.size[k] + __builtin_convertvector(low < last ? low : last, HalfWords);  // down
    }
    std::int32_t index[kHalf], good[kHalf];
    std::memcpy(index, &cell, sizeof cell);
    std::memcpy(good, &may, sizeof may);
    for (std::size_t lane = 0; lane < kHalf; ++lane) {
      near[count] = static_cast<std::uint16_t>(begin + lane);
      const auto i = static_cast<std::uint32_t>(index[lane]);
      count += cells.bits[i >> 5] >> (i & 31) & static_cast<std::uint32_t>(good[lane]) & 1u;
    }
  }
  while (count > 0 && near[count - 1] >= voxels.count) --count;
  return count;
}

// Of kEight points of a voxel (words of VoxelSamples::points) those that may lie in the solid.
static void solid_points(const PointTurn& turn, const float (&low)[3], const SolidBits& solid,
                         const std::uint32_t* points, SolidPoints& out) {
  out.may = out.unsure = 0;
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Words word;
    std::memcpy(&word, points + begin, sizeof word);
    constexpr std::int32_t kMost = (1 << VoxelSamples::kPointBits) - 1;
    const Floats x = __builtin_convertvector(word & kMost, Floats),
                 y = __builtin_convertvector(word >> VoxelSamples::kPointBits & kMost, Floats),
                 z = __builtin_convertvector(word >> 2 * VoxelSamples::kPointBits & kMost, Floats);
    Words may = Words{} - 1, beside{}, brick{}, bit{};
    for (std::size_t k = 3; k-- > 0;) {
      const float(&column)[3] = turn.column[k];
      const Floats at = low[k] + column[0] * x + column[1] * y + column[2] * z;
      const float end = turn.end[k];
      may &= (at >= -turn.error) & (at <= end + turn.error);
      const Floats from = at < 0 ? Floats{} : at, last = Floats{} + (end - 1);
      const Words cell = __builtin_convertvector(from < last ? from : last, Words);  // down
      const Floats in_cell = at - __builtin_convertvector(cell, Floats);
      beside |= (in_cell < turn.error) | (in_cell > 1 - turn.error);
      brick = brick * solid.size()[static_cast<int>(k)] + (cell >> 3);
      bit = bit << 3 | (cell & 7);
    }
    std::uint32_t good[kWidth], unsure[kWidth];
    std::uint32_t bricks[kWidth];
    std::memcpy(bricks, &brick, sizeof brick);
    std::memcpy(out.bit + begin, &bit, sizeof bit);
    std::memcpy(good, &may, sizeof may);
    std::memcpy(unsure, &beside, sizeof beside);
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
      out.block[begin + lane] = solid.number(bricks[lane]);
      const auto in =
          static_cast<std::uint32_t>(solid.block(out.block[begin + lane]).may_at(out.bit[begin + lane]));
      out.may |= ((in | unsure[lane]) & good[lane] & 1u) << (begin + lane);
      out.unsure |= (unsure[lane] & 1u) << (begin + lane);
    }
  }
}
