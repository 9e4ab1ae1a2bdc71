#pragma once
#include <string>

#include "shaders/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/module_cases.h"

namespace palpate {

/// Each run of a module held against a definition of what it does, buffer by buffer: also what it leaves
/// alone.
class ModuleTest : public GpuTest {
 protected:
  /// Calls define(run, want, got) for every run of a module: `want`, the buffers before, becomes what they
  /// should be after; what is free to differ may be taken out of both. Everything else must then be equal.
  template <class Define>
  void each(const char* module, const ShaderCode& code, const Define& define) {
    static const auto all = module_runs();
    const auto& runs = all.at(module);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      SCOPED_TRACE(module + (", run " + std::to_string(i)));
      auto got = run_module(device(), code, runs[i]);
      ASSERT_TRUE(got) << got.error().sentence;
      auto want = runs[i].buffers;
      define(runs[i], want, *got);
      want = settled(runs[i], std::move(want));
      for (std::size_t b = 0; b < want.size(); ++b) {
        const auto [w, g] = std::mismatch(want[b].begin(), want[b].end(), (*got)[b].begin());
        EXPECT_TRUE(w == want[b].end())
            << "binding " << b << ", word " << w - want[b].begin() << ": " << *g << ", not " << *w;
      }
    }
  }

  template <class Push>
  static Push push_as(const ModuleRun& run) {
    return values_of<Push>(run.push).at(0);
  }
};

}  // namespace palpate
