#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "model/files/one_line.h"
#include "model/import/import_checks.h"

namespace palpate {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestJson = 256;                ///< the importer's own JSON reader recurses (chosen)
constexpr std::uint64_t kDeepestNode = 512;      ///< and so does its walk of the nodes (chosen)
constexpr std::uint64_t kMostNodes = 1'000'000;  ///< instances counted (chosen)
constexpr std::uint64_t kMostEntries =
    1ull << 30;  ///< of an accessor without a buffer, which costs no bytes in the file

std::uint64_t number(const Json& object, const char* key, std::uint64_t otherwise) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : otherwise;
}

/// Of an object; of anything else an empty one.
const Json& list(const Json& object, const char* key) {
  static const Json empty = Json::array();
  if (!object.is_object()) return empty;
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : empty;
}

/// Nodes below each node, instances counted, and cycles.
std::string distrust_nodes(const Json& nodes) {
  enum State : std::uint8_t { kNew, kOpen, kDone };
  struct Node {
    State state = kNew;
    std::uint64_t size = 1, depth = 1;
  };
  std::vector<Node> seen(nodes.size());
  for (std::size_t root = 0; root < nodes.size(); ++root) {
    if (seen[root].state != kNew) continue;
    std::vector<std::pair<std::size_t, std::size_t>> stack{{root, 0}};  // node, next child
    seen[root].state = kOpen;
    while (!stack.empty()) {
      const auto [node, next] = stack.back();
      const Json& children = list(nodes[node], "children");
      if (next == children.size()) {
        for (const Json& child : children) {
          const Node& below = seen[child.get<std::size_t>()];
          seen[node].size = std::min(kMostNodes + 1, seen[node].size + below.size);
          seen[node].depth = std::max(seen[node].depth, below.depth + 1);
        }
        if (seen[node].size > kMostNodes)
          return fmt::format("has more than {} nodes, instances counted", kMostNodes);
        if (seen[node].depth > kDeepestNode)
          return fmt::format("nests nodes more than {} deep", kDeepestNode);
        seen[node].state = kDone;
        stack.pop_back();
        continue;
      }
      ++stack.back().second;
      if (!children[next].is_number_unsigned() || children[next].get<std::uint64_t>() >= nodes.size())
        return fmt::format("has a child of node {} that is not one of its {} nodes", node, nodes.size());
      const auto child = children[next].get<std::size_t>();
      if (seen[child].state == kOpen) return fmt::format("has a node that contains itself (node {})", child);
      if (seen[child].state == kNew) {
        seen[child].state = kOpen;
        stack.emplace_back(child, 0);
      }
    }
  }
  return {};
}

std::uint64_t component_size(std::uint64_t type) {
  return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
}

std::uint64_t components(const Json& accessor) {
  const auto type = accessor.find("type");
  if (type == accessor.end() || !type->is_string()) return 1;
  const std::string name = *type;
  return name == "VEC2"                     ? 2
         : name == "VEC3"                   ? 3
         : name == "VEC4" || name == "MAT2" ? 4
         : name == "MAT3"                   ? 9
         : name == "MAT4"                   ? 16
                                            : 1;
}

/// Bytes that a buffer can really have; what can't be told is left to the importer.
std::uint64_t bytes_of_buffer(const Json& buffer, std::uint64_t file_size, const std::string& path) {
  const auto uri = buffer.find("uri");
  if (uri == buffer.end() || !uri->is_string()) return file_size;
  const std::string name = *uri;
  if (name.rfind("data:", 0) == 0) return name.size();
  std::error_code error;
  const std::uintmax_t size =
      std::filesystem::file_size(std::filesystem::path(path).parent_path() / name, error);
  return error ? UINT64_MAX : size;
}

/// A sparse accessor's two lists, which the importer takes for granted.
std::string distrust_sparse(const Json& accessor, std::size_t a, std::uint64_t entry, const Json& views) {
  const auto sparse = accessor.find("sparse");
  if (sparse == accessor.end()) return {};
  const std::uint64_t count = sparse->is_object() ? number(*sparse, "count", UINT64_MAX) : UINT64_MAX;
  if (count > number(accessor, "count", 0))
    return fmt::format("has a sparse accessor {} without a count within its own", a);
  for (const char* key : {"indices", "values"}) {
    const auto list = sparse->find(key);
    const std::uint64_t view =
        list != sparse->end() && list->is_object() ? number(*list, "bufferView", UINT64_MAX) : UINT64_MAX;
    if (view >= views.size()) return fmt::format("has a sparse accessor {} without {}", a, key);
    const std::uint64_t size = key[0] == 'i' ? component_size(number(*list, "componentType", 0)) : entry,
                        length = number(views[view], "byteLength", 0),
                        offset = number(*list, "byteOffset", 0);
    if (offset > length || count > (length - offset) / size)
      return fmt::format("has a sparse accessor {} whose {} are beyond their buffer view", a, key);
  }
  return {};
}

/// Buffers within their files, views within buffers, accessors within views.
std::string distrust_buffers(const Json& root, std::uint64_t file_size, const std::string& path) {
  const Json &buffers = list(root, "buffers"), &views = list(root, "bufferViews"),
             &accessors = list(root, "accessors");
  for (std::size_t b = 0; b < buffers.size(); ++b) {
    const std::uint64_t promised = number(buffers[b], "byteLength", 0),
                        have = bytes_of_buffer(buffers[b], file_size, path);
    if (promised > have)
      return fmt::format("is cut short: buffer {} promises {} bytes, there are {}", b, promised, have);
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    const std::uint64_t buffer = number(views[v], "buffer", UINT64_MAX),
                        offset = number(views[v], "byteOffset", 0),
                        length = number(views[v], "byteLength", 0);
    if (buffer >= buffers.size())
      return fmt::format("has a buffer view {} of a buffer that does not exist", v);
    const std::uint64_t size = number(buffers[buffer], "byteLength", 0);
    if (offset > size || length > size - offset)
      return fmt::format("has a buffer view {} of {} bytes from byte {}, beyond its buffer of {} bytes", v,
                         length, offset, size);
  }
  for (std::size_t a = 0; a < accessors.size(); ++a) {
    const std::uint64_t count = number(accessors[a], "count", 0),
                        entry = component_size(number(accessors[a], "componentType", 5126)) *
                                components(accessors[a]);
    if (count > kMostEntries)
      return fmt::format("has an accessor {} of {} entries, the limit is {}", a, count, kMostEntries);
    if (std::string wrong = distrust_sparse(accessors[a], a, entry, views); !wrong.empty()) return wrong;
    const std::uint64_t view = number(accessors[a], "bufferView", UINT64_MAX);
    if (view == UINT64_MAX) {
      // Without a view all entries are 0; only a sparse one may say so, and never with more entries than the
      // file has bytes.
      if (count > file_size) return fmt::format("has an accessor {} of {} entries without data", a, count);
      continue;
    }
    if (view >= views.size())
      return fmt::format("has an accessor {} of a buffer view that does not exist", a);
    const std::uint64_t length = number(views[view], "byteLength", 0),
                        offset = number(accessors[a], "byteOffset", 0),
                        stride = std::max(entry, number(views[view], "byteStride", entry));
    if (count > 0 &&
        (offset > length || entry > length - offset || (count - 1) > (length - offset - entry) / stride))
      return fmt::format("has an accessor {} of {} entries, beyond its buffer view of {} bytes", a, count,
                         length);
  }
  return {};
}

std::string distrust_meshes(const Json& root) {
  const Json &accessors = list(root, "accessors"), &meshes = list(root, "meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (const Json& primitive : list(meshes[m], "primitives")) {
      if (!primitive.is_object() || !primitive.contains("attributes") || !primitive["attributes"].is_object())
        continue;
      for (const auto& [name, accessor] : primitive["attributes"].items()) {
        if (!accessor.is_number_unsigned() || accessor.get<std::uint64_t>() >= accessors.size())
          return fmt::format("has an attribute {} in mesh {} whose accessor does not exist", name, m);
        const Json& data = accessors[accessor.get<std::size_t>()];
        if (name == "POSITION" && (components(data) != 3 || number(data, "componentType", 0) != 5126))
          return fmt::format("has positions in mesh {} that are not three floats", m);
      }
      if (primitive.contains("indices") && number(primitive, "indices", UINT64_MAX) >= accessors.size())
        return fmt::format("has indices in mesh {} whose accessor does not exist", m);
    }
  return {};
}

/// Weights of morph targets where the file stands still: the library leaves them out.
std::string distrust_weights(const Json& root) {
  for (const char* key : {"meshes", "nodes"}) {
    const Json& entries = list(root, key);
    for (std::size_t i = 0; i < entries.size(); ++i)
      for (const Json& weight : list(entries[i], "weights"))
        if (!weight.is_number() || weight.get<double>() != 0)
          return fmt::format(
              "has weights of morph targets in entry {} of '{}', which can't be applied; save it "
              "in the shape that it has with them",
              i, key);
  }
  return {};
}

/// The JSON of a .gltf, or of a .glb's first chunk.
std::string find_json(std::string_view bytes, std::string_view& json) {
  json = bytes;
  if (bytes.substr(0, 4) != "glTF") return {};
  if (bytes.size() < 20) return "is cut short: a GLB header has 20 bytes";
  std::uint32_t header[5];  // magic, version, length, length of the first chunk, its type
  std::memcpy(header, bytes.data(), sizeof header);
  if (header[1] != 2) return fmt::format("has GLB version {}, only 2 can be read", header[1]);
  if (header[2] > bytes.size())
    return fmt::format("is cut short: it promises {} bytes and has {}", header[2], bytes.size());
  if (header[3] > bytes.size() - 20)
    return fmt::format("is cut short: its JSON promises {} bytes", header[3]);
  json = bytes.substr(20, header[3]);
  return {};
}

/// The meshes that nodes of the scene name, each once.
std::set<std::uint64_t> meshes_of_scene(const Json& root) {
  std::set<std::uint64_t> meshes, seen;
  const Json &scenes = list(root, "scenes"), &nodes = list(root, "nodes");
  const std::uint64_t scene = number(root, "scene", 0);
  if (scene >= scenes.size()) return meshes;
  std::vector<const Json*> open{&list(scenes[scene], "nodes")};
  while (!open.empty()) {
    const Json& some = *open.back();
    open.pop_back();
    for (const Json& entry : some) {
      const std::uint64_t node = entry.is_number_unsigned() ? entry.get<std::uint64_t>() : UINT64_MAX;
      if (node >= nodes.size() || !seen.insert(node).second) continue;
      if (const std::uint64_t mesh = number(nodes[node], "mesh", UINT64_MAX); mesh != UINT64_MAX)
        meshes.insert(mesh);
      open.push_back(&list(nodes[node], "children"));
    }
  }
  return meshes;
}

}  // namespace

std::map<std::string, std::uint64_t> faces_of_gltf(std::string_view bytes) {
  std::map<std::string, std::uint64_t> out;
  std::string_view text;
  if (!find_json(bytes, text).empty()) return out;
  const Json root = Json::parse(text, nullptr, false);
  if (!root.is_object()) return out;
  std::set<std::string> unknown;
  const Json &accessors = list(root, "accessors"), &meshes = list(root, "meshes");
  for (const std::uint64_t m : meshes_of_scene(root)) {
    if (m >= meshes.size() || !meshes[m].is_object()) continue;
    const auto given = meshes[m].find("name");
    const std::string name =
        given != meshes[m].end() && given->is_string() && !given->get_ref<const std::string&>().empty()
            ? given->get<std::string>()
            : fmt::format("meshes[{}]", m);
    const Json& primitives = list(meshes[m], "primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const Json& primitive = primitives[p];
      const std::string made = primitives.size() > 1 ? fmt::format("{}-{}", name, p) : name;
      constexpr std::uint64_t kTriangles = 4;
      if (!primitive.is_object() || number(primitive, "mode", kTriangles) != kTriangles ||
          primitive.contains("extensions")) {
        unknown.insert(made);
        continue;
      }
      const Json& attributes = primitive.contains("attributes") ? primitive["attributes"] : primitive;
      const std::uint64_t corners =
          number(primitive, "indices",
                 attributes.is_object() ? number(attributes, "POSITION", UINT64_MAX) : UINT64_MAX);
      if (corners < accessors.size()) out[made] += number(accessors[corners], "count", 0) / 3;
    }
  }
  for (const std::string& name : unknown) out.erase(name);
  return out;
}

namespace {

/// A file may not be read without what it requires, but for what says nothing of shapes.
std::string distrust_extensions(const Json& required) {
  for (const Json& entry : required) {
    if (!entry.is_string()) return "has an entry in 'extensionsRequired' that is not a string";
    const std::string& name = entry.get_ref<const std::string&>();
    constexpr std::array<std::string_view, 6> kOfLooks = {
        "KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "MSFT_texture_", "KHR_animation_"};
    if (std::none_of(kOfLooks.begin(), kOfLooks.end(),
                     [&](std::string_view begin) { return name.starts_with(begin); }))
      return fmt::format("requires the extension '{}', which can't be read", one_line(name.substr(0, 60)));
  }
  return {};
}

}  // namespace

std::string distrust_gltf(std::string_view bytes, const std::string& path) {
  std::string_view text;
  if (std::string wrong = find_json(bytes, text); !wrong.empty()) return wrong;
  bool too_deep = false;
  const auto watch = [&](int depth, Json::parse_event_t, Json&) {
    return !(too_deep |= depth > kDeepestJson);
  };
  const Json root = Json::parse(text, watch, false);
  if (too_deep) return fmt::format("nests its JSON more than {} deep", kDeepestJson);
  if (root.is_discarded() || !root.is_object()) return "holds no valid JSON";
  if (const auto nodes = root.find("nodes"); nodes != root.end() && !nodes->is_array())
    return "is not glTF 2.0";
  for (const char* key : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes"})
    for (const Json& entry : list(root, key))
      if (!entry.is_object()) return fmt::format("has an entry in '{}' that is not an object", key);
  std::string wrong = distrust_nodes(list(root, "nodes"));
  if (wrong.empty()) wrong = distrust_buffers(root, bytes.size(), path);
  if (wrong.empty()) wrong = distrust_meshes(root);
  if (wrong.empty()) wrong = distrust_weights(root);
  if (wrong.empty()) wrong = distrust_extensions(list(root, "extensionsRequired"));
  return wrong;
}

}  // namespace palpate
