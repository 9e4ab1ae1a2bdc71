// What must hold of any answer, and how answers to two related questions are related. RC_PARAMS="seed=…
// max_success=…" overrides what CMakeLists.txt sets; a failure prints its seed and the smallest question that
// still fails. Why each relation is exact is said at its test.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "tests/properties/questions.h"

namespace palpate::properties {
namespace {

/// At least this share of the questions must make contact, else a property is about nothing (measured: 0.92
/// to 0.98).
constexpr double kLeastContact = 0.8;

/// Runs a property on random questions and counts how many of them touch.
template <class Property>
void check(const char* what, const rc::Gen<Question>& questions, Property property) {
  int asked = 0, touching = 0;
  const bool held = rc::check(what, [&] {
    const Question question = *questions;
    const Answer answer = ask(question);
    ++asked;
    touching += answer.contacts.contact || !answer.pairs.empty() ? 1 : 0;
    property(question, answer);
  });
  EXPECT_TRUE(held) << what;
  EXPECT_GE(touching, kLeastContact * asked) << what << ": too few of " << asked << " questions touch";
  std::printf("%s: %d questions, %d touch\n", what, asked, touching);
}

int random_below(int end) { return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, end)); }

/// A random order: order[new place] = old place.
std::vector<std::uint32_t> any_order(std::size_t count) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(random_below(static_cast<int>(i)))]);
  return order;
}

Body in_order(const Body& body, const std::vector<std::uint32_t>& order) {
  Body out;
  for (const std::uint32_t old : order) out.push_back(body[old]);
  return out;
}

/// Another corner of some triangles comes first; vertices are then numbered otherwise, too.
Body with_other_first_corners(Body body) {
  for (Corners& t : body) std::rotate(t.begin(), t.begin() + random_below(3), t.end());
  return body;
}

std::vector<std::uint32_t> contact_statics(const Answer& answer, const std::vector<std::uint32_t>& map) {
  std::vector<std::uint32_t> all;
  for (const auto* set : {&answer.contacts.cst, &answer.contacts.bst, &answer.contacts.est})
    for (const std::uint32_t id : *set) all.push_back(map.empty() ? id : map[id]);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

bool includes(const std::vector<std::uint32_t>& all, const std::vector<std::uint32_t>& part) {
  return std::includes(all.begin(), all.end(), part.begin(), part.end());
}

bool same_wrench(const Answer& a, const Answer& b) {
  return a.response.wrench.force == b.response.wrench.force &&
         a.response.wrench.torque == b.response.wrench.torque;
}

// Grids of voxels are anchored at lattice 0: a shift by whole voxels takes them to themselves, and everything
// else is made of differences. Sums of points move by their weight. Samples are moved within their cells by
// the cells' own numbers, so in `refined` what hangs on samples is another.
TEST(Moving, BothByWholeVoxelsMovesTheAnswerAlong) {
  check("moving both by whole voxels", solids(false), [](const Question& question, const Answer& answer) {
    Mapping mapping;
    mapping.shift =
        question.voxel * Int3(random_below(41) - 20, random_below(41) - 20, random_below(41) - 20);
    Question other = question;
    other.mockup = mapped(question.mockup, [&](const Int3& p) { return p + mapping.shift; });
    other.pose.translation += mapping.shift;
    const Answer along = ask(other);
    const Extent extent = question.profile == Profile::kPaper ? Extent::kAll : Extent::kVoxels;
    RC_ASSERT(text_of(along, extent) == text_of(answer, extent, mapping));
    if (extent != Extent::kAll) return;
    // Force is made of d and n_c, which are the same. cp is a quotient of rounded sums, off by 3 · 2^-53 of
    // itself, within 1024 steps, in either answer; gc, the tool's lattice origin, is exact. A cross product
    // takes two such products a component.
    RC_ASSERT(along.response.wrench.force == answer.response.wrench.force);
    double force = 0;
    for (const AreaResponse& area : answer.response.areas) force += glm::length(area.force);
    for (int k = 0; k < 3; ++k)
      RC_ASSERT(std::abs(along.response.wrench.torque[k] - answer.response.wrench.torque[k]) <=
                2 * 2 * 4 * 0x1p-53 * 1024 * force);
  });
}

// Whether triangles meet depends on differences alone.
TEST(Moving, BothByAnyStepsKeepsThePairs) {
  check("moving both by any steps", soups(false), [](const Question& question, const Answer& answer) {
    const Int3 shift(random_below(2001) - 1000, random_below(2001) - 1000, random_below(2001) - 1000);
    Question other = question;
    other.mockup = mapped(question.mockup, [&](const Int3& p) { return p + shift; });
    other.pose.translation += shift;
    RC_ASSERT(text_of(ask(other), Extent::kPairs) == text_of(answer, Extent::kPairs));
  });
}

/// Renames axes and turns some round. The tool is moved before, since a rotation's rounding is not the same
/// both ways; then its grid is another, which no set below depends on.
struct AxisMap {
  std::array<int, 3> axis{0, 1, 2};
  Int3 sign{1};
  Int3 operator()(const Int3& p) const {
    return Int3(sign[0] * p[axis[0]], sign[1] * p[axis[1]], sign[2] * p[axis[2]]);
  }
  bool mirrors() const {
    const bool odd = (axis[1] - axis[0] + 3) % 3 == 2;
    return (sign.x * sign.y * sign.z < 0) != odd;
  }
};

AxisMap any_axis_map() {
  AxisMap map;
  const std::vector<std::uint32_t> order = any_order(3);
  for (std::size_t k = 0; k < 3; ++k) {
    map.axis[k] = static_cast<int>(order[k]);
    map.sign[static_cast<int>(k)] = random_below(2) == 0 ? -1 : 1;
  }
  return map;
}

Question seen_through(const Question& question, const AxisMap& map) {
  Question other = question;
  other.mockup = mapped(question.mockup, map, map.mirrors());
  other.tool = mapped(moved(question), map, map.mirrors());
  other.pose = {};
  for (int k = 0; k < 3; ++k) other.pose.rotation_q30[k][k] = 1 << 30;
  return other;
}

Question moved_before(const Question& question) { return seen_through(question, AxisMap{}); }

/// Of the tool's triangles as moved() numbers them.
Mapping without_voids(const Question& question) {
  Mapping mapping;
  std::uint32_t next = 0;
  for (const Corners& t : question.tool) mapping.mobiles.push_back(collapsed(t) ? 0xFFFFFFFFu : next++);
  return mapping;
}

// Closed cubes of whole voxels go to such cubes. Inside is a matter of topology when the mock-up is closed:
// the ray's direction and the perturbed point don't matter. Not the samples: their anchors are open towards
// one side, and their last coordinate is rounded down.
TEST(Axes, RenamingAndMirroringKeepsPairsAndVoxelSets) {
  check("axes of solids", solids(false), [](const Question& question, const Answer& answer) {
    const AxisMap map = any_axis_map();
    const Answer seen = ask(seen_through(question, map));
    RC_ASSERT(text_of(seen, Extent::kVoxels) == text_of(answer, Extent::kVoxels, without_voids(question)));
    for (const VoxelClass c : {VoxelClass::kBoundary, VoxelClass::kInternal})
      RC_ASSERT(voxels_of(seen, c) == voxels_of(answer, c, map));
  });
}

// An open soup's inside is a vote along +x, +y and +z and of the perturbed point: only pairs and V_bnd are
// compared.
TEST(Axes, RenamingAndMirroringASoupKeepsPairsAndBoundary) {
  check("axes of soups", soups(false), [](const Question& question, const Answer& answer) {
    const AxisMap map = any_axis_map();
    const Answer seen = ask(seen_through(question, map));
    RC_ASSERT(text_of(seen, Extent::kPairs) == text_of(answer, Extent::kPairs, without_voids(question)));
    RC_ASSERT(voxels_of(seen, VoxelClass::kBoundary) == voxels_of(answer, VoxelClass::kBoundary, map));
  });
}

// The tool's triangles are never numbered against each other in sets and areas; which corner comes first
// decides nothing for a solid: a triangle that crosses nothing is wholly inside or wholly outside. (The
// field's extra samples stand on the triangle of the smallest id, of several alike.)
TEST(Order, OfToolTrianglesAndOfCornersIsOfNoConsequence) {
  check("order of tool triangles and corners", solids(false),
        [](const Question& question, const Answer& answer) {
          Mapping mapping;
          mapping.mobiles = any_order(question.tool.size());
          Question other = question;
          other.tool = with_other_first_corners(in_order(question.tool, mapping.mobiles));
          other.mockup = with_other_first_corners(question.mockup);
          const Answer reordered = ask(other);
          RC_ASSERT(text_of(reordered, Extent::kAreas, mapping) == text_of(answer, Extent::kAreas));
        });
}

// The smallest id decides ties between areas, so with the mock-up's triangles in another order sets, areas
// and zones are compared.
TEST(Order, OfMockupTrianglesKeepsSetsAndAreas) {
  check("order of mock-up triangles", solids(false), [](const Question& question, const Answer& answer) {
    Mapping mapping;
    mapping.statics = any_order(question.mockup.size());
    Question other = question;
    other.mockup = in_order(question.mockup, mapping.statics);
    RC_ASSERT(text_of(ask(other), Extent::kAreas, mapping) == text_of(answer, Extent::kAreas));
  });
}

TEST(Order, OfASoupKeepsPairs) {
  check("order of a soup", soups(false), [](const Question& question, const Answer& answer) {
    Mapping mapping;
    mapping.statics = any_order(question.mockup.size());
    mapping.mobiles = any_order(question.tool.size());
    Question other = question;
    other.mockup = with_other_first_corners(in_order(question.mockup, mapping.statics));
    other.tool = with_other_first_corners(in_order(question.tool, mapping.mobiles));
    RC_ASSERT(text_of(ask(other), Extent::kPairs, mapping) == text_of(answer, Extent::kPairs));
  });
}

// To intersect is mutual, and a moved triangle is judged as it is after rounding.
TEST(Roles, SwappedGiveTheSamePairs) {
  check("roles swapped", soups(false), [](const Question& question, const Answer&) {
    Question straight = moved_before(question);
    RC_PRE(!std::all_of(straight.tool.begin(), straight.tool.end(), collapsed));
    Question swapped = straight;
    std::swap(swapped.mockup, swapped.tool);
    const Answer a = ask(straight);
    Answer b = ask(swapped);
    for (auto& [s, m] : b.pairs) std::swap(s, m);
    std::swap(b.contacts.cst, b.contacts.cmt);
    RC_ASSERT(text_of(a, Extent::kPairs) == text_of(b, Extent::kPairs));
  });
}

// Twice the lattice, voxels too. Quarter turns, since a rotation rounds on the lattice. Not the samples:
// floor(2x) is not 2 floor(x).
TEST(Doubling, AllCoordinatesKeepsPairsVoxelsAndSets) {
  check("doubling", solids(true), [](const Question& question, const Answer& answer) {
    const auto twice = [](const Int3& p) { return 2 * p; };
    Question other = question;
    other.mockup = mapped(question.mockup, twice);
    other.tool = mapped(question.tool, twice);
    other.pose.translation *= 2;
    other.voxel *= 2;
    other.spacing *= 2;
    const Answer doubled = ask(other);
    RC_ASSERT(text_of(doubled, Extent::kVoxels) == text_of(answer, Extent::kVoxels));
    for (const VoxelClass c : {VoxelClass::kBoundary, VoxelClass::kInternal})
      RC_ASSERT(voxels_of(doubled, c) == voxels_of(answer, c, twice));
  });
}

// The halves cover the triangle, and its samples are theirs: same plane, same axis, same unit normal; the
// perturbed point is in one of them.
TEST(Splitting, AnEdgeOfTheMockupKeepsWhatIsTouched) {
  check("splitting", solids(false), [](const Question& question, const Answer& answer) {
    // Both triangles on an edge that has a lattice point in its middle.
    const auto at = static_cast<std::size_t>(random_below(static_cast<int>(question.mockup.size())));
    const auto k = static_cast<std::size_t>(random_below(3));
    const Int3 u = question.mockup[at][k], v = question.mockup[at][(k + 1) % 3], middle = (u + v) / 2;
    RC_PRE(middle * 2 == u + v);
    Question other = question;
    other.mockup.clear();
    std::vector<std::uint32_t> whole;  // of each triangle of `other`
    for (std::uint32_t t = 0; t < question.mockup.size(); ++t) {
      const Corners& corners = question.mockup[t];
      std::size_t edge = 3;
      for (std::size_t e = 0; e < 3; ++e) {
        const Int3 &p = corners[e], &q = corners[(e + 1) % 3];
        if ((p == u && q == v) || (p == v && q == u)) edge = e;
      }
      if (edge == 3) {
        other.mockup.push_back(corners);
        whole.push_back(t);
        continue;
      }
      const Int3 &p = corners[edge], &q = corners[(edge + 1) % 3], &r = corners[(edge + 2) % 3];
      other.mockup.insert(other.mockup.end(), {Corners{p, middle, r}, Corners{middle, q, r}});
      whole.insert(whole.end(), {t, t});
    }
    const Answer split = ask(other);
    Mapping mapping;
    mapping.statics = whole;
    RC_ASSERT(text_of(split, Extent::kPairs, mapping) == text_of(answer, Extent::kPairs));
    RC_ASSERT(split.contacts.imt == answer.contacts.imt);
    RC_ASSERT(split.contacts.bmt == answer.contacts.bmt);
    RC_ASSERT(split.contacts.contact == answer.contacts.contact);
    RC_ASSERT(contact_statics(split, whole) == contact_statics(answer, {}));
    for (const VoxelClass c : {VoxelClass::kBoundary, VoxelClass::kInternal})
      RC_ASSERT(voxels_of(split, c) == voxels_of(answer, c));
  });
}

// Far away, at the end of the list: the grid grows by whole voxels, the first ids stay.
TEST(FarGeometry, ChangesNothing) {
  check("far geometry", solids(false), [](const Question& question, const Answer& answer) {
    Question other = question;
    const Int3 away((random_below(2) == 0 ? -1 : 1) * (400 + random_below(100)), random_below(201) - 100,
                    random_below(201) - 100);
    for (const Corners& t : mapped(question.tool, [&](const Int3& p) { return p + away; }))
      other.mockup.push_back(t);
    const Answer with = ask(other);
    RC_ASSERT(text_of(with, Extent::kAll) == text_of(answer, Extent::kAll));
    RC_ASSERT(same_wrench(with, answer));
  });
}

// A voxel or a triangle is touched by what was there or by what came.
TEST(AddingATriangle, NeverRemovesABoundaryVoxelOrAContactTriangle) {
  check("adding a triangle", soups(false), [](const Question& question, const Answer& answer) {
    const Corners more = *rc::gen::elementOf(question.tool);
    Question other = question;
    other.mockup.push_back(more);
    const Answer grown = ask(other);
    RC_ASSERT(includes(grown.contacts.cst, answer.contacts.cst));
    RC_ASSERT(includes(grown.contacts.cmt, answer.contacts.cmt));
    const auto before = voxels_of(answer, VoxelClass::kBoundary),
               after = voxels_of(grown, VoxelClass::kBoundary);
    RC_ASSERT(std::includes(after.begin(), after.end(), before.begin(), before.end()));
    other = question;
    other.tool.push_back(question.mockup.front());
    const Answer larger = ask(other);
    RC_ASSERT(includes(larger.contacts.cst, answer.contacts.cst));
    RC_ASSERT(includes(larger.contacts.cmt, answer.contacts.cmt));
  });
}

// A lone query remembers nothing, whatever was asked before.
TEST(AskingAgain, GivesTheSame) {
  check("asking again", soups(false), [](const Question& question, const Answer& answer) {
    LatticePose elsewhere = question.pose;
    elsewhere.translation += Int3(random_below(31) - 15, random_below(31) - 15, random_below(31) - 15);
    const std::vector<Answer> answers = ask(question, {elsewhere, question.pose, elsewhere, question.pose});
    RC_ASSERT(text_of(answers[1], Extent::kAll) == text_of(answer, Extent::kAll));
    RC_ASSERT(text_of(answers[3], Extent::kAll) == text_of(answer, Extent::kAll));
    RC_ASSERT(text_of(answers[2], Extent::kAll) == text_of(answers[0], Extent::kAll));
    RC_ASSERT(same_wrench(answers[3], answer) && same_wrench(answers[2], answers[0]));
  });
}

/// |v|² of v/|v|: three quotients, squares and a sum, each rounded: within 8 units of the last place of 1
/// (2^-53 each).
constexpr double kUnit = 8 * 0x1p-53;

void expect_sound(const Answer& answer) {
  const ContactResponse& response = answer.response;
  RC_ASSERT(answer.contacts.pairs == answer.pairs.size());
  if (!answer.contacts.contact) {
    RC_ASSERT(response.areas.empty());
    RC_ASSERT(response.wrench.force == Vec3(0));
    RC_ASSERT(response.wrench.torque == Vec3(0));
  }
  const bool paper = answer.contacts.carriers.empty();  // in `refined` every area has some
  Vec3 force(0), torque(0);
  for (const AreaResponse& area : response.areas) {
    RC_ASSERT(area.depth >= 0 && std::isfinite(area.depth));
    RC_ASSERT(area.max_depth >= 0 && std::isfinite(area.max_depth));
    const bool directed = area.normal != Vec3(0);
    RC_ASSERT(!directed || std::abs(glm::dot(area.normal, area.normal) - 1) <= kUnit);
    if ((area.flags & kFlagNoDirection) != 0) RC_ASSERT(area.force == Vec3(0));
    if (!directed) RC_ASSERT(area.force == Vec3(0) && area.torque == Vec3(0));
    if (paper)
      RC_ASSERT(area.force ==
                kStiffness * area.depth * area.normal);  // eq. 3, the same products in the same order
    for (int k = 0; k < 3; ++k) RC_ASSERT(std::isfinite(area.point[k]) && std::isfinite(area.torque[k]));
    force += area.force;
    torque += area.torque;
  }
  if (paper && !response.areas.empty()) {
    RC_ASSERT(response.wrench.force == force);
    RC_ASSERT(response.wrench.torque == torque);
  }
  for (int k = 0; k < 3; ++k)
    RC_ASSERT(std::isfinite(response.wrench.force[k]) && std::isfinite(response.wrench.torque[k]));
}

TEST(AnyAnswer, OfSolidsIsSound) {
  check("any answer of solids", solids(false),
        [](const Question&, const Answer& answer) { expect_sound(answer); });
}
TEST(AnyAnswer, OfSoupsIsSound) {
  check("any answer of soups", soups(false),
        [](const Question&, const Answer& answer) { expect_sound(answer); });
}

// Free of contact by a gap of more than a voxel: nothing at all.
TEST(NoContact, IsExactlyNothing) {
  const bool held = rc::check("no contact", [] {
    Question question = *rc::gen::oneOf(soups(false), solids(false));
    question.pose.translation[random_below(3)] = (random_below(2) == 0 ? -1 : 1) * (200 + random_below(1000));
    const Answer answer = ask(question);
    const Contacts& c = answer.contacts;
    RC_ASSERT(!c.contact && answer.pairs.empty() && c.areas.empty());
    RC_ASSERT(c.cst.empty() && c.cmt.empty() && c.imt.empty() && c.bmt.empty() && c.bst.empty() &&
              c.est.empty());
    expect_sound(answer);
  });
  EXPECT_TRUE(held);
}

}  // namespace
}  // namespace palpate::properties
