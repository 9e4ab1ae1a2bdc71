#include "model/generate.h"

#include <array>
#include <iterator>

#include "model/generate/chapter_scenes.h"

namespace palpate {
namespace {

struct Generator {
  const char* name;
  std::uint64_t triangles, tool_triangles;  ///< the chapter's
  GeneratedScene (*make)(std::uint64_t triangles, std::uint64_t tool_triangles);
};

constexpr std::array<Generator, 2> kGenerators{
    {{"contacts", 25'000, 1'500, generate_contacts}, {"disassembly", 100'000, 2'000, generate_disassembly}}};
constexpr std::uint64_t kLeast = 1'000, kMost = 10'000'000;

Result<void> check_count(const char* what, std::uint64_t count) {
  if (count != 0 && (count < kLeast || count > kMost))
    return bad_value(std::string(what) + " is " + std::to_string(count) +
                     "; a generated body has 1000 to 10000000");
  return {};
}

}  // namespace

Result<GeneratedScene> generate_scene(const std::string& name, std::uint64_t triangles,
                                      std::uint64_t tool_triangles) {
  if (auto checked = check_count("number of triangles", triangles); !checked) return checked.error();
  if (auto checked = check_count("number of tool triangles", tool_triangles); !checked)
    return checked.error();
  for (const Generator& generator : kGenerators)
    if (name == generator.name)
      return generator.make(triangles ? triangles : generator.triangles,
                            tool_triangles ? tool_triangles : generator.tool_triangles);
  std::string known;
  for (const std::string& each : generator_names()) known += (known.empty() ? "" : ", ") + each;
  return bad_value("there is no generator \"" + name + "\"; there are: " + known);
}

std::vector<std::string> generator_names() {
  std::vector<std::string> names;
  names.reserve(std::size(kGenerators));
  for (const Generator& generator : kGenerators) names.emplace_back(generator.name);
  return names;
}

}  // namespace palpate
