#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "shaders/shared/frame.h"
#include "shaders/shared/frame_field.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// How finely a frame's work is cut: constants of shaders/frame/broad_phase.comp and shaders/lib/frame.glsl.
struct WorkCut {
  std::uint32_t clusters;        ///< of the tool, a workgroup of the search
  std::uint32_t brick_groups;    ///< workgroups that look for bricks of the mock-up
  std::uint32_t bricks_at_once;  ///< by one of them
  std::uint32_t lanes;           ///< invocations a sample; 1, or a multiple of 8 that divides 64
  std::uint32_t runs_a_group;    ///< of tool triangles, a workgroup
  std::uint32_t pair_chunk;      ///< entries of a voxel's list
  std::uint32_t listed_chunk;    ///< samples of a voxel
  std::uint32_t field_tile;      ///< cells of a tool triangle's sample grid
};

/// What a frame of a scene can ask for.
struct FrameDemand {
  const gpu::SceneConstants& scene;
  const WorkCut& cut;
  std::optional<std::uint64_t>
      samples;  ///< of the mock-up, where preparation has listed them and the host searches among them
};

/// How many items each list of a frame holds. Chosen so that usual contacts fit, and no more than the scene
/// can ask for; what has overflowed grows when asked.
struct FrameCapacity {
  std::array<std::uint32_t, gpu::kListCount>
      lists{};              ///< by kList…; at least 1 for each list that the profile has
  std::uint32_t poses = 0;  ///< of a batch, which has lists for all of them together; 0: a lone frame

  /// What a frame begins with. `wanted` overrides lists by their names (overflow_name), for tests.
  static FrameCapacity first(const FrameDemand& demand, const std::map<std::string, std::uint32_t>& wanted);

  /// What a batch of `poses` begins with; `wanted` likewise.
  static FrameCapacity first_of_batch(std::uint32_t poses,
                                      const std::map<std::string, std::uint32_t>& wanted);

  /// Makes room for what a frame ran out of: at least double, and all that was `asked` for. False: what it
  /// ran out of is no matter of memory (areas, steps of one invocation).
  bool grow(const gpu::FrameState& state, const std::array<std::uint32_t, gpu::kListCount>& asked);
};

/// What a frame ran out of, for Contacts::truncated_capacity; "" for nothing.
const char* overflow_name(const gpu::FrameState& state);

/// One sentence on a limit that no memory moves, for a frame that grow() can't help.
std::string fixed_limit(const gpu::FrameState& state);

/// The name of a list ("pairs"), or null for a number that is none.
const char* list_name(std::uint32_t list);

}  // namespace palpate
