// Included by middle_crossings.cpp alone, once for each processor's code (processor.h); so it guards nothing
// and includes nothing. kWidth: floats in a vector of the processor's.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

static MiddleCrossings::Net crossed(const MiddleCrossings::Rows* rows, const MiddleCrossings::Rows* end,
                                    const float (&at)[3]) {
  Words net{}, unsure{};
  for (; rows != end; ++rows)
    for (std::size_t first = 0; first < MiddleCrossings::kEight; first += kWidth) {
      const auto load = [&](const float* from) {
        Floats out;
        std::memcpy(&out, from + first, sizeof out);
        return out;
      };
      const auto place = [&](const float(&row)[3][MiddleCrossings::kEight]) {
        return load(row[0]) * at[0] + load(row[1]) * at[1] + load(row[2]) * at[2];
      };
      Floats least = place(rows->plane) + load(rows->offset);
      for (std::size_t e = 0; e < 3; ++e) {
        const Floats within = place(rows->edge[e]);
        least = within < least ? within : least;
      }
      Words way;
      std::memcpy(&way, rows->way + first, sizeof way);
      const Words crosses = least > MiddleCrossings::kUnsure;
      net += crosses & way;
      unsure |= (least >= -MiddleCrossings::kUnsure) & ~crosses;
    }
  std::int32_t sum = 0, any = 0;
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    sum += net[lane];
    any |= unsure[lane];
  }
  return {sum, any != 0};
}
