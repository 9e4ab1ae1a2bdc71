#include "tests/mutation/oracle.h"

#include <sys/resource.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <stdexcept>
#include <tuple>

#include "model/contact/response.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/touching_poses.h"
#include "tests/mutation/must.h"

namespace palpate::mutation {
namespace {

bool go_on(const char*, double) { return true; }

constexpr std::uint64_t kSeed = 1;
constexpr double kStiffness = 1000;  // N/m
constexpr std::int32_t kAnyDistance = INT32_MAX - 2;

const char* difference(const LatticeMesh& a, const LatticeMesh& b) {
  if (a.vertices != b.vertices) return "vertices";
  if (a.triangles != b.triangles) return "triangles";
  if (a.flags != b.flags) return "flags";
  if (a.unit_normal_q30 != b.unit_normal_q30 || a.sample_weight_q30 != b.sample_weight_q30 ||
      a.sample_axis != b.sample_axis)
    return "normals";
  if (a.neighbour_begin != b.neighbour_begin || a.neighbours != b.neighbours) return "neighbours";
  if (a.patch != b.patch || a.patch_count != b.patch_count) return "patches";
  if (a.field_weight_q30 != b.field_weight_q30 || a.extra_samples != b.extra_samples) return "field weights";
  if (a.levels_of != b.levels_of || a.side_levels != b.side_levels || a.grid_samples != b.grid_samples)
    return "levels";
  if (a.closed != b.closed) return "closed";
  return a.box_min != b.box_min || a.box_max != b.box_max ? "box" : "";
}

const char* difference(const MeshReport& a, const MeshReport& b) {
  const auto numbers = [](const MeshReport& r) {
    return std::tuple(r.triangles, r.vertices, r.collapsed, r.duplicate, r.open_edges, r.nonmanifold_edges,
                      r.largest_gap_m, r.notes);
  };
  if (numbers(a) != numbers(b) || a.parts.size() != b.parts.size()) return "report";
  const auto facts = [](const MeshReport::Part& p) {
    return std::tuple(p.path, p.triangles, p.closed, p.sheet, p.turned, p.orientable);
  };
  for (std::size_t i = 0; i < a.parts.size(); ++i)
    if (facts(a.parts[i]) != facts(b.parts[i])) return "parts";
  return "";
}

std::string difference(const SceneGeometry& a, const SceneGeometry& b) {
  if (const char* what = difference(a.mockup, b.mockup); *what != 0) return std::string("mock-up's ") + what;
  if (const char* what = difference(a.tool, b.tool); *what != 0) return std::string("tool's ") + what;
  if (const char* what = difference(a.mockup_report, b.mockup_report); *what != 0)
    return std::string("mock-up's ") + what;
  if (const char* what = difference(a.tool_report, b.tool_report); *what != 0)
    return std::string("tool's ") + what;
  const auto rest = [](const SceneGeometry& g) {
    return std::tuple(g.lattice.step_m, g.tool_gc.x, g.tool_gc.y, g.tool_gc.z, g.tool_radius,
                      g.mockup_grid.size, g.sample_spacing, g.smooth_angle.cos2_numerator,
                      g.smooth_angle.cos2_denominator);
  };
  return rest(a) != rest(b) ? "lattice, centre, grid or spacing" : "";
}

const char* difference(const ContactResponse& a, const ContactResponse& b) {
  if (a.gc != b.gc) return "gc";
  if (a.wrench.force != b.wrench.force || a.wrench.torque != b.wrench.torque) return "wrench";
  if (a.flags != b.flags || a.contact != b.contact || a.areas.size() != b.areas.size())
    return "flags, contact or number of areas";
  const auto facts = [](const AreaResponse& r) {
    return std::tuple(r.id, r.normal.x, r.normal.y, r.normal.z, r.depth, r.max_depth, r.slope, r.point.x,
                      r.point.y, r.point.z, r.flags);
  };
  for (std::size_t i = 0; i < a.areas.size(); ++i)
    if (facts(a.areas[i]) != facts(b.areas[i]) || a.areas[i].force != b.areas[i].force ||
        a.areas[i].torque != b.areas[i].torque)
      return "area";
  return "";
}

double processor_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace

Oracle::Oracle(CollisionBackend& backend, bool killers, const std::vector<std::string>& without,
               std::function<void(bool)> unchanged)
    : backend_(backend), unchanged_(std::move(unchanged)), wanted_(equivalence::all_cases()) {
  std::stable_partition(wanted_.begin(), wanted_.end(), [](const equivalence::Case& c) { return c.killer; });
  // The chapter's large scenes ask nothing that small ones don't, at many times the price.
  std::erase_if(wanted_, [&](const equivalence::Case& w) {
    return (killers ? !w.killer : w.family == "chapter") ||
           std::find(without.begin(), without.end(), w.name) != without.end();
  });
  cases_.resize(wanted_.size());  // back ends keep the geometry's address
  for (std::size_t c = 0; c < cases_.size(); ++c) {
    cases_[c].name = wanted_[c].name;
    cases_[c].wanted = &wanted_[c];
  }
  order_.resize(cases_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
}

void Oracle::refined_alone() {
  refined_alone_ = true;
  std::erase_if(order_, [&](std::size_t c) { return cases_[c].wanted->profile != Profile::kRefined; });
}

void Oracle::begin_anew() const {
  const Case& c = cases_[order_.front()];
  must(backend_.prepare(c.geometry, c.plan, go_on));
  must(backend_.finish_preparing());
}

void Oracle::answer_all() {
  for (const std::size_t c : order_)
    if (!cases_[c].answered) answer(cases_[c]);
}

void Oracle::answer(Case& c) {
  unchanged_(true);
  const double begin = processor_seconds();
  const equivalence::Case& wanted = *c.wanted;
  equivalence::TestScene scene = must(wanted.make(kSeed));
  c.geometry = std::move(scene.geometry);
  c.plan.profile = wanted.profile;
  c.plan.est = wanted.profile == Profile::kRefined;
  must(backend_.prepare(c.geometry, c.plan, go_on));
  c.mockup = must(backend_.partition(false));
  if (wanted.profile == Profile::kRefined) c.tool = must(backend_.partition(true));

  Ignored ignored;
  if (wanted.ignoring)
    for (std::uint32_t patch = 0; patch < c.geometry.mockup.patch_count; patch += 2)
      ignored.patches.push_back(patch);
  for (int i = 0; i < wanted.poses; ++i) {
    equivalence::Random random(kSeed, static_cast<std::uint64_t>(i));
    equivalence::Known known;
    Query q;
    if (wanted.ignoring && i % equivalence::kChain != 0)
      q.pose = equivalence::moved_on(c.queries.back().pose, c.geometry.mockup_grid.size, random);
    else
      q.pose = scene.pose(c.geometry, random, known);
    if (wanted.coarser) ignored.coarser = 97 * static_cast<std::uint32_t>(i) % (Ignored::kCoarsest + 1);
    if (wanted.ignoring || wanted.coarser) q.ignored = ignored;
    must(backend_.query(q.pose, q.ignored ? &*q.ignored : nullptr, q.answer));
    if (q.answer.truncated && !c.name.starts_with("too_many_"))
      throw std::runtime_error(c.name + ": no room in " + q.answer.truncated_capacity);
    respond(q.answer, q.pose, c.geometry, wanted.profile, kStiffness, q.response);
    if (Clearance near; !q.answer.contact && backend_.clearance(q.pose, kAnyDistance, near))
      q.clearance = near;
    c.queries.push_back(std::move(q));
  }
  if (refined_alone_) {
    std::vector<LatticePose> poses;
    std::vector<std::uint8_t> touch;
    for (const Query& q : c.queries) {
      poses.push_back(q.pose);
      Contacts told;
      must(backend_.query(q.pose, nullptr, told));
      touch.push_back(told.contact ? 1 : 0);
    }
    c.questions.emplace(backend_, c.geometry, poses, touch);
  }
  c.answered = true;
  c.seconds = processor_seconds() - begin;
  unchanged_(false);
}

std::string Oracle::ask(const Case& c) const {
  if (auto r = backend_.prepare(c.geometry, c.plan, go_on); !r) return "prepare: " + r.error().sentence;
  for (const bool tool : {false, true}) {
    if (tool && c.plan.profile != Profile::kRefined) continue;
    const auto partition = backend_.partition(tool);
    if (!partition) return partition.error().sentence;
    if (const std::string difference = first_difference(*partition, tool ? c.tool : c.mockup);
        !difference.empty())
      return std::string(tool ? "tool's" : "mock-up's") + " partition: " + difference;
  }
  Contacts answer;
  for (std::size_t i = 0; i < c.queries.size(); ++i) {
    const Query& q = c.queries[i];
    if (auto r = backend_.query(q.pose, q.ignored ? &*q.ignored : nullptr, answer); !r)
      return r.error().sentence;
    if (const std::string difference = first_difference(answer, q.answer); !difference.empty())
      return "pose " + std::to_string(i) + ": " + difference;
    if (!q.clearance || !planners_) continue;
    Clearance near;
    if (auto r = backend_.clearance(q.pose, kAnyDistance, near); !r) return r.error().sentence;
    if (!(near == *q.clearance)) return "pose " + std::to_string(i) + ": clearance";
  }
  if (refined_alone_) {
    // What nobody looks at is summed in parts, by two threads.
    Plan unwatched = c.plan;
    unwatched.telemetry = false;
    if (auto r = backend_.replan(unwatched); !r) return r.error().sentence;
    for (std::size_t i = 0; i < c.queries.size(); ++i) {
      const Query& q = c.queries[i];
      if (auto r = backend_.query(q.pose, q.ignored ? &*q.ignored : nullptr, answer); !r)
        return r.error().sentence;
      if (!(answer.field == q.answer.field) || answer.flags != q.answer.flags ||
          answer.ignored_touched != q.answer.ignored_touched)
        return "pose " + std::to_string(i) + ", unwatched: field";
    }
  }
  if (c.questions && planners_) return c.questions->difference(backend_, c.geometry);
  return {};
}

std::string Oracle::ask_host(const Case& c) const {
  const auto scene = c.wanted->make(kSeed);
  if (!scene) return scene.error().sentence;
  if (std::string different = difference(scene->geometry, c.geometry); !different.empty()) return different;
  ContactResponse response;
  for (std::size_t i = 0; i < c.queries.size(); ++i) {
    const Query& q = c.queries[i];
    respond(q.answer, q.pose, c.geometry, c.plan.profile, kStiffness, response);
    if (const char* what = difference(response, q.response); *what != 0)
      return "pose " + std::to_string(i) + ": response's " + what;
  }
  return {};
}

std::string Oracle::first_host_difference(std::size_t& of) const {
  for (const std::size_t c : order_) {
    of = c;
    if (std::string different = ask_host(cases_[c]); !different.empty()) return different;
  }
  return {};
}

std::string Oracle::first_difference_now(std::size_t& of) {
  for (const std::size_t c : order_) {
    if (!cases_[c].answered) answer(cases_[c]);
    of = c;
    before_case(cases_[c].seconds);
    if (std::string different = ask(cases_[c]); !different.empty()) return different;
  }
  return {};
}

std::string Oracle::first_difference_again(std::size_t& of) {
  for (const std::size_t c : order_) {
    if (!cases_[c].answered) continue;
    of = c;
    before_case(cases_[c].seconds);
    if (std::string different = ask(cases_[c]); !different.empty()) return different;
  }
  return {};
}

std::optional<std::size_t> Oracle::find(const std::string& name) const {
  const auto found =
      std::find_if(cases_.begin(), cases_.end(), [&](const Case& c) { return c.name == name; });
  if (found == cases_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - cases_.begin());
}

std::string Oracle::tell(std::size_t of, std::vector<std::string>& told) {
  constexpr std::size_t kPoses = 5;
  if (!cases_[of].answered) answer(cases_[of]);
  const Case& c = cases_[of];
  if (auto r = backend_.prepare(c.geometry, c.plan, go_on); !r) return "prepare: " + r.error().sentence;
  told.clear();
  Contacts answer;
  for (const Query& q : std::span(c.queries).first(std::min(kPoses, c.queries.size()))) {
    if (auto r = backend_.query(q.pose, q.ignored ? &*q.ignored : nullptr, answer); !r)
      return r.error().sentence;
    told.push_back(answer.truncated ? answer.truncated_capacity : first_difference(answer, q.answer));
  }
  return {};
}

std::string Oracle::first_overflow_difference(
    std::size_t& of, const std::function<void(const char*, std::uint32_t)>& set_room) {
  if (overflows_.empty()) {
    constexpr std::pair<const char*, const char*> kAsked[] = {
        {"near parts of the tool", "ball_on_block"},
        {"touched voxels", "ball_on_block"},
        {"lists of touched voxels", "ball_on_block"},
        {"pairs to test", "ball_on_block"},
        {"pairs", "ball_on_block"},
        {"contact triangles of the mock-up", "ball_on_block"},
        {"contact triangles of the tool", "ball_on_block"},
        {"lists with samples", "ball_on_block"},
        {"samples near the tool's surface", "ball_on_block"},
        {"samples", "ball_on_block"},
        {"tool triangles of areas", "ball_on_block_paper"},
        {"tiles of tool samples", "ball_on_block"},
        {"samples of the tool", "ball_on_block"},
        {"extra samples", "needle"},
        {"ignored patches", "sheets_in_a_row_ignoring"},
        {"samples near the tool's surface", "open_ball"}};
    for (const auto& [list, name] : kAsked)
      for (const std::uint32_t room : {1u, 3u})
        for (std::size_t c = 0; c < cases_.size(); ++c)
          if (cases_[c].name == name) overflows_.push_back({list, room, c, {}});
    for (const Overflow& o : overflows_)
      if (!cases_[o.of].answered) answer(cases_[o.of]);
    unchanged_(true);
    for (Overflow& o : overflows_) {
      set_room(o.list, o.room);
      if (const std::string failure = tell(o.of, o.told); !failure.empty())
        throw std::runtime_error(std::string(o.list) + ": " + failure);
    }
    set_room("", 0);
    unchanged_(false);
  }
  std::vector<std::string> told;
  for (const Overflow& o : overflows_) {
    of = o.of;
    set_room(o.list, o.room);
    before_case(cases_[o.of].seconds);
    std::string different = tell(o.of, told);
    if (different.empty() && told != o.told) different = "what is told";
    if (!different.empty()) {
      set_room("", 0);
      return std::string(o.list) + " of " + std::to_string(o.room) + ": " + different;
    }
  }
  set_room("", 0);
  return {};
}

void Oracle::ask_first(std::size_t c) {
  const auto at = std::find(order_.begin(), order_.end(), c);
  std::rotate(order_.begin(), at, at + 1);
}

}  // namespace palpate::mutation
