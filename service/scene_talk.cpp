#include "service/scene_talk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "model/contact/response.h"
#include "model/mesh/winding_number.h"
#include "service/cli/numbers.h"

namespace palpate {
namespace {

/// The part that a triangle is of: parts follow each other in the order of triangles.
std::string part_of(const MeshReport& report, std::uint32_t triangle, const char* body) {
  std::uint64_t end = 0;
  for (const MeshReport::Part& part : report.parts) {
    end += part.triangles;
    if (triangle < end) return part.path.empty() ? std::string(body) : "'" + part.path + "'";
  }
  return body;
}

std::string place(const Vec3& p) { return fmt::format("{:.6g} {:.6g} {:.6g} m", p.x, p.y, p.z); }

constexpr std::size_t kToldAreas = 3;  // chosen

std::string in_touch(const SceneGeometry& geometry, const Contacts& contacts, Profile profile) {
  const auto of = [](const MeshReport& report, const std::vector<std::uint32_t>& cut, const char* body) {
    return cut.empty() ? std::string(body) : part_of(report, cut.front(), body);
  };
  const std::string sentence =
      fmt::format("the tool starts in touch with {}, its part {} ({} {} of triangles)",
                  of(geometry.mockup_report, contacts.cst, "the mock-up"),
                  of(geometry.tool_report, contacts.cmt, "the tool"), contacts.pairs,
                  contacts.pairs == 1 ? "pair" : "pairs");
  return profile == Profile::kPaper
             ? sentence
             : sentence + ", but no sample of either lies in the other: nothing pushes it";
}

void tell_start(const LoadedScene& scene, const Contacts& contacts, const ContactResponse& response,
                std::vector<std::string>& out) {
  const SceneGeometry& geometry = scene.geometry;
  if (contacts.field.max_depth == 0) {
    if (contacts.contact) out.push_back(in_touch(geometry, contacts, scene.scene.response.profile));
    return;
  }
  const std::string tool = part_of(geometry.tool_report, contacts.field.deepest_mobile, "the tool");
  std::vector<std::size_t> deepest;
  for (std::size_t i = 0; i < response.areas.size(); ++i)
    if (response.areas[i].max_depth > 0) deepest.push_back(i);
  std::stable_sort(deepest.begin(), deepest.end(), [&](std::size_t a, std::size_t b) {
    return response.areas[a].max_depth > response.areas[b].max_depth;
  });
  const std::size_t more = deepest.size() - std::min(deepest.size(), kToldAreas);
  deepest.resize(deepest.size() - more);
  const auto start = [](double depth, const std::string& part) {
    return fmt::format("the tool starts up to {} deep in {}", length_text(depth), part);
  };
  for (const std::size_t i : deepest) {
    const ContactArea& area = contacts.areas[i];
    std::string sentence =
        start(response.areas[i].max_depth,
              part_of(geometry.mockup_report, area.static_ids.empty() ? area.id : area.static_ids.front(),
                      "the mock-up"));
    if (!area.mobile_ids.empty())
      sentence += ", its part " + part_of(geometry.tool_report, area.mobile_ids.front(), "the tool");
    else if (i == deepest.front() && !geometry.tool_report.parts.empty())
      sentence += ", its part " + tool;
    out.push_back(sentence + ", about " + place(response.areas[i].point));
  }
  if (deepest.empty())
    out.push_back(start(geometry.lattice.step_m * contacts.field.max_depth,
                        part_of(geometry.mockup_report, contacts.field.deepest_static, "the mock-up")) +
                  ", its part " + tool);
  if (more > 0) out.push_back(fmt::format("and in {} more {}", more, more > 1 ? "places" : "place"));
  out.push_back(scene.scene.start_contacts == StartContacts::kIgnoreInitial
                    ? "the scene has \"start\": \"ignore_initial\": a run leaves these contacts out until "
                      "they have opened once"
                    : "these contacts push from the start; \"start\": \"ignore_initial\" in the scene leaves "
                      "them out until they have opened once");
}

constexpr std::size_t kMostAsked = 100;  // triangles (chosen: up to a millisecond or two each)
constexpr double kBeside = 16;           // steps: far more than rounding moves a triangle (chosen)

/// How sure it is what of a body's triangles that touch another, which is not closed, lies inside that: a
/// triangle is in doubt where the other's winding number is nearer to one half than to a whole number, on
/// both its sides, for on a surface it is one half. The vote and its voxels have no part in it.
template <class ToOther>
std::string doubt(const LatticeMesh& own, std::initializer_list<const std::vector<std::uint32_t>*> touching,
                  const LatticeMesh& other, const ToOther& to_other, const char* own_name) {
  std::vector<std::uint32_t> ids;
  for (const std::vector<std::uint32_t>* list : touching) ids.insert(ids.end(), list->begin(), list->end());
  if (ids.empty()) return {};
  const WindingNumber winding(other);
  const auto open = [&](const Vec3& point) {
    const double number = winding.at(point), part = number - std::floor(number);
    return part > 0.25 && part < 0.75;
  };
  const std::size_t asked = std::min(ids.size(), kMostAsked);
  std::size_t doubtful = 0;
  for (std::size_t i = 0; i < asked; ++i) {
    const std::uint32_t id = ids[i * ids.size() / asked];
    const Vec3 a = to_other(own.corner(id, 0)), b = to_other(own.corner(id, 1)),
               c = to_other(own.corner(id, 2));
    const Vec3 side = kBeside * glm::normalize(glm::cross(b - a, c - a)), middle = (a + b + c) / 3.0;
    if (open(middle + side) && open(middle - side)) ++doubtful;
  }
  return fmt::format("; {} of {} triangles of the {} that touch it{} {} where that is in doubt",
                     doubtful == 0 ? "none" : fmt::format("{}", doubtful), asked, own_name,
                     asked < ids.size() ? fmt::format(" (looked at: {} of {})", asked, ids.size()) : "",
                     doubtful > 1 ? "lie" : "lies");
}

}  // namespace

Result<SceneTalk> scene_talk(const LoadedScene& scene, CollisionBackend& backend,
                             const std::optional<Pose>& at) {
  SceneTalk out;
  const SceneGeometry& geometry = scene.geometry;
  const Profile profile = scene.scene.response.profile;
  const double stiffness = scene.scene.response.stiffness_n_per_m;
  const Result<LatticePose> pose = to_lattice(at ? *at : scene.scene.start, geometry);
  if (!pose) return pose.error();
  Contacts contacts;
  if (auto done = backend.query(*pose, nullptr, contacts); !done) return done.error();
  ContactResponse response;
  respond(contacts, *pose, geometry, profile, stiffness, response);
  tell_start(scene, contacts, response, out.start);
  out.free = !contacts.contact;
  if (profile == Profile::kPaper) return out;

  const auto to_world = [&](const Int3& p) { return Vec3(transform(*pose, p)); };
  const auto to_tool = [&](const Int3& p) {
    Vec3 own(0);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r)
        own[c] += 0x1p-30 * pose->rotation_q30[r][c] * (static_cast<double>(p[r]) - pose->translation[r]);
    return own;
  };
  const std::string vote = "what is inside it is a vote (docs/EXACTNESS.md, sections 2 and 4)";
  if (!geometry.mockup.closed)
    out.bodies.push_back(
        "the mock-up is not closed" +
        std::string(
            backend.has_internal_voxels()
                ? ""
                : ", and no voxel of it is wholly inside, so that where it is a mere surface it hardly "
                  "pushes the tool's own out (\"sheet_thickness\": \"auto\" in the scene gives it "
                  "walls)") +
        ": " + vote +
        doubt(geometry.tool, {&contacts.cmt, &contacts.imt}, geometry.mockup, to_world, "tool"));
  if (!geometry.tool.closed && !pose->beyond_lattice)
    out.bodies.push_back(
        (contacts.flags & kFlagToolOpen) != 0
            ? "the tool is open and has no inside: it is pushed as a sheet is, out of the mock-up; "
              "\"sheet_thickness\": \"auto\" in the scene gives it walls"
            : "the tool is not closed: " + vote +
                  doubt(geometry.mockup, {&contacts.cst, &contacts.est}, geometry.tool, to_tool, "mock-up"));

  // The mean thickness, of a plate its own: what is thick on the whole may have thin walls, but one sentence
  // on every block would be read by nobody.
  const double force = scene.scene.device.max_force_n, least = least_wall_m(stiffness, force);
  const auto mean = [&](const SurfaceMeasure& body) {
    return body.area > 0 && body.volume > 0 ? 2 * body.volume / body.area * geometry.lattice.step_m : 0;
  };
  for (const auto& [thickness, body] :
       {std::pair{mean(geometry.tool_surface), "tool"}, {mean(geometry.mockup_surface), "mock-up"}})
    if (thickness > 0 && thickness < least)
      out.bodies.push_back(
          fmt::format("walls of the {} are {:.2g} mm thick on the mean (twice its volume by its surface); "
                      "thinner than {:.2g} mm the device's "
                      "{:g} N push through them where they meet on {:.3g} mm² or less",
                      body, thickness * 1000, least * 1000, force, geometry.reference_area_m2 * 1e6));
  return out;
}

}  // namespace palpate
