#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "model/mesh/mesh_import.h"

namespace palpate {

/// A file in a folder of its own, gone at the end of the test.
class MeshImport : public testing::Test {
 protected:
  MeshImport()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("palpate_import_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~MeshImport() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }

  Mesh read(const std::string& path, double scale = 1) {
    auto mesh = import_mesh(path, scale, report_);
    EXPECT_TRUE(mesh) << mesh.error().sentence;
    return mesh ? std::move(*mesh) : Mesh{};
  }

  /// The sentence with which a file is refused.
  std::string refused(const std::string& path, double scale = 1) {
    const auto mesh = import_mesh(path, scale, report_);
    EXPECT_FALSE(mesh);
    if (mesh) return {};
    EXPECT_EQ(mesh.error().code, ErrorCode::kBadValue);
    EXPECT_THAT(mesh.error().sentence, testing::HasSubstr(path));
    EXPECT_EQ(mesh.error().sentence.find('\n'), std::string::npos);
    return mesh.error().sentence;
  }

  std::filesystem::path folder_;
  ImportReport report_;
};

/// The bytes of `value`, appended.
template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The corners of triangle t.
inline std::vector<Vec3> corners(const Mesh& mesh, std::size_t t) {
  return {mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
          mesh.vertices[mesh.triangles[t][2]]};
}

}  // namespace palpate
