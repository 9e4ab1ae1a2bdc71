#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "model/lattice/voxel_grid.h"

/// Small scenes asked of a back end, and answers as text in which equal means equal in every bit. Lattice
/// steps throughout.
namespace palpate::properties {

using Corners = std::array<Int3, 3>;
using Body = std::vector<Corners>;

inline constexpr double kStiffness = 1000;  ///< K of every answer, N/m; a step is a metre

/// Two bodies where they are judged. The tool's lattice frame has its origin where the generator left it.
struct Question {
  Body mockup, tool;
  LatticePose pose;
  std::int32_t voxel = 8, spacing = 4;
  Profile profile = Profile::kRefined;
};

struct Answer {
  Contacts contacts;
  ContactResponse response;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  VoxelPartition partition;  ///< of the mock-up
};

/// Prepares and asks the reference, or the device when PALPATE_BACKEND is gpu. Throws std::runtime_error when
/// either fails.
Answer ask(const Question& question);
/// The same for several poses in place of the question's, one after the other on one prepared scene.
std::vector<Answer> ask(const Question& question, const std::vector<LatticePose>& poses);

/// What of an answer is written out.
enum class Extent {
  kPairs,   ///< pairs, CST, CMT
  kVoxels,  ///< and IMT, BMT, BST
  kSets,    ///< and EST, contact
  kAreas,   ///< and the areas' and zones' static triangles
  kAll,     ///< and every integer of the field and of the areas, in the order of Contacts::areas
};

/// How one question's triangles are those of another. Ids that are not in the map stand for themselves.
struct Mapping {
  std::vector<std::uint32_t> statics, mobiles;  ///< new id of each; several may get the same
  Int3 shift{0};                                ///< added to every point that the answer sums
};

/// Ids are mapped, sorted, and each is written once.
std::string text_of(const Answer& answer, Extent extent, const Mapping& mapping = {});

/// Lower corners of the voxels of a class, each sent through `place`, sorted.
std::vector<std::array<std::int32_t, 3>> voxels_of(const Answer& answer, VoxelClass wanted,
                                                   const std::function<Int3(const Int3&)>& place = {});

/// Applies f to every corner; `turned` exchanges two corners of every triangle, so that a mirrored body stays
/// the right way out.
Body mapped(const Body& body, const std::function<Int3(const Int3&)>& f, bool turned = false);

/// The tool where it is judged, without the triangles that no pose gives an area.
Body moved(const Question& question);

bool collapsed(const Corners& triangle);

}  // namespace palpate::properties
