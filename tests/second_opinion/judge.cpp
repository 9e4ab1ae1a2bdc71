// usage: second_opinion_judge DIRECTORY [STRIDE]
// Judges what `palpate query --export-geometry DIRECTORY` wrote. Pose 0 must be without rotation. Prints one
// JSON object of counts; exit code 1 when anything differs, with the first differences on standard error.
// STRIDE: of the voxels off the surface every STRIDE-th is judged.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string>

#include "tests/second_opinion/judge_pairs.h"
#include "tests/second_opinion/judge_voxels.h"

namespace {

using namespace second_opinion;

struct Counts {
  std::size_t poses = 0, touching = 0, pairs = 0, cross = 0, overlap = 0, touch = 0, missing = 0, extra = 0;
};

std::filesystem::path file(const std::filesystem::path& directory, const char* name, std::size_t pose,
                           const char* ending) {
  return directory / (name + std::to_string(pose) + ending);
}

Counts judge_poses(const std::filesystem::path& directory, const std::vector<Triangle>& statics) {
  Counts counts;
  const PairJudge judge(statics, read_triangles(directory / "tool_0.i32"));
  for (std::size_t pose = 0; std::filesystem::exists(file(directory, "pairs_", pose, ".u32")); ++pose) {
    const std::vector<Triangle> moved = read_triangles(file(directory, "tool_", pose, ".i32"));
    const Pairs ours = judge.pairs(moved), theirs = read_pairs(file(directory, "pairs_", pose, ".u32"));
    Pairs missing, extra;
    std::set_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(missing));
    std::set_difference(theirs.begin(), theirs.end(), ours.begin(), ours.end(), std::back_inserter(extra));
    for (const auto& [list, word] : {std::pair(&missing, "missing"), std::pair(&extra, "extra")})
      if (!list->empty())
        std::fprintf(stderr, "pose %zu: %zu pairs %s, the first is static %u, mobile %u\n", pose,
                     list->size(), word, list->front().first, list->front().second);
    ++counts.poses;
    counts.touching += ours.empty() ? 0u : 1u;
    counts.pairs += ours.size();
    counts.missing += missing.size();
    counts.extra += extra.size();
    for (const auto& [s, m] : ours) {
      const Meeting meeting = judge.meeting(statics[s], moved[m]);
      ++(meeting == Meeting::kCross   ? counts.cross
         : meeting == Meeting::kTouch ? counts.touch
                                      : counts.overlap);
    }
  }
  return counts;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw std::runtime_error("usage: second_opinion_judge DIRECTORY [STRIDE]");
    const std::filesystem::path directory = argv[1];
    const std::vector<Triangle> statics = read_triangles(directory / "static.i32");
    const Counts p = judge_poses(directory, statics);
    const VoxelVerdict v = judge_voxels(statics, read_voxels(directory), argc > 2 ? std::stoul(argv[2]) : 1);
    if (!v.first_difference.empty()) std::fprintf(stderr, "%s\n", v.first_difference.c_str());
    std::printf(
        "{\"poses\":%zu,\"touching\":%zu,\"pairs\":%zu,\"cross\":%zu,\"overlap\":%zu,\"touch\":%zu,"
        "\"missing\":%zu,\"extra\":%zu,"
        "\"closed\":%s,\"boundary\":%zu,\"boundary_missing\":%zu,\"boundary_extra\":%zu,\"centres\":%zu,"
        "\"inside\":%zu,\"wrong\":%zu}\n",
        p.poses, p.touching, p.pairs, p.cross, p.overlap, p.touch, p.missing, p.extra,
        v.closed ? "true" : "false", v.boundary, v.missing_boundary, v.extra_boundary, v.judged, v.internal,
        v.wrong);
    return p.missing + p.extra + v.missing_boundary + v.extra_boundary + v.wrong == 0 ? 0 : 1;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "second_opinion_judge: %s\n", failure.what());
    return 2;
  }
}
