#include "tests/equivalence/case_run.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "model/response.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/known.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

constexpr double kStiffness = 2000;   ///< N/m; any would do

std::string text_of(const LatticePose& pose) {
  std::string text = "rotation_q30";
  for (const auto& row : pose.rotation_q30)
    for (const std::int32_t entry : row) text += " " + std::to_string(entry);
  text += " translation";
  for (int k = 0; k < 3; ++k) text += " " + std::to_string(pose.translation[k]);
  return text;
}

/// One case being run.
class Runner {
 public:
  Runner(const Case& c, const Backends& backends, const RunSettings& settings) : case_(c), backends_(backends), settings_(settings) {}

  CaseRun run() {
    const auto start = std::chrono::steady_clock::now();
    auto scene = case_.make(settings_.seed);
    if (!scene)
      differs("the scene could not be made: " + scene.error().sentence);
    else if (prepare(*scene) && compare_preparation(*scene))
      ask_poses(*scene);
    out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(out_);
  }

 private:
  bool prepare(const TestScene& scene) {
    Plan plan;
    plan.profile = case_.profile;
    plan.est = case_.profile == Profile::kRefined;
    for (const auto& backend : backends_) {
      const auto prepared = backend->prepare(scene.geometry, plan, [](const char*, double) { return true; });
      if (prepared) continue;
      // A value refused is a limit of the back end; anything else is a fault.
      const std::string sentence = backend->name() + " did not prepare: " + prepared.error().sentence;
      if (prepared.error().code == ErrorCode::kBadValue)
        not_supported(sentence);
      else
        differs(sentence);
      return false;
    }
    return true;
  }

  bool compare_preparation(const TestScene& scene) {
    for (const bool tool : {false, true}) {
      if (tool && case_.profile != Profile::kRefined) continue;
      std::optional<VoxelPartition> first;
      for (const auto& backend : backends_) {
        auto partition = backend->partition(tool);
        if (!partition) {
          differs(backend->name() + " has no partition: " + partition.error().sentence);
          return false;
        }
        if (!first) {
          first = std::move(*partition);
          add(out_.hashes, *first);
          if (!tool && scene.known_class)
            if (const std::string wrong = judge_classes(*first, scene.known_class); !wrong.empty()) differs(wrong);
        } else if (const std::string difference = first_difference(*first, *partition); !difference.empty()) {
          differs(std::string(tool ? "tool's" : "mock-up's") + " partition: " + difference + " (" + backends_[0]->name() + ", " + backend->name() + ")");
        }
      }
    }
    return true;
  }

  void ask_poses(const TestScene& scene) {
    const SceneGeometry& geometry = scene.geometry;
    const std::uint64_t count = settings_.poses.value_or(static_cast<std::uint64_t>(case_.poses));
    const std::uint64_t first = case_.held ? settings_.first - settings_.first % kChain : settings_.first;
    Held held;
    LatticePose pose;
    for (std::uint64_t i = first; i < settings_.first + count; ++i) {
      Random random(settings_.seed, i);
      Known known;
      if (case_.held && i % kChain != 0)
        pose = moved_on(pose, geometry.mockup_grid.size, random);
      else
        pose = scene.pose(geometry, random, known), held = {};
      counted_ = i >= settings_.first;
      where_ = "pose " + std::to_string(i) + ", " + text_of(pose);
      if (!ask(geometry, pose, case_.held ? &held : nullptr, known)) return;
      if (case_.held) remember(contacts_, response_, held);
    }
  }

  /// One pose, every back end. False: no more.
  bool ask(const SceneGeometry& geometry, const LatticePose& pose, const Held* held, const Known& known) {
    if (!query(*backends_[0], pose, held, contacts_)) return false;
    respond(contacts_, pose, geometry, case_.profile, kStiffness, response_, held);
    if (!counted_) return true;
    count(geometry, pose, known);
    if (settings_.twice) {
      if (!query(*backends_[0], pose, held, other_)) return false;
      compare(first_difference(contacts_, other_), "two runs of " + backends_[0]->name());
    }
    for (std::size_t b = 1; b < backends_.size(); ++b) {
      if (!query(*backends_[b], pose, held, other_)) return false;
      compare(first_difference(contacts_, other_), backends_[0]->name() + ", " + backends_[b]->name());
      respond(other_, pose, geometry, case_.profile, kStiffness, other_response_, held);
      CaseHashes ours, theirs;
      add(ours, response_);
      add(theirs, other_response_);
      if (ours.response.value() != theirs.response.value()) compare("d, n_c, cp, F or T", backends_[0]->name() + ", " + backends_[b]->name());
    }
    compare(first_difference(known, contacts_), backends_[0]->name() + ", known beforehand");
    return out_.findings.size() < static_cast<std::size_t>(settings_.most_differences);
  }

  bool query(CollisionBackend& backend, const LatticePose& pose, const Held* held, Contacts& contacts) {
    const auto answered = backend.query(pose, held, contacts);
    if (!answered) differs(backend.name() + " failed: " + answered.error().sentence + "; " + where_);
    // More areas than a frame may have is an answer that both give. Any other capacity is a limit of one back end.
    const bool full = answered && contacts.truncated && std::strcmp(contacts.truncated_capacity, "areas") != 0;
    if (full) not_supported(backend.name() + " ran out of " + contacts.truncated_capacity + "; " + where_);
    return answered && !full;
  }

  void count(const SceneGeometry& geometry, const LatticePose& pose, const Known& known) {
    add(out_.hashes, contacts_);
    add(out_.hashes, response_);
    ++out_.poses;
    out_.contacts += contacts_.contact ? 1u : 0u;
    out_.with_pairs += contacts_.pairs > 0 ? 1u : 0u;
    out_.areas += contacts_.areas.size();
    if (known.pairs || known.areas || known.contact || known.est) ++out_.known;
    if (settings_.floats) judge_in_floats(geometry, pose, contacts_, out_.floats);
    if (contacts_.contact)
      for (const auto& time : contacts_.times) out_.stage_us[time.stage].push_back(time.us);
  }

  void compare(const std::string& difference, const std::string& who) {
    if (!difference.empty()) differs(difference + " (" + who + ") at " + where_);
  }
  void differs(std::string sentence) {
    out_.outcome = Outcome::kDiffers;
    out_.findings.push_back(std::move(sentence));
  }
  void not_supported(std::string sentence) {
    if (out_.outcome == Outcome::kEqual) out_.outcome = Outcome::kNotSupported;
    out_.findings.push_back(std::move(sentence));
  }

  const Case& case_;
  const Backends& backends_;
  const RunSettings& settings_;
  CaseRun out_;
  Contacts contacts_, other_;
  ContactResponse response_, other_response_;
  std::string where_;
  bool counted_ = true;
};

}  // namespace

CaseRun run_case(const Case& c, const Backends& backends, const RunSettings& settings) { return Runner(c, backends, settings).run(); }

}  // namespace palpate::equivalence
