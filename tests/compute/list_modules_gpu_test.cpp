#include <algorithm>

#include "tests/compute/module_test.h"

namespace palpate {
namespace {

using ListModules = ModuleTest;
constexpr std::uint64_t kMost = 0xFFFFFFFFu;

TEST_F(ListModules, ChunksAreAddedAndStayAtTheLargestNumber) {
  each("scan_chunks", spirv::scan_chunks, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const std::uint32_t count = run.push[0];
    for (std::uint32_t first = 0; first < count; first += gpu::kScanChunk) {
      std::uint64_t sum = 0;
      for (std::uint32_t i = first; i < std::min(first + gpu::kScanChunk, count); ++i) sum += want[0][i];
      want[1][first / gpu::kScanChunk] = static_cast<std::uint32_t>(std::min(sum, kMost));
    }
  });
}

TEST_F(ListModules, ANumberBecomesTheSumOfThoseBeforeIt) {
  each("scan_apply", spirv::scan_apply, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    for (std::uint32_t i = 0; i < run.push[0]; ++i) {
      std::uint64_t sum = run.push[1] != 0 ? run.buffers[1][i / gpu::kScanChunk] : 0;
      for (std::uint32_t before = i / gpu::kScanChunk * gpu::kScanChunk; before < i; ++before)
        sum += run.buffers[0][before];
      want[0][i] = static_cast<std::uint32_t>(std::min(sum, kMost));
    }
  });
}

/// Writes the first `count` of `from` to where they are in order among the `run` entries from each run-th of
/// a list on.
void place(const Words& begin, const Words& from, std::uint32_t run, std::uint32_t count, Words& to) {
  for (std::size_t list = 0; list + 1 < begin.size(); ++list)
    for (std::uint32_t first = begin[list]; first < begin[list + 1]; first += run) {
      const std::uint32_t end = std::min(first + run, begin[list + 1]);
      Words sorted(from.begin() + first, from.begin() + end);
      std::sort(sorted.begin(), sorted.end());
      for (std::uint32_t entry = first; entry < std::min(end, count); ++entry)
        to[first + static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), from[entry]) -
                                            sorted.begin())] = from[entry];
    }
}

TEST_F(ListModules, ChunksOfListsAreSortedAndTheLongestListIsTold) {
  each("list_rank", spirv::list_rank, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    const Words& begin = run.buffers[1];
    place(begin, run.buffers[2], gpu::kRankSpan, run.push[0], want[3]);
    for (std::size_t list = 0; list + 1 < begin.size(); ++list)
      if (const std::uint32_t length = begin[list + 1] - begin[list]; length > gpu::kRankSpan)
        want[4][0] = std::max(want[4][0], length);
  });
}

TEST_F(ListModules, NeighbouringRunsAreMerged) {
  each("list_merge", spirv::list_merge, [](const ModuleRun& run, std::vector<Words>& want, auto&) {
    place(run.buffers[1], run.buffers[2], 2 * run.push[1], run.push[0], want[3]);
  });
}

TEST_F(ListModules, PairsGoToTheirVoxelsInAnyOrder) {
  each("pair_scatter", spirv::pair_scatter,
       [](const ModuleRun& run, std::vector<Words>& want, std::vector<Words>& got) {
         for (std::uint32_t pair = 0; pair < run.push[0]; ++pair) {
           const std::uint32_t entry = want[2][run.buffers[1][pair]]++;
           want[3][entry] = run.buffers[0][pair];
           want[4][entry] = run.buffers[1][pair];
         }
         for (auto* buffers : {&want, &got})
           for (std::size_t v = 0; v < run.buffers[2].size(); ++v)
             std::sort((*buffers)[3].begin() + run.buffers[2][v], (*buffers)[3].begin() + want[2][v]);
       });
}

}  // namespace
}  // namespace palpate
