// Each kernel of preparation on its own: time and items a second, on the chapter's disassembly in three
// sizes. A kernel runs with what those before it have left, so that its work is real; a repetition is a whole
// preparation.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <string>

#include "compute/gpu/prepare/prepared_scene.h"
#include "model/generate.h"
#include "model/scene/geometry_build.h"

namespace {

using namespace palpate;

constexpr int kRepetitions = 3;

struct Runs {
  std::vector<double> seconds;  ///< one a repetition: all dispatches of the kernel
  std::uint64_t items = 0;      ///< of the last repetition
};

std::map<std::string, Runs> measure(VulkanDevice& device, std::uint64_t triangles) {
  const auto scene = generate_scene("disassembly", triangles, 2000);
  const auto geometry =
      scene ? build_geometry(scene->mockup, scene->tool, {}) : Result<SceneGeometry>(scene.error());
  std::map<std::string, Runs> out;
  if (!geometry) return out;
  for (int repetition = -1; repetition < kRepetitions; ++repetition) {  // the first one compiles
    std::map<std::string, Runs> sums;
    device.kernel_watch = [&](const char* kernel, std::uint64_t items, double seconds) {
      Runs& runs = sums[kernel];
      runs.seconds.resize(1);
      runs.seconds.front() += seconds;
      runs.items += items;
    };
    const auto prepared = prepare_scene(device, *geometry, Plan{}, {});
    device.kernel_watch = nullptr;
    if (!prepared) {
      std::fprintf(stderr, "%s\n", prepared.error().sentence.c_str());
      return {};
    }
    if (repetition < 0) continue;
    for (const auto& [kernel, runs] : sums) {
      out[kernel].seconds.push_back(runs.seconds.front());
      out[kernel].items = runs.items;
    }
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  auto device = VulkanDevice::create(DeviceOptions{});
  if (!device) {
    std::fprintf(stderr, "%s\n", device.error().sentence.c_str());
    return 4;
  }
  benchmark::AddCustomContext("device", (*device)->name() + ", " + (*device)->driver());
  std::map<std::uint64_t, std::map<std::string, Runs>> all;
  for (const std::uint64_t triangles :
       {std::uint64_t{10'000}, std::uint64_t{100'000}, std::uint64_t{300'000}})
    all[triangles] = measure(**device, triangles);
  for (const auto& [triangles, kernels] : all)
    for (const auto& [kernel, measured] : kernels)
      benchmark::RegisterBenchmark(
          (kernel + "/" + std::to_string(triangles)).c_str(),
          [&runs = measured](benchmark::State& state) {
            std::size_t i = 0;
            for ([[maybe_unused]] auto _ : state)
              state.SetIterationTime(runs.seconds[i++ % runs.seconds.size()]);
            state.SetItemsProcessed(static_cast<std::int64_t>(runs.items) * state.iterations());
          })
          ->UseManualTime()
          ->Iterations(kRepetitions)
          ->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
