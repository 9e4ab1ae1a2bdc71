#include "tests/equivalence/case_run.h"

#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

#include "model/contact/response.h"
#include "model/pose_threads.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/known.h"
#include "tests/equivalence/touching_poses.h"

namespace palpate::equivalence {
namespace {

constexpr double kStiffness = 2000;  ///< N/m; any would do

std::string text_of(const LatticePose& pose) {
  std::string text = "rotation_q30";
  for (const auto& row : pose.rotation_q30)
    for (const std::int32_t entry : row) text += " " + std::to_string(entry);
  text += " translation";
  for (int k = 0; k < 3; ++k) text += " " + std::to_string(pose.translation[k]);
  return text;
}

/// What one back end says to one pose.
struct Answer {
  Contacts contacts;
  Pairs pairs;
  ContactResponse response;
};

std::string first_difference(const Pairs& a, const Pairs& b) {
  if (a == b) return "";
  std::size_t i = 0;
  while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
  const auto text = [i](const Pairs& list) {
    return i < list.size() ? std::to_string(list[i].first) + " " + std::to_string(list[i].second) : "none";
  };
  return "pairs[" + std::to_string(i) + "]: " + text(a) + ", " + text(b);
}

/// The first difference of two answers; the responses, made of the contacts by one function, as bits.
std::string first_difference(const Answer& a, const Answer& b) {
  std::string difference = first_difference(a.contacts, b.contacts);
  if (difference.empty()) difference = first_difference(a.pairs, b.pairs);
  if (!difference.empty()) return difference;
  CaseHashes ours, theirs;
  add(ours, a.response);
  add(theirs, b.response);
  return ours.response.value() == theirs.response.value() ? "" : "d, n_c, cp, F or T";
}

/// One case being run.
class Runner {
 public:
  Runner(const Case& c, const Backends& backends, const RunSettings& settings)
      : case_(c), backends_(backends), settings_(settings) {}

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
    for (CollisionBackend* backend : backends_) {
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
      for (CollisionBackend* backend : backends_) {
        auto partition = backend->partition(tool);
        if (!partition) {
          differs(backend->name() + " has no partition: " + partition.error().sentence);
          return false;
        }
        if (!first) {
          first = std::move(*partition);
          add(out_.hashes, *first);
          if (!tool && scene.known_class)
            if (const std::string wrong = judge_classes(*first, scene.known_class); !wrong.empty())
              differs(wrong);
        } else if (const std::string difference = first_difference(*first, *partition); !difference.empty()) {
          differs(std::string(tool ? "tool's" : "mock-up's") + " partition: " + difference + " (" +
                  backends_[0]->name() + ", " + backend->name() + ")");
        }
      }
    }
    return true;
  }

  void ask_poses(const TestScene& scene) {
    const SceneGeometry& geometry = scene.geometry;
    const std::uint64_t count = settings_.poses.value_or(static_cast<std::uint64_t>(case_.poses));
    const std::uint64_t first = case_.ignoring ? settings_.first - settings_.first % kChain : settings_.first;
    // Every second patch of the mock-up, where a case leaves contacts out.
    Ignored ignored;
    if (case_.ignoring)
      for (std::uint32_t patch = 0; patch < geometry.mockup.patch_count; patch += 2)
        ignored.patches.push_back(patch);
    LatticePose pose;
    for (std::uint64_t i = first; i < settings_.first + count; ++i) {
      Random random(settings_.seed, i);
      Known known;
      if (case_.ignoring && i % kChain != 0)
        pose = moved_on(pose, geometry.mockup_grid.size, random);
      else
        pose = scene.pose(geometry, random, known);
      counted_ = i >= settings_.first;
      where_ = "pose " + std::to_string(i) + ", " + text_of(pose);
      if (case_.coarser) ignored.coarser = static_cast<std::uint32_t>(97 * i % (Ignored::kCoarsest + 1));
      if (!ask(geometry, pose, case_.ignoring || case_.coarser ? &ignored : nullptr, known)) return;
    }
    ask_together();
  }

  /// All poses that have been asked singly, as often as it takes until helpers are set up.
  void ask_together() {
    if (poses_.empty()) return;
    const std::size_t copies = kWorthThreads / poses_.size() + 1;
    std::vector<LatticePose> poses;
    for (std::size_t copy = 0; copy < copies; ++copy) poses.insert(poses.end(), poses_.begin(), poses_.end());
    std::vector<Contacts> batch(poses.size());
    if (const auto asked = backends_[0]->query_batch(poses, batch); !asked) {
      differs(backends_[0]->name() + " failed on a batch: " + asked.error().sentence);
      return;
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      where_ = "pose " + std::to_string(i % poses_.size()) + " of a batch, " + text_of(poses[i]);
      compare(first_difference(batch[i], singles_[i % poses_.size()]), backends_[0]->name() + ", it singly");
      if (out_.findings.size() >= static_cast<std::size_t>(settings_.most_differences)) return;
    }
  }

  /// One pose, every back end. False: no more.
  bool ask(const SceneGeometry& geometry, const LatticePose& pose, const Ignored* ignored,
           const Known& known) {
    if (!query(*backends_[0], geometry, pose, ignored, answer_)) return false;
    if (!counted_) return true;
    count(geometry, pose, known);
    if (settings_.batch && !case_.ignoring && !case_.coarser) {
      poses_.push_back(pose);
      singles_.push_back(answer_.contacts);
    }
    if (settings_.twice) {
      if (!query(*backends_[0], geometry, pose, ignored, other_)) return false;
      compare(first_difference(answer_, other_), "two runs of " + backends_[0]->name());
    }
    for (std::size_t b = 1; b < backends_.size(); ++b) {
      if (!query(*backends_[b], geometry, pose, ignored, other_)) return false;
      compare(first_difference(answer_, other_), backends_[0]->name() + ", " + backends_[b]->name());
    }
    compare(first_difference(known, answer_.contacts, answer_.pairs),
            backends_[0]->name() + ", known beforehand");
    return out_.findings.size() < static_cast<std::size_t>(settings_.most_differences);
  }

  bool query(CollisionBackend& backend, const SceneGeometry& geometry, const LatticePose& pose,
             const Ignored* ignored, Answer& answer) {
    if (const auto asked = backend.query(pose, ignored, answer.contacts); !asked) {
      differs(backend.name() + " failed: " + asked.error().sentence + "; " + where_);
      return false;
    }
    // More areas than a frame may have is an answer that both give. Any other capacity is a limit of one back
    // end.
    if (answer.contacts.truncated && std::strcmp(answer.contacts.truncated_capacity, "areas") != 0) {
      not_supported(backend.name() + " ran out of " + answer.contacts.truncated_capacity + "; " + where_);
      return false;
    }
    auto pairs = backend.pairs();
    if (!pairs) {
      differs(backend.name() + " lists no pairs: " + pairs.error().sentence + "; " + where_);
      return false;
    }
    answer.pairs = std::move(*pairs);
    respond(answer.contacts, pose, geometry, case_.profile, kStiffness, answer.response);
    return true;
  }

  void count(const SceneGeometry& geometry, const LatticePose& pose, const Known& known) {
    const Contacts& contacts = answer_.contacts;
    add(out_.hashes, contacts);
    for (const auto& [s, m] : answer_.pairs) out_.hashes.sets.add(std::uint64_t{s} << 32 | m);
    add(out_.hashes, answer_.response);
    ++out_.poses;
    out_.contacts += contacts.contact ? 1u : 0u;
    out_.with_pairs += contacts.pairs > 0 ? 1u : 0u;
    out_.areas += contacts.areas.size();
    if (known.pairs || known.areas || known.contact || known.est) ++out_.known;
    meet(contacts);
    if (settings_.floats) judge_in_floats(geometry, pose, contacts, out_.floats);
    if (contacts.contact)
      for (const auto& time : contacts.times) out_.stage_us[time.stage].push_back(time.us);
  }

  /// Which rules this pose came to.
  void meet(const Contacts& contacts) {
    const auto count = [this](const char* what, bool met) { out_.met[what] += met ? 1u : 0u; };
    count("CST", !contacts.cst.empty());
    count("BST", !contacts.bst.empty());
    count("EST", !contacts.est.empty());
    count("CMT", !contacts.cmt.empty());
    count("BMT", !contacts.bmt.empty());
    count("IMT", !contacts.imt.empty());
    count("areas", contacts.areas.size() > 1);
    count("truncated", contacts.truncated);
    bool zones = false;
    for (const ContactArea& area : contacts.areas) {
      zones = zones || area.zones.size() > 1;
      out_.flags |= area.flags;
    }
    count("zones", zones);
    count("field", contacts.field.max_depth > 0);
    count("ignored", !contacts.ignored_touched.empty());
    out_.flags |= contacts.flags | answer_.response.flags;
    for (const AreaResponse& area : answer_.response.areas) out_.flags |= area.flags;
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
  Answer answer_, other_;
  std::vector<LatticePose> poses_;  ///< for a batch, and …
  std::vector<Contacts> singles_;   ///< … what the first back end says of each
  std::string where_;
  bool counted_ = true;
};

}  // namespace

CaseRun run_case(const Case& c, const Backends& backends, const RunSettings& settings) {
  return Runner(c, backends, settings).run();
}

}  // namespace palpate::equivalence
