#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "service/library/palpate.h"

namespace palpate {

/// Corners and faces of a box about a point, m.
struct BoxMesh {
  std::vector<double> vertices;
  std::vector<std::uint32_t> faces{0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                   1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

  explicit BoxMesh(double half_x, double half_y, double half_z, double z = 0) {
    for (const double k : {-1.0, 1.0})
      for (const auto& [i, j] :
           {std::array{-1.0, -1.0}, std::array{1.0, -1.0}, std::array{1.0, 1.0}, std::array{-1.0, 1.0}})
        for (const double c : {i * half_x, j * half_y, z + k * half_z}) vertices.push_back(c);
  }
};

/// Expects a call to have come to a code; gives the sentence and frees the error. By reference, for the call
/// is among the arguments.
inline std::string sentence_of(std::int32_t code, std::int32_t wanted, palpate_error* const& error) {
  const std::string sentence = palpate_error_sentence(error);
  EXPECT_EQ(code, wanted) << sentence;
  EXPECT_EQ(palpate_error_code(error), wanted);
  palpate_error_free(error);
  return sentence;
}

inline void must(std::int32_t code, palpate_error* const& error) {
  (void)sentence_of(code, PALPATE_OK, error);
}

/// A cube of 20 mm over a plate of 200 × 200 × 20 mm whose top is at z = 0: at height z of its middle it is
/// z − 10 mm off.
class BoxScene {
 public:
  explicit BoxScene(const char* engine = "cpu", bool all_samples = false, const char* profile = "refined") {
    const BoxMesh tool(0.01, 0.01, 0.01), plate(0.1, 0.1, 0.01, -0.01);
    palpate_source* source = palpate_source_new();
    palpate_error* error = nullptr;
    // Coarse, so that it is ready in milliseconds, under sanitizers, too.
    const char* text = R"({"tool": {"mesh": "cube"}, "static": [{"mesh": "plate"}],
                           "response": {"voxel_size": 0.02, "sample_spacing": 0.005}})";
    must(palpate_source_text(source, text, nullptr, &error), error);
    must(palpate_source_mesh(source, "cube", tool.vertices.data(), 8, tool.faces.data(), 12, &error), error);
    must(palpate_source_mesh(source, "plate", plate.vertices.data(), 8, plate.faces.data(), 12, &error),
         error);
    must(palpate_source_engine(source, engine, &error), error);
    must(palpate_source_profile(source, profile, &error), error);
    must(palpate_source_all_samples(source, all_samples, &error), error);
    must(palpate_source_cache(source, 0, &error), error);
    must(palpate_scene_open(source, nullptr, &scene_, &error), error);
    palpate_source_free(source);
  }
  ~BoxScene() { palpate_scene_close(scene_); }
  BoxScene(const BoxScene&) = delete;
  BoxScene& operator=(const BoxScene&) = delete;
  operator palpate_scene*() const { return scene_; }  // NOLINT(google-explicit-constructor)

 private:
  palpate_scene* scene_ = nullptr;
};

/// The cube at a height, upright, a row a height.
inline std::vector<double> at_heights(const std::vector<double>& heights) {
  std::vector<double> poses;
  for (const double z : heights)
    for (const double value : {0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0}) poses.push_back(value);
  return poses;
}

}  // namespace palpate
