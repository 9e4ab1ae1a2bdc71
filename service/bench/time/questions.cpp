#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "model/lattice/rotation.h"
#include "service/bench/bench.h"
#include "service/bench/output.h"
#include "service/bench/poses.h"
#include "service/bench/ready_scene.h"
#include "service/bench/time/times.h"
#include "service/cli/answer.h"
#include "service/cli/numbers.h"
#include "service/queries/first_contact.h"
#include "service/report/run_summary.h"

namespace palpate {
namespace {

/// What is asked at a pose. A frame is for comparison.
enum Question : std::size_t { kAny, kDistance, kFirstContact, kFrame, kQuestions };
constexpr const char* kQuestionNames[] = {"any", "distance", "first contact", "frame"};

/// A peer's vertices are turned without rounding (bench/peers/bodies.h): a step; palpate's distance is a
/// whole number of them, rounded down: another.
constexpr double kAgreeSteps = 2;

struct Answers {
  std::vector<std::uint8_t> touches;  ///< a pose
  std::vector<double> distance_m;     ///< likewise; palpate's is no number where it measures none
};

struct Asked {
  std::unique_ptr<QuestionPeer> peer;  ///< null: palpate
  double build_s = 0;
  Answers answers;
  std::uint64_t wrong_touch = 0, wrong_distance = 0;
  double largest_error_m = 0;
  TimeTable times[kQuestions];
  std::string engine[kQuestions];  ///< palpate's that answered last
};

struct Inquiry {
  std::unique_ptr<HostedScene> scene;
  std::vector<Asked> asked;  ///< palpate first
  std::vector<Pose> poses;
  std::vector<LatticePose> lattice;
  std::vector<FrameKind> kinds;
  std::uint64_t contained = 0;  ///< poses in contact without a pair: peers see surfaces alone
  bool measures = true;         ///< palpate's engine measures distances
};

/// Poses a planner asks at: each moved, by as much as `reach` times the tool's radius and as many radians,
/// and mostly by far less, so that some touch, some come near and some are far.
std::vector<Pose> moved(const std::vector<Pose>& poses, const SceneGeometry& geometry, double reach) {
  std::mt19937_64 random(1);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const double radius_m = geometry.tool_radius * geometry.lattice.step_m;
  std::vector<Pose> out;
  for (const Pose& pose : poses) {
    const double far = reach * std::pow(10.0, -3 * unit());
    const auto some = [&] { return far * Vec3(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1); };
    const Vec3 shift = radius_m * some(), turn = some();
    out.push_back({pose.position + shift, glm::normalize(rotation_by(turn) * pose.rotation)});
  }
  return out;
}

/// palpate's own answers, and the time that each took.
Result<void> ask_ours(Inquiry& inquiry, std::size_t i, const BenchOptions& options, Asked& ours) {
  const SceneGeometry& geometry = inquiry.scene->loaded.geometry;
  CollisionBackend& backend = *inquiry.scene->backend;
  const LatticePose& pose = inquiry.lattice[i];
  std::uint8_t bit = 0;
  Clearance clearance;
  {
    const Stopwatch watch(options.cpu_clock);
    if (auto done = backend.touches({&pose, 1}, {&bit, 1}); !done) return done;
    ours.times[kAny].add(inquiry.kinds[i], watch.us());
    ours.engine[kAny] = backend.measured_by();
  }
  if (inquiry.measures) {
    const Stopwatch watch(options.cpu_clock);
    if (auto done = backend.clearance(pose, INT32_MAX - 2, clearance); !done) return done;
    ours.times[kDistance].add(inquiry.kinds[i], watch.us());
    ours.engine[kDistance] = backend.measured_by();
  }
  if (inquiry.measures && i + 1 < inquiry.poses.size()) {
    const TouchRule rule = TouchRule::of(geometry, 0);
    const Stopwatch watch(options.cpu_clock);
    const auto found = first_contact(backend, geometry, inquiry.poses[i], inquiry.poses[i + 1], rule);
    if (!found) return found.error();
    ours.times[kFirstContact].add(inquiry.kinds[i], watch.us());
    ours.engine[kFirstContact] = backend.measured_by();
  }
  Answer frame;
  const Stopwatch watch(options.cpu_clock);
  if (auto done = answer_frame(*inquiry.scene, inquiry.poses[i], frame); !done) return done;
  ours.times[kFrame].add(inquiry.kinds[i], watch.us());
  ours.engine[kFrame] = backend.name();
  ours.answers.touches[i] = bit;
  ours.answers.distance_m[i] = !inquiry.measures || clearance.kind == Clearance::Kind::kFurther
                                   ? std::numeric_limits<double>::quiet_NaN()
                                   : clearance.steps * geometry.lattice.step_m;
  return {};
}

void ask_peer(const Inquiry& inquiry, std::size_t i, const BenchOptions& options, Asked& asked) {
  {
    const Stopwatch watch(options.cpu_clock);
    if (const std::optional<bool> touches = asked.peer->touches(inquiry.lattice[i])) {
      asked.times[kAny].add(inquiry.kinds[i], watch.us());
      asked.answers.touches[i] = *touches ? 1 : 0;
    }
  }
  const Stopwatch watch(options.cpu_clock);
  asked.answers.distance_m[i] = asked.peer->distance(inquiry.lattice[i]);
  asked.times[kDistance].add(inquiry.kinds[i], watch.us());
}

/// Holds everybody's answers against palpate's, which CGAL's exact kernel judges (tests/queries).
void compare(Inquiry& inquiry, const std::vector<std::uint8_t>& has_pairs) {
  const Answers& ours = inquiry.asked.front().answers;
  const double step_m = inquiry.scene->loaded.geometry.lattice.step_m;
  for (std::size_t k = 1; k < inquiry.asked.size(); ++k) {
    Asked& asked = inquiry.asked[k];
    asked.wrong_touch = asked.wrong_distance = 0;
    for (std::size_t i = 0; i < inquiry.poses.size(); ++i) {
      if (inquiry.kinds[i] == FrameKind::kContact && has_pairs[i] == 0) continue;
      asked.wrong_touch += asked.answers.touches[i] != ours.touches[i] ? 1u : 0u;
      if (std::isnan(ours.distance_m[i])) continue;  // beyond the lattice, where palpate measures nothing
      const double error = std::abs(std::max(asked.answers.distance_m[i], 0.0) - ours.distance_m[i]);
      asked.wrong_distance += error > kAgreeSteps * step_m ? 1u : 0u;
      asked.largest_error_m = std::max(asked.largest_error_m, error);
    }
  }
}

Result<Inquiry> inquire(const BenchOptions& options, const std::string& file, const Parts& parts,
                        Console& console) {
  Inquiry inquiry;
  auto prepared =
      ready_scene(options, file, asked_backends(options).front(), Purpose::kQuery, parts, console);
  if (!prepared) return prepared.error();
  inquiry.scene = std::move(*prepared);
  const SceneGeometry& geometry = inquiry.scene->loaded.geometry;
  auto poses = bench_poses(options, *inquiry.scene, parts, console);
  if (!poses) return poses.error();
  inquiry.poses = options.reach > 0 ? moved(*poses, geometry, options.reach) : std::move(*poses);

  console.step("questions");
  std::vector<std::uint8_t> has_pairs;
  Answer answer;
  for (const Pose& pose : inquiry.poses) {
    const Result<LatticePose> at = to_lattice(pose, geometry);
    if (!at) return at.error();
    inquiry.lattice.push_back(*at);
    if (auto done = answer_frame(*inquiry.scene, pose, answer); !done) return done.error();
    inquiry.kinds.push_back(frame_kind(answer.contacts));
    has_pairs.push_back(answer.contacts.pairs != 0 ? 1 : 0);
    inquiry.contained += answer.contacts.contact && answer.contacts.pairs == 0 ? 1u : 0u;
  }
  inquiry.asked.emplace_back();
  if (parts.make_question_peers)
    for (auto& peer : parts.make_question_peers()) {
      if (!console.progress(peer->name().c_str(), 0)) return Error{ErrorCode::kInternal, "interrupted"};
      const Stopwatch watch(options.cpu_clock);
      peer->build(geometry);
      Asked asked;
      asked.build_s = watch.us() * 1e-6;
      asked.peer = std::move(peer);
      inquiry.asked.push_back(std::move(asked));
    }
  for (Asked& asked : inquiry.asked)
    asked.answers = {std::vector<std::uint8_t>(inquiry.poses.size()),
                     std::vector<double>(inquiry.poses.size())};
  // The first question makes what all read.
  Clearance first;
  if (auto done = inquiry.scene->backend->clearance(inquiry.lattice.front(), INT32_MAX - 2, first); !done) {
    if (done.error().code != ErrorCode::kUsage) return done.error();
    inquiry.measures = false;
  }

  // In turns, pose by pose, nobody always the first.
  const std::size_t runners = inquiry.asked.size();
  for (std::uint64_t round = 0; round < options.rounds; ++round)
    for (std::size_t i = 0; i < inquiry.poses.size(); ++i) {
      for (std::size_t k = 0; k < runners; ++k) {
        Asked& asked = inquiry.asked[(i + k) % runners];
        if (asked.peer)
          ask_peer(inquiry, i, options, asked);
        else if (auto done = ask_ours(inquiry, i, options, asked); !done)
          return done.error();
      }
      const double done = static_cast<double>(round * inquiry.poses.size() + i) /
                          static_cast<double>(options.rounds * inquiry.poses.size());
      if (!console.progress("asking", done)) return Error{ErrorCode::kInternal, "interrupted"};
    }
  console.finish();
  compare(inquiry, has_pairs);
  return inquiry;
}

void add_rows(const std::string& scene, const Inquiry& inquiry, BenchTable& table) {
  const std::string none;
  for (std::size_t question = 0; question < kQuestions; ++question)
    for (std::size_t kind = 0; kind < 4; ++kind) {
      const TimePercentiles ours = percentiles(inquiry.asked.front().times[question].times(kind, "total"));
      for (const Asked& asked : inquiry.asked) {
        const TimePercentiles p = percentiles(asked.times[question].times(kind, "total"));
        if (p.count == 0) continue;
        const bool counts = asked.peer && kind == 3;
        table.rows.push_back(
            {scene, kQuestionNames[question],
             asked.peer ? asked.peer->name() : "palpate " + asked.engine[question], kFrameKindNames[kind],
             std::uint64_t{p.count}, p.p50, p.p95, p.p99, cell_of(p.p999), p.max,
             ours.count == 0 ? BenchCell(none) : ours.p50 / p.p50,
             ours.count == 0 ? BenchCell(none) : ours.p99 / p.p99,
             counts ? BenchCell(question == kAny ? asked.wrong_touch : asked.wrong_distance) : none,
             counts && question == kDistance ? BenchCell(asked.largest_error_m) : none});
      }
    }
}

}  // namespace

Result<void> bench_questions(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  Console console;
  BenchFacts facts{.command = "questions", .device = {}, .more = {}};
  BenchTable table{
      {"scene", "question", "library", "frames", "count", "p50_us", "p95_us", "p99_us", "p999_us", "max_us",
       "palpate_p50_ratio", "palpate_p99_ratio", "poses_different", "largest_error_m"},
      {}};
  std::vector<Chart> charts;
  const double load = load_average();
  for (const std::string& file : options.scenes) {
    const Result<Inquiry> inquiry = inquire(options, file, parts, console);
    if (!inquiry) return inquiry.error();
    const std::string name = scene_name(file);
    const SceneGeometry& geometry = inquiry->scene->loaded.geometry;
    add_rows(name, *inquiry, table);
    Chart chart{.title = name,
                .unit = "µs, logarithmic",
                .labels = {"any, p50", "any, p99", "distance, p50", "distance, p99"},
                .series = {},
                .log_y = true,
                .x_title = {}};
    for (const Asked& asked : inquiry->asked) {
      const TimePercentiles any = percentiles(asked.times[kAny].times(3, "total")),
                            distance = percentiles(asked.times[kDistance].times(3, "total"));
      const double nothing = std::numeric_limits<double>::quiet_NaN();
      chart.series.push_back({asked.peer ? asked.peer->name() : "palpate",
                              {},
                              {any.p50, any.p99, distance.count == 0 ? nothing : distance.p50,
                               distance.count == 0 ? nothing : distance.p99}});
      if (asked.peer)
        facts.more.emplace_back(
            fmt::format("{}, {}", name, asked.peer->name()),
            fmt::format("version {}, trees built in {:.2f} s", asked.peer->version(), asked.build_s));
    }
    charts.push_back(std::move(chart));
    if (facts.device.empty()) facts.device = device_text(*inquiry->scene->backend, parts);
    facts.more.emplace_back(
        name,
        fmt::format("mock-up {} triangles, tool {}, {} poses moved by up to {:g} of the tool's radius, "
                    "{} with the tool inside and no pair",
                    count_text(geometry.mockup.triangles.size()), count_text(geometry.tool.triangles.size()),
                    inquiry->poses.size(), options.reach, inquiry->contained));
    if (!inquiry->measures)
      facts.more.emplace_back(name, fmt::format("the {} engine measures no distances: these and first "
                                                "contacts were not asked of palpate",
                                                inquiry->scene->backend->name()));
  }
  facts.more.emplace_back("clock", options.cpu_clock ? "CPU time of this process" : "wall");
  facts.more.emplace_back("load average",
                          fmt::format("{:.1f} at the start, {:.1f} at the end", load, load_average()));
  return write_bench(options.out, facts, table, charts);
}

}  // namespace palpate
