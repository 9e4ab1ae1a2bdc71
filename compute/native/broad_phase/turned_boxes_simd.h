// Included by turned_boxes.cpp alone, once for each processor's code (processor.h); so it guards nothing and
// includes nothing. kWidth: floats in a vector of the processor's.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

static void load(const Eight& from, std::size_t begin, Floats& out) {
  std::memcpy(&out, from.data() + begin, sizeof out);
}

// Along an axis, from a lane on: voxels of boxes from `least` to `most`, turned but not moved.
static void clip(const VoxelTurn& turn, std::size_t axis, std::size_t begin, const Floats& least,
                 const Floats& most, Words& may, EightRanges& out, Floats* parts = nullptr) {
  const Floats none{}, end = none + turn.end[axis], low = least + turn.below[axis],
                       high = most + turn.above[axis];
  may &= (high >= none) & (low < end);
  const Floats from = low < none ? none : low, to = high < none ? none : high;
  const Words first = __builtin_convertvector(from < end ? from : end - 1, Words),
              last = __builtin_convertvector(to < end ? to : end - 1, Words);  // down
  if (parts != nullptr) {
    parts[0] = from < end ? from : end;
    parts[1] = to < end ? to : end;
  }
  std::memcpy(out.first[axis] + begin, &first, sizeof first);
  std::memcpy(out.last[axis] + begin, &last, sizeof last);
}

static void of_boxes(const VoxelTurn& turn, const EightBoxes& boxes, EightRanges& out) {
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats cx, cy, cz, hx, hy, hz;
    load(boxes.centre[0], begin, cx);
    load(boxes.centre[1], begin, cy);
    load(boxes.centre[2], begin, cz);
    load(boxes.half[0], begin, hx);
    load(boxes.half[1], begin, hy);
    load(boxes.half[2], begin, hz);
    Words may = Words{} - 1;
    for (std::size_t r = 0; r < 3; ++r) {
      const float x = turn.rotation[r][0], y = turn.rotation[r][1], z = turn.rotation[r][2];
      const Floats centre = x * cx + y * cy + z * cz,
                   half = (x < 0 ? -x : x) * hx + (y < 0 ? -y : y) * hy + (z < 0 ? -z : z) * hz;
      clip(turn, r, begin, centre - half, centre + half, may, out);
    }
    std::memcpy(out.may + begin, &may, sizeof may);
  }
}

static void of_triangles(const VoxelTurn& turn, const EightTriangles& corners, EightRanges& out) {
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats at[9];
    for (std::size_t i = 0; i < 9; ++i) load(corners[i], begin, at[i]);
    Words may = Words{} - 1;
    for (std::size_t r = 0; r < 3; ++r) {
      const float x = turn.rotation[r][0], y = turn.rotation[r][1], z = turn.rotation[r][2];
      const Floats a = x * at[0] + y * at[1] + z * at[2], b = x * at[3] + y * at[4] + z * at[5],
                   c = x * at[6] + y * at[7] + z * at[8];
      const Floats least = a < b ? a : b, most = a < b ? b : a;
      Floats parts[2];
      clip(turn, r, begin, least < c ? least : c, most < c ? c : most, may, out, parts);
      const Words low = __builtin_convertvector(parts[0] * kVoxelParts, Words),
                  high = __builtin_convertvector(parts[1] * kVoxelParts, Words);  // down
      std::memcpy(out.low[r] + begin, &low, sizeof low);
      std::memcpy(out.high[r] + begin, &high, sizeof high);
    }
    std::memcpy(out.may + begin, &may, sizeof may);
  }
}
