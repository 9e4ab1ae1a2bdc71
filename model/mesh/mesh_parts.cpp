#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>

#include "model/mesh/mesh_import.h"
#include "model/scene/similar_names.h"

namespace palpate {
namespace {

// Npos + 1 is 0.
std::string last_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

/// A part by its number, "#3"; null: none.
const MeshPart* numbered(const std::vector<MeshPart>& parts, const std::string& name) {
  std::size_t number = 0;
  if (name.size() < 2 || name[0] != '#') return nullptr;
  const auto [end, wrong] = std::from_chars(name.data() + 1, name.data() + name.size(), number);
  return wrong == std::errc() && end == name.data() + name.size() && number >= 1 && number <= parts.size()
             ? &parts[number - 1]
             : nullptr;
}

/// The parts that `keep` holds, with only the vertices they use.
template <class Keep>
Mesh subset(const Mesh& mesh, Keep keep) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.vertices.size(), kUnused);
  Mesh out;
  for (const MeshPart& part : mesh.parts) {
    if (!keep(part)) continue;
    out.parts.push_back({part.path, static_cast<std::uint32_t>(out.triangles.size()), part.triangle_count,
                         part.also, part.colour});
    for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
      std::array<std::uint32_t, 3> triangle = mesh.triangles[t];
      for (std::uint32_t& v : triangle) {
        if (number[v] == kUnused) {
          number[v] = static_cast<std::uint32_t>(out.vertices.size());
          out.vertices.push_back(mesh.vertices[v]);
        }
        v = number[v];
      }
      out.triangles.push_back(triangle);
    }
  }
  return out;
}

}  // namespace

bool is_below(const std::string& path, const std::string& node) {
  return path == node ||
         (path.size() > node.size() && path.compare(0, node.size(), node) == 0 && path[node.size()] == '/');
}

Result<std::string> find_node(const std::vector<MeshPart>& parts, const std::string& name,
                              const std::string& file) {
  std::set<std::string> nodes;  // every node that holds triangles, itself or below
  for (const MeshPart& part : parts)
    for (std::size_t end = part.path.find('/');; end = part.path.find('/', end + 1)) {
      nodes.insert(part.path.substr(0, end));
      if (end == std::string::npos) break;
    }
  // "#3" is a number, but somebody may have named a part so.
  const auto named = [&](const std::string& node) -> Result<std::string> {
    const MeshPart* const part = numbered(parts, name);
    if (part == nullptr || part->path == node) return node;
    return bad_value(
        fmt::format("'{}' has a node named '{}' beside its part of that number, '{}': say this by "
                    "its name, that by its number",
                    file, name, part->path));
  };
  if (nodes.count(name) != 0) return named(name);
  std::vector<std::string> matches, names;
  for (const std::string& node : nodes) {
    names.push_back(last_name(node));
    if (names.back() == name) matches.push_back(node);
  }
  if (matches.empty())  // names of nodes come first
    for (const MeshPart& part : parts) {
      if (part.also.empty()) continue;
      names.push_back(part.also);
      if (part.also == name) matches.push_back(part.path);
    }
  if (matches.size() == 1) return named(matches.front());
  if (matches.size() > 1)
    return bad_value(fmt::format("'{}' has {} nodes named '{}': say which by its path, such as '{}' or '{}'",
                                 file, matches.size(), name, matches[0], matches[1]));
  if (const MeshPart* part = numbered(parts, name)) return part->path;
  names.insert(names.end(), nodes.begin(), nodes.end());
  const std::string near = similar_names(name, names);
  return bad_value(fmt::format("'{}' has no node named '{}'{} `palpate info --tree '{}'` lists them", file,
                               name, near.empty() ? ";" : near, file));
}

Result<Mesh> take_part(const Mesh& mesh, const std::string& part, const std::string& file) {
  const Result<std::string> node = find_node(mesh.parts, part, file);
  if (!node) return node.error();
  return subset(mesh, [&](const MeshPart& p) { return is_below(p.path, *node); });
}

Result<Mesh> without_parts(const Mesh& mesh, const std::vector<std::string>& parts, const std::string& file) {
  std::vector<std::string> nodes;
  for (const std::string& part : parts) {
    Result<std::string> node = find_node(mesh.parts, part, file);
    if (!node) return node.error();
    nodes.push_back(std::move(*node));
  }
  Mesh out = subset(mesh, [&](const MeshPart& p) {
    return std::none_of(nodes.begin(), nodes.end(),
                        [&](const std::string& node) { return is_below(p.path, node); });
  });
  if (out.triangles.empty())
    return bad_value(fmt::format("nothing is left of '{}' without the parts named", file));
  return out;
}

}  // namespace palpate
