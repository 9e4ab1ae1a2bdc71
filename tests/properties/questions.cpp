#include "tests/properties/questions.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "model/lattice/pose.h"

namespace palpate::properties {
namespace {

constexpr std::int32_t kReach = 24;  // of a soup's corners, steps: three voxels

/// From first to last, all of them at any size: the library would begin with questions too small to touch.
rc::Gen<std::int32_t> between(std::int32_t first, std::int32_t last) {
  return rc::gen::resize(rc::kNominalSize, rc::gen::inRange(first, last + 1));
}

/// Multiples of 4, half a voxel, most of the time: so that things coincide.
rc::Gen<std::int32_t> coordinate() {
  return rc::gen::weightedOneOf<std::int32_t>(
      {{3, rc::gen::map(between(-kReach / 4, kReach / 4), [](std::int32_t i) { return 4 * i; })},
       {1, between(-kReach, kReach)}});
}

rc::Gen<Int3> point() {
  return rc::gen::apply([](std::int32_t x, std::int32_t y, std::int32_t z) { return Int3(x, y, z); },
                        coordinate(), coordinate(), coordinate());
}

rc::Gen<Corners> triangle() {
  return rc::gen::apply(
      [](const Int3& a, const Int3& b, const Int3& c) {
        return Corners{a, b, c};
      },
      point(), point(), point());
}

bool has_area(const Body& body) {
  return std::any_of(body.begin(), body.end(), [](const Corners& t) { return !collapsed(t); });
}

rc::Gen<Body> soup() {
  return rc::gen::suchThat(rc::gen::resize(24, rc::gen::container<Body>(triangle())), has_area);
}

Body box(const Int3& low, const Int3& high) {
  Body out;
  for (int k = 0; k < 3; ++k)
    for (const bool upper : {false, true}) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      const auto corner = [&](bool far_u, bool far_v) {
        Int3 p;
        p[k] = upper ? high[k] : low[k];
        p[u] = far_u ? high[u] : low[u];
        p[v] = far_v ? high[v] : low[v];
        return p;
      };
      const Int3 a = corner(false, false), b = corner(true, false), c = corner(true, true),
                 d = corner(false, true);
      out.push_back(upper ? Corners{a, b, c} : Corners{a, c, b});
      out.push_back(upper ? Corners{a, c, d} : Corners{a, d, c});
    }
  return out;
}

Body octahedron(const Int3& centre, std::int32_t radius) {
  Body out;
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1}) {
        const Int3 a = centre + Int3(x * radius, 0, 0), b = centre + Int3(0, y * radius, 0),
                   c = centre + Int3(0, 0, z * radius);
        out.push_back(x * y * z > 0 ? Corners{a, b, c} : Corners{a, c, b});
      }
  return out;
}

rc::Gen<Body> solid() {
  return rc::gen::apply(
      [](bool round, const Int3& anywhere, std::int32_t size, const Int3& longer) {
        const Int3 centre = anywhere / 2;  // nearer than a soup's corners: solids touch less
        if (round) return octahedron(centre, 2 * size);
        return box(centre - size, centre + size + glm::abs(longer) / 2);
      },
      rc::gen::weightedElement<bool>({{2, false}, {1, true}}), point(), between(2, 12), point());
}

rc::Gen<Body> some_solids() {
  return rc::gen::map(rc::gen::suchThat(rc::gen::resize(4, rc::gen::container<std::vector<Body>>(solid())),
                                        [](const auto& all) { return !all.empty(); }),
                      [](const std::vector<Body>& all) {
                        Body out;
                        for (const Body& body : all) out.insert(out.end(), body.begin(), body.end());
                        return out;
                      });
}

/// The 24 rotations that take axes to axes, the identity first.
LatticePose quarter_turn(int number) {
  LatticePose pose;
  const std::int32_t one = 1 << 30;
  const int first = number % 3;
  const bool swap = number / 3 % 2 != 0;
  const int second = (first + (swap ? 2 : 1)) % 3, third = 3 - first - second;
  const bool negative0 = number / 6 % 2 != 0, negative1 = number / 12 % 2 != 0;
  pose.rotation_q30[0][first] = negative0 ? -one : one;
  pose.rotation_q30[1][second] = negative1 ? -one : one;
  pose.rotation_q30[2][third] = (negative0 != negative1) != swap ? -one : one;
  return pose;
}

LatticePose any_turn(double w, double x, double y, double z) {
  SceneGeometry metre_steps;
  metre_steps.lattice.step_m = 1;
  const Quat q(w, x, y, z);
  LatticePose pose = to_lattice({Vec3(0), q * (1 / std::sqrt(glm::dot(q, q)))}, metre_steps).value();
  pose.translation = Int3(0);
  pose.beyond_lattice = false;
  return pose;
}

rc::Gen<LatticePose> turn(bool quarter_turns) {
  const auto quarter = rc::gen::map(between(0, 23), quarter_turn);
  if (quarter_turns) return quarter;
  const auto part = between(-1000, 1000);
  const auto any = rc::gen::apply([](int w, int x, int y, int z) { return any_turn(w * w + 1, x, y, z); },
                                  between(0, 31), part, part, part);
  return rc::gen::weightedOneOf<LatticePose>({{1, quarter}, {2, any}});
}

rc::Gen<Question> questions(const rc::Gen<Body>& body, bool quarter_turns) {
  return rc::gen::apply(
      [](Body mockup, Body tool, LatticePose pose, const Int3& shift, Profile profile) {
        pose.translation = shift / 2;
        return Question{std::move(mockup), std::move(tool), pose, 8, 4, profile};
      },
      body, body, turn(quarter_turns), point(),
      rc::gen::weightedElement<Profile>({{3, Profile::kRefined}, {1, Profile::kPaper}}));
}

void show(const char* what, const Body& body, std::ostream& out) {
  out << what << ":\n";
  for (const Corners& t : body) {
    for (const Int3& c : t) out << " (" << c.x << ", " << c.y << ", " << c.z << ")";
    out << '\n';
  }
}

}  // namespace

rc::Gen<Question> soups(bool quarter_turns) { return questions(soup(), quarter_turns); }
rc::Gen<Question> solids(bool quarter_turns) { return questions(some_solids(), quarter_turns); }

void showValue(const Question& question, std::ostream& out) {
  show("mock-up", question.mockup, out);
  show("tool", question.tool, out);
  out << "rotation_q30:";
  for (const auto& row : question.pose.rotation_q30)
    for (const std::int32_t entry : row) out << ' ' << entry;
  const Int3& t = question.pose.translation;
  out << "\ntranslation: " << t.x << ' ' << t.y << ' ' << t.z
      << (question.profile == Profile::kPaper ? "\nprofile: paper\n" : "\nprofile: refined\n");
}

}  // namespace palpate::properties
