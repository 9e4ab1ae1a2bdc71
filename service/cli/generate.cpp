#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "model/generate.h"
#include "service/cli/cli.h"
#include "service/cli/numbers.h"
#include "service/cli/output_folder.h"

namespace palpate {
namespace {

// What people edit, or exchange for parts of theirs.
constexpr const char* kSceneFiles[] = {"scene.json", "mockup.stl", "tool.stl", "path.csv", "guide.csv"};

}  // namespace

Result<void> generate_command(const GenerateOptions& options) {
  if (auto done = check_output_folder(options.out, kSceneFiles, "a scene's", options.overwrite); !done)
    return done;
  const Result<GeneratedScene> scene =
      generate_scene(options.name, options.triangles, options.tool_triangles);
  if (!scene) return scene.error();
  if (auto done = write_generated(*scene, options.name, options.out); !done) return done;
  fmt::print("{}: mock-up of {} triangles, tool of {}, a path of {:.1f} s\n", options.name,
             count_text(scene->mockup.triangles.size()), count_text(scene->tool.triangles.size()),
             scene->path.empty() ? 0.0 : scene->path.back().time_s);
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(options.out))
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) fmt::print("{}\n", file);
  return {};
}

}  // namespace palpate
