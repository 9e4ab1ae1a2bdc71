// `palpate bench error`: error of the response against the time of a frame, for every knob, against closed
// forms and converged runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>

#include "model/scene/geometry_build.h"
#include "service/bench/bench.h"
#include "service/bench/error/error_apart.h"
#include "service/bench/error/error_charts.h"
#include "service/bench/error/error_findings.h"
#include "service/bench/error/error_sweep.h"
#include "service/bench/force/force_cases.h"
#include "service/bench/output.h"
#include "service/bench/scene_subject.h"
#include "service/cli/numbers.h"
#include "service/cli/scene_host.h"

namespace palpate {
namespace {

constexpr double kConverged = 48;  ///< of a voxel: samples of a run that stands in for a closed form lie so
                                   ///< close (chosen: three times as close as the closest that is judged)
constexpr std::uint32_t kSampleCounts[] = {32, 64, 128, 256, 512, 1024, 2048};  ///< a contact; 1024 is usual
constexpr double kVoxelTimes[] = {2.0, 1.4, 1.0, 0.7, 0.5, 0.35};               ///< of the scene's own
constexpr int kCuts = 6;  ///< finenesses of the mock-up in `paper`
constexpr double kMostFiner = 16, kAnyTriangles = 40'000,
                 kMostTriangles = 600'000;  ///< of the finest: times the mock-up's own, but so many in any
                                            ///< case, and no more than so many (chosen: minutes)
constexpr std::uint64_t kAskedPoses = 200;  ///< of a path or file, to find those in contact (chosen)
constexpr double kTruthTriangles = 2;       ///< times the finest: paper's own truth

/// Cases of `bench force` whose force has no closed form for its size.
constexpr const char* kForceCases[] = {"peg of 96 sides off centre askew, play 0.3 mm", "plate on to 4 pads",
                                       "plate on six waves", "plate of 2 mm pierced"};

using Truths = std::vector<std::optional<ContactTruth>>;

ErrorSetting spacing(const GeometrySettings& base, double value) {
  ErrorSetting setting{Profile::kRefined, "sample_spacing", value, base};
  setting.geometry.sample_spacing_m = value;
  setting.geometry.contact_samples =
      0;  // all of them: else a large contact would be sampled as coarsely as before
  return setting;
}

ErrorSetting voxels(Profile profile, const GeometrySettings& base, double value,
                    std::optional<double> sample_spacing) {
  ErrorSetting setting{profile, "voxel_size", value, base};
  setting.geometry.voxel_size_m = value;
  setting.geometry.sample_spacing_m = sample_spacing;
  return setting;
}

/// The program's own spacing, and about so many samples a contact.
ErrorSetting samples(const GeometrySettings& base, std::uint32_t count) {
  ErrorSetting setting{Profile::kRefined, "contact_samples", static_cast<double>(count), base};
  setting.geometry.contact_samples = count;
  return setting;
}

/// The mock-up cut so fine.
ErrorSetting cut(const GeometrySettings& base, double voxel, std::uint64_t triangles) {
  ErrorSetting setting = voxels(Profile::kPaper, base, voxel, std::nullopt);
  setting.knob = "triangles";
  setting.value = static_cast<double>(triangles);
  setting.triangles = triangles;
  return setting;
}

/// Every so manyeth, `count` at most.
template <class T>
std::vector<T> thinned(const std::vector<T>& all, std::size_t count) {
  if (all.size() <= count) return all;
  std::vector<T> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(all[i * all.size() / count]);
  return out;
}

Answered part_of(const Answered& all, std::size_t first, std::size_t count) {
  const auto cut_out = [&](const auto& from) {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
    return std::decay_t<decltype(from)>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  return {cut_out(all.answers), cut_out(all.times_us), cut_out(all.all_us), all.samples, all.work};
}

std::size_t contacts_of(const Truths& truths) {
  return static_cast<std::size_t>(
      std::count_if(truths.begin(), truths.end(), [](const auto& truth) { return truth.has_value(); }));
}

std::vector<double> sizes_of(const Truths& truths, std::size_t quantity) {
  std::vector<double> out;
  for (const auto& truth : truths)
    if (truth)
      out.push_back(quantity == 0   ? truth->depth
                    : quantity == 3 ? glm::length(truth->wrench.force)
                    : quantity == 4 ? glm::length(truth->wrench.torque)
                                    : 0.0);
  return out;
}

/// Poses of a subject that belong together, and what is judged at them.
struct PoseSet {
  std::string name;  ///< of the subject and of these poses
  std::size_t first = 0, count = 0;
  Truths truths, paper_truths;  ///< of `refined` and of `paper`
  ErrorTruths about;
  std::vector<ErrorCurves> curves;
};

class ErrorBench {
 public:
  ErrorBench(const BenchOptions& options, const Parts& parts) : options_(options), parts_(parts) {}

  Result<void> run() {
    if (options_.scenes_only && options_.scenes.empty())
      return Error{ErrorCode::kUsage, "--scenes-only goes with a scene"};
    facts_.more.emplace_back("load average", fmt::format("{:.1f} at the start", load_average()));
    facts_.more.emplace_back(
        "clock", options_.cpu_clock ? "this process's own time, of all its threads" : "the wall's");
    if (auto done = find_engines(); !done) return done;
    // What one subject lacks, or an interruption, does not lose what the others have told.
    std::optional<Error> failed;
    const auto take = [&](const std::string& name, const Result<void>& done) {
      if (done || interrupted()) return;
      failed = done.error();
      console_.note(failed->sentence);
      facts_.more.emplace_back("left out: " + name, failed->sentence);
    };
    if (!options_.scenes_only) {
      take("closed forms", closed_forms());
      if (!options_.quick)
        for (const char* name : kForceCases)
          if (!interrupted()) take(name, force_case(name));
    }
    for (const std::string& scene : options_.scenes)
      if (!interrupted()) take(scene, scene_file(scene));
    if (failed && table_.rows.empty()) return Error{failed->code, "so nothing was measured"};
    for (const auto& [engine, leads] : leads_)
      facts_.findings.emplace(facts_.findings.begin(), "", lead_summary(engine, leads));
    if (!options_.scenes_only && !interrupted()) {
      ErrorApart apart{table_, charts_, facts_};
      apart.tessellation();
      apart.control();
      if (auto done = apart.lattice_step(*engines_.front().backend, options_.cpu_clock, console_);
          !done && !interrupted())
        return done;
    }
    facts_.more.emplace_back("left out",
                             "poses without contact; preparation and first-run compilation, which no time "
                             "here holds; errors of 0, for which a logarithm has no place; "
                             "settings that a back end refuses (each with its reason); control over real "
                             "queries (bench stability has it)");
    console_.finish();
    if (interrupted()) {
      if (table_.rows.empty()) return Error{ErrorCode::kInternal, "interrupted"};
      facts_.more.emplace_back("interrupted", "before all subjects were measured; these are whole");
    }
    return write_bench(options_.out, facts_, table_, charts_);
  }

 private:
  struct Engine {
    std::string name;
    std::unique_ptr<CollisionBackend> backend;
    bool paper = false;  ///< answers `paper` itself
  };

  /// Without a choice the native engine, and beside it one that answers `paper`, so that both methods are
  /// compared on one engine: the device's if there is any, else the reference.
  Result<void> find_engines() {
    std::vector<std::string> names = options_.backends;
    const bool chosen = !names.empty() && names.front() != "auto";
    if (!chosen) names = {"cpu", "gpu"};
    for (const std::string& name : names) {
      auto made = choose_backend(name, std::nullopt, parts_, console_);
      if (!made && !chosen && name == "gpu") {
        facts_.more.emplace_back("paper", made.error().sentence + ": the engine ref answers it");
        made = choose_backend("ref", std::nullopt, parts_, console_);
      }
      if (!made) return made.error();
      const std::string own = (*made)->name();
      facts_.add_device(device_text(**made, parts_));
      engines_.push_back({own, std::move(*made), own != "cpu"});
    }
    return {};
  }

  Engine* paper_engine() {
    const auto found =
        std::find_if(engines_.begin(), engines_.end(), [](const Engine& engine) { return engine.paper; });
    return found == engines_.end() ? nullptr : &*found;
  }

  static ErrorTruths truths_of(const PoseSet& set, const std::string& about,
                               std::optional<double> spacing_m) {
    ErrorTruths out{.about = about, .spacing_m = spacing_m};
    for (std::size_t q = 0; q < kErrorQuantities.size(); ++q) {
      const std::vector<double> refined = sizes_of(set.truths, q), paper = sizes_of(set.paper_truths, q);
      out.largest[q] = percentile(refined, 1);
      out.typical[0][q] = percentile(refined, 0.5);
      out.typical[1][q] = percentile(paper, 0.5);
    }
    return out;
  }

  Result<void> closed_forms() {
    std::vector<ErrorSubject> coarse = closed_form_subjects(1);
    const auto fewer = [this](std::vector<ErrorSubject>& subjects) {
      if (options_.quick) subjects.erase(subjects.begin() + 1), subjects.pop_back();
      for (ErrorSubject& subject : subjects)
        subject.poses = thinned(subject.poses, options_.quick ? 8 : options_.frames);
    };
    fewer(coarse);
    const double converged_part = options_.quick ? 12 : kConverged;
    std::vector<PoseSet> all(coarse.size());
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      const double voxel = *coarse[k].settings.voxel_size_m;
      PoseSet& set = all[k];
      set.name = coarse[k].name, set.count = coarse[k].poses.size();
      std::optional<double> stand_in;
      for (const Pose& pose : coarse[k].poses) set.paper_truths.emplace_back(coarse[k].truth(pose));
      if (coarse[k].field_truth) {
        for (const Pose& pose : coarse[k].poses) set.truths.emplace_back(coarse[k].field_truth(pose));
      } else {
        const auto converged =
            answers(coarse[k], spacing(coarse[k].settings, voxel / converged_part), engines_.front());
        if (!converged) return converged.error();
        set.truths = converged->answers;
        stand_in = voxel / converged_part;
      }
      const std::string about = fmt::format(
          "{}; paper is judged against its closed form, refined against {}; d of the triangles themselves is "
          "off by {:.2g} of d at most",
          coarse[k].about,
          stand_in ? fmt::format("itself at a spacing of {:.3g} mm", 1000 * *stand_in) : "the field's",
          coarse[k].tessellation_error);
      facts_.more.emplace_back(coarse[k].name, about);
      set.about = truths_of(set, about, stand_in);
      std::vector<ErrorSetting> settings;
      const std::vector<double> parts = options_.quick ? std::vector<double>{1, 1.5, 2, 3, 4, 6}
                                                       : std::vector<double>{1, 1.5, 2, 3, 4, 6, 8, 12, 16};
      settings.reserve(parts.size());
      for (const double part : parts) settings.push_back(spacing(coarse[k].settings, voxel / part));
      if (!options_.quick) {
        for (const double times : kVoxelTimes)
          settings.push_back(voxels(Profile::kRefined, coarse[k].settings, voxel * times, voxel / 4));
        for (const std::uint32_t count : kSampleCounts)
          settings.push_back(samples(coarse[k].settings, count));
      }
      for (Engine& engine : engines_) {
        set.curves.push_back({engine.name, {}});
        if (auto done = measure(coarse[k], settings, engine, std::span(&set, 1)); !done) return done;
      }
    }
    // The chapter's knob is the tessellation: its samples are centroids. The ball in a ball has its own
    // triangles.
    const std::vector<std::pair<int, std::uint64_t>> meshes = {{1, 2'500},   {4, 5'000},   {12, 10'000},
                                                               {36, 20'000}, {72, 40'000}, {108, 80'000}};
    for (std::size_t e = 0; e < engines_.size(); ++e) {
      if (!engines_[e].paper) continue;
      for (const auto& [cells, triangles] : meshes) {
        std::vector<ErrorSubject> fine = closed_form_subjects(cells, triangles);
        fewer(fine);
        for (std::size_t k = 0; k < fine.size(); ++k) {
          std::vector<ErrorSetting> settings{{Profile::kPaper, "triangles",
                                              static_cast<double>(fine[k].meshes.mockup.triangles.size()),
                                              fine[k].settings}};
          if (cells == 36 && !options_.quick)
            for (const double times : kVoxelTimes)
              settings.push_back(voxels(Profile::kPaper, fine[k].settings,
                                        times * *fine[k].settings.voxel_size_m, std::nullopt));
          if (auto done = measure(fine[k], settings, engines_[e], std::span(&all[k], 1), e); !done)
            return done;
        }
      }
    }
    for (PoseSet& set : all) report(set);
    return {};
  }

  /// A case of the judge of forces, at poses of its path.
  Result<void> force_case(const std::string& name) {
    const std::vector<ForceCaseMaker> makers = force_cases();
    const auto maker =
        std::find_if(makers.begin(), makers.end(), [&](const ForceCaseMaker& m) { return m.name == name; });
    if (maker == makers.end()) return Error{ErrorCode::kInternal, "no case of bench force: " + name};
    ForceCase made = maker->make();
    ErrorSubject subject;
    subject.name = name;
    subject.meshes = {std::move(made.mockup), std::move(made.tool)};
    if (made.voxel_m > 0) subject.settings.voxel_size_m = made.voxel_m;
    subject.stiffness_n_per_m = kForceStiffness;
    const Result<SceneGeometry> geometry =
        build_geometry(subject.meshes.mockup, subject.meshes.tool, subject.settings);
    if (!geometry) return geometry.error();
    const double step = geometry->lattice.step_m, voxel = geometry->mockup_grid.size * step;
    subject.settings.voxel_size_m = voxel;
    subject.settings.sample_spacing_m = geometry->sample_spacing * step;
    subject.poses = std::move(made.path);
    return converged_subject(subject, {{name, 0, subject.poses.size(), {}, {}, {}, {}}}, voxel);
  }

  /// A hand's poses and, apart, the path's, which are deeper than a hand gets; or those of a file:
  /// "scene.json=poses.csv".
  Result<void> scene_file(const std::string& text) {
    const std::size_t sign = text.find('=');
    const std::string file = text.substr(0, sign),
                      own = sign == std::string::npos ? options_.poses : text.substr(sign + 1);
    BenchOptions options = options_;
    options.poses = own;
    options.frames = kAskedPoses;
    const bool both = own.empty() && !options_.quick;
    if (both) options.poses = "run";
    auto read = scene_subject(file, options, engines_.front().name, parts_, console_);
    if (!read) return read.error();
    ErrorSubject& subject = read->subject;
    const std::string name = subject.name;
    std::vector<PoseSet> sets{
        {both ? name + ", hand's poses" : name, 0, subject.poses.size(), {}, {}, {}, {}}};
    if (both) {
      options.poses.clear();
      auto path = scene_subject(file, options, engines_.front().name, parts_, console_);
      if (!path) return path.error();
      sets.push_back(
          {name + ", path's depths", subject.poses.size(), path->subject.poses.size(), {}, {}, {}, {}});
      subject.poses.insert(subject.poses.end(), path->subject.poses.begin(), path->subject.poses.end());
    }
    return converged_subject(subject, std::move(sets), read->voxel_m);
  }

  /// A subject without closed forms: each method is judged against itself, converged.
  Result<void> converged_subject(ErrorSubject subject, std::vector<PoseSet> sets, double voxel) {
    if (auto done = keep_touching(subject, sets, voxel); !done) return done;
    const auto converged = answers(subject, spacing(subject.settings, voxel / 16), engines_.front());
    if (!converged) return converged.error();
    Engine* paper_by = options_.quick ? nullptr : paper_engine();
    const auto own = static_cast<double>(subject.meshes.mockup.triangles.size());
    const double finest = std::max(own, std::min(kMostTriangles, std::max(kMostFiner * own, kAnyTriangles)));
    std::optional<Answered> paper_truth;
    if (paper_by != nullptr) {
      const auto answered =
          answers(subject, cut(subject.settings, voxel, static_cast<std::uint64_t>(kTruthTriangles * finest)),
                  *paper_by);
      if (!answered && interrupted()) return answered.error();
      if (answered)
        paper_truth = *answered;
      else
        facts_.more.emplace_back("left out of " + subject.name, "paper: " + answered.error().sentence);
    }
    std::vector<PoseSet> touched;
    for (PoseSet& set : sets) {
      set.truths = part_of(*converged, set.first, set.count).answers;
      if (paper_truth) set.paper_truths = part_of(*paper_truth, set.first, set.count).answers;
      const std::size_t in_contact = contacts_of(set.truths);
      if (in_contact == 0) {
        facts_.more.emplace_back("left out of " + set.name, "none of its poses has a contact that pushes");
        continue;
      }
      const std::string about = fmt::format(
          "{} of {} poses in contact; refined is judged against itself at a spacing of {:.3g} mm{}",
          in_contact, set.count, 1000 * voxel / 16,
          paper_truth ? fmt::format(", paper against itself with its mock-up cut into {} triangles",
                                    count_text(static_cast<std::uint64_t>(kTruthTriangles * finest)))
                      : std::string());
      facts_.more.emplace_back(set.name, about);
      set.about = truths_of(set, about, voxel / 16);
      touched.push_back(std::move(set));
    }
    if (touched.empty())
      return bad_value(fmt::format("{}: none of its poses has a contact that pushes", subject.name));

    std::vector<ErrorSetting> settings, paper;
    for (const double part : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0})
      settings.push_back(spacing(subject.settings, voxel / part));
    if (!options_.quick) {
      for (const double times : kVoxelTimes) {
        settings.push_back(
            voxels(Profile::kRefined, subject.settings, voxel * times, subject.settings.sample_spacing_m));
        paper.push_back(voxels(Profile::kPaper, subject.settings, voxel * times, std::nullopt));
      }
      for (const std::uint32_t count : kSampleCounts) settings.push_back(samples(subject.settings, count));
      for (int i = 0; i < kCuts; ++i)
        paper.push_back(cut(subject.settings, voxel,
                            static_cast<std::uint64_t>(own * std::pow(finest / own, i / (kCuts - 1.0)))));
    }
    for (Engine& engine : engines_) {
      for (PoseSet& set : touched) set.curves.push_back({engine.name, {}});
      if (auto done = measure(subject, settings, engine, touched); !done) return done;
      if (engine.paper && paper_truth)
        if (auto done = measure(subject, paper, engine, touched); !done) return done;
    }
    for (PoseSet& set : touched) report(set);
    return {};
  }

  /// Leaves of each set as many poses in contact as were asked for, evenly.
  Result<void> keep_touching(ErrorSubject& subject, std::vector<PoseSet>& sets, double voxel) {
    const auto asked = answers(
        subject, voxels(Profile::kRefined, subject.settings, voxel, subject.settings.sample_spacing_m),
        engines_.front());
    if (!asked) return asked.error();
    std::vector<Pose> kept;
    for (PoseSet& set : sets) {
      std::vector<Pose> touching;
      for (std::size_t i = set.first; i < set.first + set.count; ++i)
        if (asked->answers[i]) touching.push_back(subject.poses[i]);
      touching = thinned(touching, options_.frames);
      set.first = kept.size(), set.count = touching.size();
      kept.insert(kept.end(), touching.begin(), touching.end());
    }
    if (kept.empty())
      return bad_value(fmt::format("{}: none of the {} poses has a contact that pushes", subject.name,
                                   subject.poses.size()));
    subject.poses = std::move(kept);
    return {};
  }

  Result<Answered> answers(const ErrorSubject& subject, const ErrorSetting& setting, Engine& engine) {
    console_.step(fmt::format("{}: {} {} {:.4g}, {}", subject.name,
                              setting.profile == Profile::kPaper ? "paper" : "refined", setting.knob,
                              setting.value, engine.name));
    auto answered = answer_all(
        subject, setting, options_.quick ? 1 : options_.rounds, *engine.backend,
        [this](const char* what, double done) { return console_.progress(what, done); }, options_.cpu_clock);
    for (const std::string& note : engine.backend->take_notes())  // who answered is part of what a time means
      facts_.more.emplace_back(fmt::format("{}, {} {:.4g}", subject.name, setting.knob, setting.value), note);
    return answered;
  }

  /// Adds a point a setting to the newest curves of each set, or to those of a number.
  Result<void> measure(const ErrorSubject& subject, const std::vector<ErrorSetting>& settings, Engine& engine,
                       std::span<PoseSet> sets, std::optional<std::size_t> curves = {}) {
    for (const ErrorSetting& setting : settings) {
      const auto answered = answers(subject, setting, engine);
      if (!answered) {
        if (interrupted()) return answered.error();
        console_.note(answered.error().sentence + "; this setting is left out");
        facts_.more.emplace_back("left out of " + subject.name, answered.error().sentence);
        continue;
      }
      for (PoseSet& set : sets)
        (curves ? set.curves[*curves] : set.curves.back())
            .points.push_back(
                {setting, judge(part_of(*answered, set.first, set.count),
                                setting.profile == Profile::kPaper ? set.paper_truths : set.truths)});
    }
    return {};
  }

  void report(const PoseSet& set) {
    for (const ErrorCurves& curves : set.curves) {
      for (const ErrorPoint& point : curves.points) {
        const double p50 = percentile(point.result.times_us, 0.5),
                     p99 = percentile(point.result.times_us, 0.99);
        const std::size_t method = point.setting.profile == Profile::kPaper ? 1 : 0;
        for (std::size_t q = 0; q < kErrorQuantities.size(); ++q) {
          table_.rows.push_back(
              {set.name, kMethods[method], point.setting.knob, point.setting.value, kErrorQuantities[q],
               percentile(point.result.errors[q], 0.5), percentile(point.result.errors[q], 0.99), p50, p99,
               curves.engine, point.result.times_us.size(), point.result.lost, set.about.typical[method][q]});
          for (BenchCell& cell : work_cells(point.result.work)) table_.rows.back().push_back(std::move(cell));
        }
        if (point.result.lost > 0)
          facts_.more.emplace_back(
              fmt::format("{}, {} {} {:.4g}, {}", set.name, kMethods[method], point.setting.knob,
                          point.setting.value, curves.engine),
              fmt::format("finds nothing at {} of {} poses; their d, F and T count as lost whole",
                          point.result.lost, point.result.times_us.size()));
      }
      for (const std::size_t q : {std::size_t{3}, std::size_t{0}})
        charts_.push_back(error_time_chart(set.name, curves, set.about, q));
      if (judged_by_itself(curves)) {
        facts_.findings.emplace_back(
            set.name,
            "paper is not judged by the engine " + curves.engine +
                ": the triangles that touch are smaller than what its truth cuts, so at half of the "
                "poses or more it would be held against itself.");
        continue;
      }
      const auto lead = lead_of(curves, set.about, 3);
      if (!lead) continue;
      leads_["By one engine, " + curves.engine].emplace_back(set.name, *lead);
      const std::string by = "Force, by the engine " + curves.engine + ": ";
      facts_.findings.emplace_back(set.name, by + lead_sentence(*lead) + ".");
      facts_.findings.emplace_back(
          set.name, by + where_wins(curves, set.about, 3) + " (medians, each method against its own truth).");
      if (const auto of_depth = lead_of(curves, set.about, 0))
        facts_.more.emplace_back(fmt::format("refined against paper in d, {}, {}", set.name, curves.engine),
                                 lead_sentence_of_depth(*of_depth));
    }
    // As this machine has it: each method by the engine that answers it soonest here.
    if (set.curves.size() > 1 && !set.curves.front().points.empty() &&
        std::none_of(set.curves.begin(), set.curves.end(), judged_by_itself)) {
      ErrorCurves each = set.curves.front();
      for (const ErrorCurves& curves : set.curves)
        for (const ErrorPoint& point : curves.points)
          if (point.setting.profile == Profile::kPaper)
            each.points.push_back(point), each.engine = curves.engine;
      if (const auto lead = lead_of(each, set.about, 3))
        leads_[fmt::format("Each by an engine of its own, refined by {} and paper by {}",
                           set.curves.front().engine, each.engine)]
            .emplace_back(set.name, *lead);
    }
    for (const std::size_t q : {std::size_t{3}, std::size_t{0}})
      charts_.push_back(convergence_chart(set.name, set.curves.front(), set.about, q));
    if (set.curves.size() > 1) charts_.push_back(engines_chart(set.name, set.curves));
    std::vector<std::pair<double, double>> curve;
    for (const ErrorPoint& point : set.curves.front().points)
      if (point.setting.knob == "sample_spacing")
        curve.emplace_back(point.setting.value, percentile(point.result.errors[0], 0.5));
    if (const auto fit = fitted_order(curve))
      facts_.more.emplace_back("order of d, " + set.name, order_text(*fit, "spacings"));
  }

  /// Whether a coarser cut than the truth's has its very force at the median: then the truth is none.
  static bool judged_by_itself(const ErrorCurves& curves) {
    return std::any_of(curves.points.begin(), curves.points.end(), [](const ErrorPoint& point) {
      return point.setting.knob == "triangles" && percentile(point.result.errors[3], 0.5) == 0;
    });
  }

  static std::string lead_sentence_of_depth(const MethodLead& lead) {
    return lead.us ? fmt::format(
                         "paper's best median error is {:.3g} m in {:.0f} µs; refined has {:.3g} m in "
                         "{:.0f} µs, {:.1f} times sooner",
                         lead.paper_error, lead.paper_us, *lead.error, *lead.us, lead.factor())
                   : fmt::format("paper's best median error, {:.3g} m in {:.0f} µs, is not reached",
                                 lead.paper_error, lead.paper_us);
  }

  static BenchTable columns() {
    BenchTable table{{"scene", "method", "knob", "value", "quantity", "error_p50", "error_p99", "time_us_p50",
                      "time_us_p99", "engine", "poses", "lost", "truth_p50"},
                     {}};
    table.columns.insert(table.columns.end(), kWorkColumns.begin(), kWorkColumns.end());
    return table;
  }

  static constexpr const char* kMethods[] = {"refined", "paper"};

  const BenchOptions& options_;
  const Parts& parts_;
  Console console_;
  std::vector<Engine> engines_;
  std::map<std::string, std::vector<std::pair<std::string, MethodLead>>>
      leads_;  ///< by engine that knows paper: of each subject and its poses
  BenchFacts facts_{.command = "error", .device = {}, .more = {}};
  BenchTable table_ = columns();
  std::vector<Chart> charts_;
};

}  // namespace

Result<void> bench_error(const BenchOptions& options, const Parts& parts) {
  catch_interrupts();
  return ErrorBench(options, parts).run();
}

}  // namespace palpate
