#include "bench/haptic/read_ply.h"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace yardstick {

TriMesh read_ply(const std::string& file) {
  const auto refuse = [&](const std::string& why) { throw std::runtime_error("'" + file + "': " + why); };
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse("can't be read");
  std::size_t vertices = 0, faces = 0;
  std::string line, layout;
  while (std::getline(in, line) && line != "end_header") {
    std::istringstream words(line);
    std::string first, second;
    words >> first >> second;
    if (first == "format" && second != "binary_little_endian") refuse("is not binary and little-endian");
    if (first == "element" && second == "vertex") words >> vertices;
    if (first == "element" && second == "face") words >> faces;
    if (first == "property") layout += line.substr(9) + "; ";
  }
  if (layout != "float x; float y; float z; list uchar int vertex_indices; ")
    refuse("has other properties than x, y, z and triangles: " + layout);
  TriMesh out;
  for (std::size_t i = 0; i < vertices && in; ++i) {
    float place[3];
    in.read(reinterpret_cast<char*>(place), sizeof place);
    out.vertices.emplace_back(place[0], place[1], place[2]);
  }
  for (std::size_t i = 0; i < faces && in; ++i) {
    unsigned char corners = 0;
    std::uint32_t index[3];
    in.read(reinterpret_cast<char*>(&corners), 1);
    if (in && corners != 3) refuse("has a face that is no triangle");
    in.read(reinterpret_cast<char*>(index), sizeof index);
    for (const std::uint32_t v : index)
      if (in && v >= vertices) refuse("has a face with a vertex that there isn't");
    out.triangles.push_back({index[0], index[1], index[2]});
  }
  if (!in || out.triangles.empty()) refuse("ends too early");
  return out;
}

}  // namespace yardstick
