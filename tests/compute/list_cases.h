#pragma once
#include <algorithm>
#include <vector>

#include "shaders/shared/prepare.h"
#include "tests/compute/module_run.h"

/// Runs of the modules that add, scatter and sort. In each, buffers go on behind `count`, and so do
/// invocations: what they leave alone shows.
namespace palpate::list_cases {

inline constexpr std::uint32_t kUntouched = 0xA5A5A5A5u;

inline Words random_words(Numbers& random, std::size_t count, std::uint32_t below) {
  Words words(count);
  for (std::uint32_t& w : words) w = random() % below;
  return words;
}

/// Prefix sums: lengths about a chunk's, one of more numbers than an invocation's loops may run, and sums
/// that don't fit.
inline std::vector<ModuleRun> scans() {
  Numbers random(21);
  std::vector<ModuleRun> runs;
  for (const std::uint32_t count : {1u, 63u, 64u, 65u, 128u, 4096u, 70'000u})
    for (const std::uint32_t below : {10u, 0xFFFFFFFFu}) {
      const std::uint32_t chunks = (count + gpu::kScanChunk - 1) / gpu::kScanChunk;
      runs.push_back({"scan_chunks",
                      {random_words(random, count + 200, below), Words(chunks + 4, kUntouched)},
                      {count},
                      chunks + 70,
                      {},
                      chunks > 100 ? 3u : 1u});
      for (const std::uint32_t has_bases : {0u, 1u})
        runs.push_back({"scan_apply",
                        {random_words(random, count + 200, below), random_words(random, chunks + 4, 1000)},
                        {count, has_bases},
                        chunks + 70});
    }
  return runs;
}

/// Lists of numbers, distinct in each.
struct Lists {
  Words begin{0}, numbers, entry_voxel;
  void add(Words list) {
    entry_voxel.insert(entry_voxel.end(), list.size(), static_cast<std::uint32_t>(begin.size() - 1));
    numbers.insert(numbers.end(), list.begin(), list.end());
    begin.push_back(static_cast<std::uint32_t>(numbers.size()));
  }
};

inline Words distinct(Numbers& random, std::uint32_t length) {
  Words list(length);
  std::uint32_t number = 0;
  for (std::uint32_t& n : list) n = number += 1 + random() % 3;
  std::shuffle(list.begin(), list.end(), random);
  return list;
}

/// Sorting by chunks, and merging them: lists about as long as a chunk, two, several, the last one not full.
inline std::vector<ModuleRun> sorts() {
  Numbers random(22);
  std::vector<ModuleRun> runs;
  Lists chunks, lists;  // the former's are a chunk each at most
  for (const std::uint32_t length : {3u, 256u, 100u}) chunks.add(distinct(random, length));
  runs.push_back(
      {"list_rank",
       {chunks.entry_voxel, chunks.begin, chunks.numbers, Words(chunks.numbers.size(), kUntouched), {0}},
       {300},
       400});
  for (const std::uint32_t length :
       {1u, 2u, 255u, 256u, 257u, 511u, 512u, 513u, 1u, 3000u, 768u, 1025u, 5u, 400u})
    lists.add(distinct(random, length));
  const auto entries = static_cast<std::uint32_t>(lists.numbers.size());
  const std::uint32_t count = entries - 100;  // the last list's last entries are left out
  runs.push_back({"list_rank",
                  {lists.entry_voxel, lists.begin, lists.numbers, Words(entries, kUntouched), {0}},
                  {count},
                  entries + 64});
  for (const std::uint32_t run :
       {256u, 512u, 1024u, 7u}) {  // any number does; lists about as long as the small one, too
    Lists from;
    for (std::uint32_t length = 1; length < 25 && run < 10; ++length) from.add(distinct(random, length));
    if (run > 10) from = lists;
    for (std::size_t i = 0; i + 1 < from.begin.size(); ++i)
      for (std::uint32_t at = from.begin[i]; at < from.begin[i + 1]; at += run)
        std::sort(from.numbers.begin() + at, from.numbers.begin() + std::min(at + run, from.begin[i + 1]));
    const auto all = static_cast<std::uint32_t>(from.numbers.size());
    runs.push_back({"list_merge",
                    {from.entry_voxel, from.begin, from.numbers, Words(all, kUntouched)},
                    {all - 20, run},
                    all + 64});
  }
  return runs;
}

/// Pairs put into their voxels' lists.
inline std::vector<ModuleRun> scatters() {
  Numbers random(23);
  constexpr std::uint32_t kVoxels = 40, kPairs = 900, kCount = 801;
  const Words voxel = random_words(random, kPairs, kVoxels);
  Words cursors(kVoxels, 0), triangle(kPairs);
  for (const std::uint32_t v : voxel)
    for (std::uint32_t later = v + 1; later < kVoxels; ++later) ++cursors[later];
  for (std::uint32_t i = 0; i < kPairs; ++i) triangle[i] = 7 * i + 3;
  return {{"pair_scatter",
           {triangle, voxel, cursors, Words(kPairs, kUntouched), Words(kPairs, kUntouched)},
           {kCount},
           kPairs + 64}};
}

}  // namespace palpate::list_cases
