#include "tests/second_opinion/exported.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace second_opinion {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": the file can't be opened");
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Item>
std::vector<Item> read_items(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  if (bytes.size() % sizeof(Item) != 0)
    throw std::runtime_error(path.string() + ": its length is no multiple of an entry's");
  std::vector<Item> items(bytes.size() / sizeof(Item));
  if (!items.empty()) std::memcpy(static_cast<void*>(items.data()), bytes.data(), bytes.size());
  return items;
}

}  // namespace

std::vector<Triangle> read_triangles(const std::filesystem::path& path) { return read_items<Triangle>(path); }

Pairs read_pairs(const std::filesystem::path& path) {
  Pairs pairs;
  for (const auto& [s, m] : read_items<std::array<std::uint32_t, 2>>(path)) pairs.emplace_back(s, m);
  return pairs;
}

Voxels read_voxels(const std::filesystem::path& directory) {
  const auto json = nlohmann::json::parse(read_file(directory / "voxels.json"));
  Voxels voxels;
  voxels.size = json.at("size");
  voxels.origin = json.at("origin");
  voxels.counts = json.at("counts");
  voxels.classes = read_items<std::uint8_t>(directory / "voxels.u8");
  if (voxels.classes.size() != voxels.counts[0] * voxels.counts[1] * voxels.counts[2])
    throw std::runtime_error((directory / "voxels.u8").string() + ": not one byte a voxel");
  return voxels;
}

}  // namespace second_opinion
