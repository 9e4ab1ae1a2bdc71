// Walks every #include of the project and holds it against the architecture (docs/ARCHITECTURE.md).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;

const fs::path kRoot = PALPATE_SOURCE_DIR;

struct Include {
  std::string file;    // relative to the root
  std::string target;  // as written
  bool quoted;
};

std::vector<Include> includes_below(const std::string& folder) {
  static const std::regex line_pattern(R"(^\s*#\s*include\s*(["<])([^">]+)[">])");
  std::vector<Include> found;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".h" && extension != ".cpp" && extension != ".comp" && extension != ".glsl") continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (std::regex_search(line, match, line_pattern))
        found.push_back({fs::relative(entry.path(), kRoot).string(), match[2], match[1] == "\""});
    }
  }
  return found;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const auto& prefix : prefixes)
    if (text.rfind(prefix, 0) == 0) return true;
  return false;
}

// Which of our folders each folder may include. shaders/code.h is what the build makes of the shaders,
// generated/ of assets.
const std::map<std::string, std::vector<std::string>> kAllowed = {
    {"model", {"model/"}},
    {"shaders", {"shaders/"}},
    {"compute/scene", {"compute/scene/", "model/", "shaders/shared/"}},
    {"compute/vulkan",
     {"compute/vulkan/", "model/address_space.h", "model/processors.h", "model/result.h",
      "shaders/shared/base.h", "shaders/shared/shader_code.h"}},  // no word of collision
    {"compute/gpu",
     {"compute/gpu/", "compute/vulkan/", "compute/scene/", "model/", "shaders/shared/",
      "shaders/code.h"}},  // it searches on the device
    {"compute/native",
     {"compute/native/", "compute/scene/", "model/", "shaders/shared/"}},  // engines do not name each other
    {"cpu_ref", {"cpu_ref/", "model/"}},
    {"driver", {"driver/", "model/"}},
    {"service",
     {"service/", "model/", "driver/device_notes.h", "driver/haptic_device.h", "driver/limits.h",
      "driver/mass_spring.h", "driver/safe_device.h", "generated/"}},
};

TEST(IncludeGraph, EveryFolderIncludesOnlyWhatItMay) {
  for (const auto& [folder, allowed] : kAllowed) {
    const auto found = includes_below(folder);
    for (const auto& include : found) {
      if (!include.quoted || include.file == "service/main.cpp" || include.file == "service/engines.cpp")
        continue;
      EXPECT_TRUE(starts_with_any(include.target, allowed)) << include.file << " includes " << include.target;
    }
  }
}

TEST(IncludeGraph, TheWalkSeesTheTree) {
  // Guards the test above: a wrong root or pattern would find nothing and pass.
  EXPECT_GT(includes_below("model").size(), 20u);
}

TEST(IncludeGraph, EveryFolderOfComputeIsAnArrowsEnd) {
  // A new folder, or a file beside them, would escape the first test.
  for (const auto& entry : fs::directory_iterator(kRoot / "compute"))
    EXPECT_TRUE(entry.path().filename() == "CMakeLists.txt" ||
                kAllowed.contains("compute/" + entry.path().filename().string()))
        << entry.path();
}

TEST(IncludeGraph, TheLoopsKnowNoFrontEnd) {
  // The installed library is loop/ and queries/: neither command line, nor server, report or bench.
  for (const std::string folder : {"service/loop", "service/queries"}) {
    const auto found = includes_below(folder);
    EXPECT_GT(found.size(), 20u) << folder;
    for (const auto& include : found)
      if (include.quoted) {
        EXPECT_TRUE(
            starts_with_any(include.target, {"service/loop/", "service/queries/", "model/", "driver/"}))
            << include.file << " includes " << include.target;
      }
  }
}

TEST(Layout, NoFolderIsAHeap) {
  // Forty files are what a reader takes in at a look; more want folders of their own.
  std::size_t folders = 0;
  for (const auto& [top, allowed] : kAllowed) {
    std::map<std::string, int> files;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top))
      if (entry.is_regular_file() && entry.path().string().find("node_modules") == std::string::npos)
        ++files[entry.path().parent_path().string()];
    for (const auto& [folder, count] : files) {
      ++folders;
      EXPECT_LE(count, 40) << folder;
    }
  }
  EXPECT_GT(folders, 30u);  // the walk sees the tree
}

TEST(IncludeGraph, NothingIncludesTestsOrBench) {
  for (const auto& [folder, allowed] : kAllowed)
    for (const auto& include : includes_below(folder))
      EXPECT_FALSE(starts_with_any(include.target, {"tests/", "bench/"})) << include.file;
}

TEST(IncludeGraph, ALibraryStaysInTheFolderThatUsesIt) {
  const std::map<std::string, std::vector<std::string>> only_in = {
      {"vulkan/", {"compute/vulkan"}}, {"embree3/", {"cpu_ref"}}, {"embree4/", {"cpu_ref"}},
      {"libusb", {"driver"}},          {"assimp/", {"model"}},    {"CLI/", {"service"}}};
  for (const auto& [folder, allowed] : kAllowed)
    for (const auto& include : includes_below(folder))
      for (const auto& [prefix, homes] : only_in)
        if (include.target.rfind(prefix, 0) == 0) {
          EXPECT_THAT(homes, testing::Contains(folder)) << include.file << " includes " << include.target;
        }
}

TEST(IncludeGraph, PublicHeadersNameNoLibraryButGlm) {
  // What `cmake --install` hands out must compile without Vulkan, Embree, assimp or JSON headers.
  for (const std::string file :
       {"compute/gpu/gpu_backend.h", "compute/vulkan/options.h", "compute/native/native_backend.h",
        "cpu_ref/ref_backend.h", "driver/haptic_device.h"})
    for (const auto& include : includes_below(fs::path(file).parent_path().string()))
      if (include.file == file && !include.quoted) {
        EXPECT_EQ(include.target.find_first_of("/."), std::string::npos)
            << file << " includes " << include.target;
      }
}

/// Types defined in named namespaces of our folders, with where.
std::map<std::string, std::vector<std::string>> types_by_name() {
  static const std::regex space(R"(^namespace ([\w:]+) \{)"), anonymous(R"(^namespace \{)"),
      end(R"(^\}  // namespace(.*))"),
      type(R"(^(?:struct|class|enum(?: class)?) (\w+)(?: final)?(?: : [^;]*)? \{)");
  std::map<std::string, std::vector<std::string>> found;
  for (const auto& [folder, allowed] : kAllowed)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (folder == "shaders" || (entry.path().extension() != ".h" && entry.path().extension() != ".cpp"))
        continue;
      std::ifstream in(entry.path());
      std::string name;
      int hidden = 0;
      for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (std::regex_search(line, match, anonymous))
          ++hidden;
        else if (std::regex_search(line, match, space))
          name = match[1];
        else if (std::regex_search(line, match, end) && match[1].length() == 0 && hidden > 0)
          --hidden;
        else if (hidden == 0 && !name.empty() && std::regex_search(line, match, type))
          found[name + "::" + match.str(1)].push_back(entry.path().string());
      }
    }
  return found;
}

TEST(OneDefinition, NoTwoTypesShareAName) {
  // Two structs palpate::PreparedScene, one of compute/ and one of service/, once destroyed each other:
  // linkers merge what is named alike.
  const auto types = types_by_name();
  EXPECT_GT(types.size(), 100u);  // the scan sees the tree
  for (const auto& [name, places] : types)
    EXPECT_EQ(places.size(), 1u) << name << " is defined in " << places.front() << " and " << places.back();
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A shader and all that it includes.
std::set<std::string> with_includes(const std::string& shader,
                                    const std::multimap<std::string, std::string>& includes) {
  std::set<std::string> all{shader};
  std::vector<std::string> open{shader};
  while (!open.empty()) {
    const auto [first, last] = includes.equal_range(open.back());
    open.pop_back();
    for (auto it = first; it != last; ++it)
      if (all.insert(it->second).second) open.push_back(it->second);
  }
  return all;
}

// Nothing else notices a frame that has lost an overflow but where it has one (lib/budget.glsl).
TEST(Shaders, WhoCountsStepsTellsWhenTheyAreSpent) {
  std::multimap<std::string, std::string> includes;
  for (const Include& include : includes_below("shaders")) includes.emplace(include.file, include.target);
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "shaders")) {
    if (entry.path().extension() != ".comp") continue;
    const std::string shader = fs::relative(entry.path(), kRoot).string();
    const std::set<std::string> all = with_includes(shader, includes);
    const auto has = [&](const char* word) {
      return std::any_of(all.begin(), all.end(), [&](const std::string& file) {
        return file != "shaders/lib/budget.glsl" && text_of(kRoot / file).find(word) != std::string::npos;
      });
    };
    if (!has("!spent(")) continue;
    ++count;
    const std::string own = text_of(entry.path());
    EXPECT_TRUE(own.find("tell_spent();") != std::string::npos ||
                own.find("tell_left_undone(") != std::string::npos)
        << shader << " has loops that give up, and tells nobody";
  }
  EXPECT_GE(count, 11u);  // so many there are
}

}  // namespace
