// Included by room_field.cpp alone, once for each processor's code (compute/native/processor.h); so it guards
// nothing and includes nothing. kWidth: floats in a vector of the processor's.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

// Cells that turned centres lie in, or that are nearest to them, and the squares of how far off those are.
static void cells_of(const RoomField::Turn& turn, const float end[3], const EightSpheres& spheres,
                     std::int32_t cell[3][kLanes], float* away) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) {
    Floats x, y, z, sum{};
    std::memcpy(&x, spheres.centre[0].data() + begin, sizeof x);
    std::memcpy(&y, spheres.centre[1].data() + begin, sizeof y);
    std::memcpy(&z, spheres.centre[2].data() + begin, sizeof z);
    for (std::size_t r = 0; r < 3; ++r) {
      const Floats at =
          turn.rotation[r][0] * x + turn.rotation[r][1] * y + turn.rotation[r][2] * z + turn.at[r];
      const Floats none{}, last = none + (end[r] - 1);
      Floats within = at > none ? at : none;
      within = within < last + 1 ? within : last + 1;
      const Floats off = at - within;
      sum += off * off;
      const Words number = __builtin_convertvector(within < last ? within : last, Words);  // down
      std::memcpy(cell[r] + begin, &number, sizeof number);
    }
    std::memcpy(away + begin, &sum, sizeof sum);
  }
}
