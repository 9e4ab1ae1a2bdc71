// Questions about many poses of palpate.h.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "model/contact/response.h"
#include "model/lattice/screw.h"
#include "service/library/open_scene.h"
#include "service/queries/first_contact.h"
#include "service/queries/lone_query.h"
#include "service/queries/portions.h"

using namespace palpate;
using namespace palpate::library;

namespace {

constexpr std::size_t kFew = 16;                 // poses that are not worth more than one thread (chosen)
constexpr std::size_t kMostInAPiece = 16;        // poses that a thread asks between two looks (chosen)
constexpr std::size_t kTouchesAtOnce = 1 << 14;  // poses on the lattice that are held (chosen: a megabyte)

template <class T>
void put(T* column, std::size_t i, T value) {
  if (column) column[i] = value;
}

void put(double* column, std::size_t i, const Vec3& v) {
  if (column)
    for (int k = 0; k < 3; ++k) column[3 * i + static_cast<std::size_t>(k)] = v[k];
}

void put(double* column, std::size_t i, const Pose& pose) {
  const auto& [p, q] = pose;
  if (column) std::ranges::copy(std::array{p.x, p.y, p.z, q.x, q.y, q.z, q.w}, column + 7 * i);
}

std::uint32_t length(const std::vector<std::uint32_t>& list) {
  return static_cast<std::uint32_t>(list.size());
}

/// What poses are answered with, kept from piece to piece so that lists keep their memory.
struct Scratch {
  std::vector<Contacts> contacts;
  std::vector<ContactResponse> responses;
  std::vector<LatticePose> lattice;
  std::vector<Contacts*> answers;
  std::vector<ContactResponse*> told;
  std::optional<LoneQueries> balances;
};

/// Asks the engine for poses and writes what it says into columns.
class ColumnsOf {
 public:
  ColumnsOf(const LoadedScene& scene, const palpate_columns& columns)
      : geometry_(scene.geometry),
        settings_(scene.scene.response),
        to_(columns),
        balance_(settings_.profile == Profile::kRefined &&
                 (to_.force || to_.torque || to_.tool || to_.evaluations)) {}

  /// Of poses that follow each other, the first of which is number `first`.
  Result<void> answer(PoseQuery& asked, std::span<const Pose> poses, std::size_t first, Scratch& with) const {
    const std::size_t count = poses.size();
    with.contacts.resize(std::max(with.contacts.size(), count));
    with.responses.resize(std::max(with.responses.size(), count));
    with.lattice.clear();
    with.answers.clear();
    with.told.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const auto lattice = to_lattice(poses[i], geometry_);
      if (!lattice) return lattice.error();
      with.lattice.push_back(*lattice);
      with.answers.push_back(&with.contacts[i]);
      with.told.push_back(&with.responses[i]);
    }
    if (auto done = asked.query_together(with.lattice, with.answers); !done) return done;
    for (std::size_t i = 0; i < count; ++i)
      respond(with.contacts[i], with.lattice[i], geometry_, settings_.profile, settings_.stiffness_n_per_m,
              with.responses[i]);
    if (balance_) {
      if (!with.balances) with.balances.emplace(geometry_, settings_.stiffness_n_per_m);
      if (auto felt = with.balances->feel(asked, poses, with.told); !felt) return felt;
    }
    for (std::size_t i = 0; i < count; ++i) write(with.contacts[i], with.responses[i], poses[i], first + i);
    return {};
  }

 private:
  double depth(const Contacts& contacts, const ContactResponse& response) const {
    if (settings_.profile == Profile::kRefined) return contacts.field.max_depth * geometry_.lattice.step_m;
    double deepest = 0;
    for (const AreaResponse& area : response.areas) deepest = std::max(deepest, area.max_depth);
    return deepest;
  }

  void write(const Contacts& contacts, const ContactResponse& response, const Pose& pose,
             std::size_t i) const {
    put(to_.contact, i, std::uint8_t{contacts.contact});
    put(to_.pairs, i, contacts.pairs);
    put(to_.cst, i, length(contacts.cst));
    put(to_.bst, i, length(contacts.bst));
    put(to_.cmt, i, length(contacts.cmt));
    put(to_.bmt, i, length(contacts.bmt));
    put(to_.imt, i, length(contacts.imt));
    put(to_.est, i, length(contacts.est));
    put(to_.areas, i, static_cast<std::uint32_t>(contacts.areas.size()));
    put(to_.depth, i, depth(contacts, response));
    const bool deep = contacts.field.max_depth > 0;
    put(to_.deepest_static, i, deep ? contacts.field.deepest_static : kNoTriangle);
    put(to_.deepest_mobile, i, deep ? contacts.field.deepest_mobile : kNoTriangle);
    put(to_.force, i, response.told().force);
    put(to_.torque, i, response.told().torque);
    put(to_.tool, i, response.felt ? response.felt->tool : pose);
    put(to_.evaluations, i, response.felt ? static_cast<std::uint32_t>(response.felt->evaluations) : 1u);
    put(to_.flags, i, response.flags);
    put(to_.truncated, i, std::uint8_t{contacts.truncated});
    put(to_.engine, i, engine_code(contacts.engine));
  }

  const SceneGeometry& geometry_;
  const ResponseSettings& settings_;
  const palpate_columns to_;
  const bool balance_;
};

/// Hands out what a piece needs, so that as many are made as pieces are worked on at once.
class ScratchPool {
 public:
  std::unique_ptr<Scratch> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Scratch>();
    auto out = std::move(free_.back());
    free_.pop_back();
    return out;
  }
  void give(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

Error stopped(std::size_t done, std::size_t count) {
  return {ErrorCode::kInternal, fmt::format("cancelled after {} of {} poses", done, count)};
}

/// Ends a piece between two of its questions once the watch says so: a piece that asks for many poses at a
/// time is long.
class HeedingQuery final : public PoseQuery {
 public:
  /// `done` of `count` poses are answered; it goes on to count.
  HeedingQuery(PoseQuery& asked, const Watch& watch, const std::atomic<std::size_t>& done, std::size_t count)
      : asked_(asked), watch_(watch), done_(done), count_(count) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    return watch_.cancelled() ? stopped(done_, count_) : asked_.query(pose, ignored, out);
  }
  Result<void> query_together(std::span<const LatticePose> poses, std::span<Contacts* const> out) override {
    return watch_.cancelled() ? stopped(done_, count_) : asked_.query_together(poses, out);
  }

 private:
  PoseQuery& asked_;
  const Watch& watch_;
  const std::atomic<std::size_t>& done_;
  const std::size_t count_;
};

/// The questions of docs/EXACTNESS.md section 10 are defined for `refined`.
Result<void> verdicts_allowed(const palpate_scene& scene, double tolerance) {
  if (scene.hosted().plan.plan.profile != Profile::kRefined)
    return wrong_call("the scene is in profile paper: open it with profile refined for this question");
  if (!(tolerance >= 0) || tolerance == std::numeric_limits<double>::infinity())
    return bad_value(fmt::format("the tolerance is {} m; it must be a number of 0 or more", tolerance));
  if (tolerance > 0 && scene.geometry().contact_samples != 0)
    return wrong_call("a tolerance needs a scene that was opened with all samples");
  return {};
}

Result<void> given(const palpate_scene* scene, const void* poses, const void* columns, std::size_t count,
                   const Watch& watch) {
  if (!scene || (count > 0 && (!poses || !columns)))
    return wrong_call("the scene, the poses or the columns are null");
  return watch.usable();
}

/// Whether poses touch under the rule.
Result<void> touches(CollisionBackend& backend, const SceneGeometry& geometry, const double* poses,
                     std::size_t count, const TouchRule& rule, std::uint8_t* bits, Watch& watch) {
  std::vector<LatticePose> lattice;
  for (Portions portions(count, kTouchesAtOnce); portions.next();) {
    const std::size_t first = portions.first(), now = portions.count();
    if (!watch.tell("poses", static_cast<double>(first) / static_cast<double>(count)))
      return stopped(first, count);
    lattice.clear();
    for (std::size_t i = first; i < first + now; ++i) {
      const auto pose = pose_at(poses, i);
      if (!pose) return pose.error();
      const auto at = to_lattice(*pose, geometry);
      if (!at) return at.error();
      lattice.push_back(*at);
    }
    const std::span<std::uint8_t> answers(bits + first, now);
    if (auto done = backend.touches(lattice, answers); !done) return done;
    if (rule.tolerance == 0) continue;
    for (std::size_t i = 0; i < now; ++i) {
      if (answers[i] == 0) continue;
      if (watch.cancelled()) return stopped(first + i, count);
      const auto touch = touch_at(backend, lattice[i], rule);
      if (!touch) return touch.error();
      answers[i] = touch->touches ? 1 : 0;
    }
  }
  return {};
}

/// Looks at the watch between two of `count` pieces.
std::function<Result<void>(std::size_t)> looking(Watch& watch, const char* what, std::size_t count) {
  return [&watch, what, count](std::size_t done) -> Result<void> {
    if (watch.tell(what, static_cast<double>(done) / static_cast<double>(count))) return {};
    return stopped(done, count);
  };
}

/// Ends a search that asks an engine again and again once the watch says so.
class WatchedBackend final : public CollisionBackend {
 public:
  WatchedBackend(CollisionBackend& asked, const Watch& watch) : asked_(asked), watch_(watch) {}
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override {
    return Error{ErrorCode::kInternal, "a watched engine is prepared already"};
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    return watch_.cancelled() ? stopped(0, 1) : asked_.query(pose, ignored, out);
  }
  Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) override {
    return watch_.cancelled() ? stopped(0, 1) : asked_.touches(poses, bits);
  }
  Result<void> clearance(const LatticePose& pose, std::int32_t within, Clearance& out) override {
    return watch_.cancelled() ? stopped(0, 1) : asked_.clearance(pose, within, out);
  }
  Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out) override {
    return watch_.cancelled() ? stopped(0, 1) : asked_.free_time(pose, motion, time, out);
  }
  Result<VoxelPartition> partition(bool tool) const override { return asked_.partition(tool); }
  bool has_internal_voxels() const override { return asked_.has_internal_voxels(); }
  std::string name() const override { return asked_.name(); }
  std::string device() const override { return asked_.device(); }
  std::uint64_t memory_bytes() const override { return asked_.memory_bytes(); }

 private:
  CollisionBackend& asked_;
  const Watch& watch_;
};

}  // namespace

std::int32_t palpate_query(palpate_scene* scene, const double* poses, std::size_t count,
                           const palpate_columns* columns, const palpate_watch* watch,
                           palpate_error** error) {
  Watch watching(watch);
  return guarded(error, &watching, [&]() -> Result<void> {
    if (auto fine = given(scene, poses, columns, count, watching); !fine) return fine;
    const auto known = taken(columns, "palpate_columns");
    if (!known) return known.error();
    const ColumnsOf to(scene->hosted().loaded, *known);
    ScratchPool pool;
    std::atomic<std::size_t> done{0};
    const auto caller = std::this_thread::get_id();
    std::size_t piece = 1, together = 1;
    const PoseWork work = [&](PoseQuery& asked, std::size_t number) -> Result<void> {
      const std::size_t first = number * piece, last = std::min(first + piece, count);
      const bool go_on =
          std::this_thread::get_id() == caller
              ? watching.tell("poses", std::min(1.0, static_cast<double>(done) / static_cast<double>(count)))
              : !watching.cancelled();
      if (!go_on) return stopped(done, count);
      auto scratch = pool.take();
      HeedingQuery heeded(asked, watching, done, count);
      std::vector<Pose> wanted;
      for (std::size_t i = first; i < last; i += wanted.size()) {
        wanted.clear();
        while (wanted.size() < std::min(together, last - i)) {
          const auto pose = pose_at(poses, i + wanted.size());
          if (!pose) return pose.error();
          wanted.push_back(*pose);
        }
        if (auto answered = to.answer(heeded, wanted, i, *scratch); !answered) return answered;
      }
      done += last - first;
      pool.give(std::move(scratch));
      return {};
    };
    const auto all = [&](CollisionBackend& backend) {
      together = backend.poses_together(count);
      piece = std::max(together, std::clamp<std::size_t>(count / 64, 1, kMostInAPiece));
      return backend.share((count + piece - 1) / piece, work);
    };
    return count <= kFew ? scene->ask_any(all) : scene->ask(all);
  });
}

std::int32_t palpate_touches(palpate_scene* scene, const double* poses, std::size_t count, double tolerance,
                             std::uint8_t* bits, const palpate_watch* watch, palpate_error** error) {
  Watch watching(watch);
  return guarded(error, &watching, [&]() -> Result<void> {
    if (auto fine = given(scene, poses, bits, count, watching); !fine) return fine;
    if (auto fine = verdicts_allowed(*scene, tolerance); !fine) return fine;
    const SceneGeometry& geometry = scene->geometry();
    const auto all = [&](CollisionBackend& backend) {
      return touches(backend, geometry, poses, count, TouchRule::of(geometry, tolerance), bits, watching);
    };
    return count <= kFew ? scene->ask_any(all) : scene->ask(all);
  });
}

std::int32_t palpate_clearance(palpate_scene* scene, const double* poses, std::size_t count, double within,
                               const palpate_distances* columns, const palpate_watch* watch,
                               palpate_error** error) {
  Watch watching(watch);
  return guarded(error, &watching, [&]() -> Result<void> {
    if (auto fine = given(scene, poses, columns, count, watching); !fine) return fine;
    if (auto fine = verdicts_allowed(*scene, 0); !fine) return fine;
    if (!(within >= 0)) return bad_value(fmt::format("`within` is {} m; it must be 0 or more", within));
    const auto known = taken(columns, "palpate_distances");
    if (!known) return known.error();
    const palpate_distances& to = *known;
    const SceneGeometry& geometry = scene->geometry();
    const double step = geometry.lattice.step_m;
    const auto reach = within == std::numeric_limits<double>::infinity()
                           ? INT32_MAX - 2
                           : static_cast<std::int32_t>(std::min(within / step, 0x1p30));
    const auto place = [&](const Int3& at) { return geometry.lattice.origin_m + step * Vec3(at); };
    constexpr double kInfinite = std::numeric_limits<double>::infinity(),
                     kNone = std::numeric_limits<double>::quiet_NaN();
    const auto measure = [&](CollisionBackend& backend, std::size_t i) -> Result<void> {
      const auto pose = pose_at(poses, i);
      if (!pose) return pose.error();
      const auto lattice = to_lattice(*pose, geometry);
      if (!lattice) return lattice.error();
      Clearance found;
      if (auto done = backend.clearance(*lattice, reach, found); !done) return done;
      const bool apart = found.kind == Clearance::Kind::kApart;
      put(to.distance, i,
          apart                                      ? found.steps * step
          : found.kind == Clearance::Kind::kTouching ? 0
                                                     : kInfinite);
      put(to.static_id, i, apart ? found.static_id : kNoTriangle);
      put(to.mobile_id, i, apart ? found.mobile_id : kNoTriangle);
      put(to.on_static, i, apart ? place(found.on_static) : Vec3(kNone));
      put(to.on_mobile, i, apart ? place(found.on_mobile) : Vec3(kNone));
      put(to.engine, i, engine_code(backend.measured_by()));
      return {};
    };
    return scene->ask_side_by_side(count, measure, looking(watching, "poses", count));
  });
}

std::int32_t palpate_first_contact(palpate_scene* scene, const double* from, const double* to,
                                   std::size_t count, double tolerance, const palpate_motions* columns,
                                   const palpate_watch* watch, palpate_error** error) {
  Watch watching(watch);
  return guarded(error, &watching, [&]() -> Result<void> {
    if (auto fine = given(scene, from, columns, count, watching); !fine) return fine;
    if (count > 0 && !to) return wrong_call("the poses that motions go to are null");
    if (auto fine = verdicts_allowed(*scene, tolerance); !fine) return fine;
    const auto known = taken(columns, "palpate_motions");
    if (!known) return known.error();
    const palpate_motions& out = *known;
    const SceneGeometry& geometry = scene->geometry();
    const TouchRule rule = TouchRule::of(geometry, tolerance);
    const auto move = [&](CollisionBackend& backend, std::size_t i) -> Result<void> {
      const auto begin = pose_at(from, i), end = pose_at(to, i);
      if (!begin) return begin.error();
      if (!end) return end.error();
      WatchedBackend watched(backend, watching);
      const auto found = first_contact(watched, geometry, *begin, *end, rule);
      if (!found) return found.error();
      const auto kind = found->kind == FirstContact::Kind::kNone      ? PALPATE_MOTION_CLEAR
                        : found->kind == FirstContact::Kind::kContact ? PALPATE_MOTION_CONTACT
                                                                      : PALPATE_MOTION_UNDECIDED;
      put(out.kind, i, static_cast<std::uint8_t>(kind));
      put(out.time, i, found->time);
      if (out.pose)
        put(out.pose, i,
            found->time == 0   ? *begin
            : found->time == 1 ? *end
                               : Screw(*begin, *end, geometry).at(found->time));
      put(out.distance, i, found->steps * geometry.lattice.step_m);
      put(out.static_id, i, found->static_id);
      put(out.mobile_id, i, found->mobile_id);
      put(out.evaluations, i, found->evaluations);
      put(out.engine, i, engine_code(backend.measured_by()));
      return {};
    };
    return scene->ask_side_by_side(count, move, looking(watching, "motions", count));
  });
}
