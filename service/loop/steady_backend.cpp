#include "service/loop/steady_backend.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace palpate {

SteadyBackend::SteadyBackend(std::unique_ptr<CollisionBackend> first, Make make_spare)
    : first_(std::move(first)), make_spare_(std::move(make_spare)) {}

Result<void> SteadyBackend::prepare(const SceneGeometry& geometry, const Plan& plan,
                                    const Progress& progress) {
  geometry_ = &geometry;
  plan_ = plan;
  first_ready_ = spare_ready_ = by_spare_ = false;  // what has been prepared is another scene
  full_.clear();
  if (!first_) return prepare_spare(progress);
  bool cancelled = false;
  const Progress watched = [&](const char* what, double done) {
    return !(cancelled = cancelled || (progress && !progress(what, done)));
  };
  const Result<void> prepared = first_->prepare(geometry, plan, watched);
  first_ready_ = static_cast<bool>(prepared);
  if (prepared || cancelled || !make_spare_) return prepared;
  note("the scene can't be prepared on " + first_->device() + ": " + prepared.error().sentence);
  if (prepared.error().code != ErrorCode::kBadValue)
    first_.reset();  // a scene that it can't take says nothing of the next
  return prepare_spare(progress);
}

Result<void> SteadyBackend::finish_preparing() {
  if (!first_ready_) return spare_ready_ ? spare_->finish_preparing() : Result<void>{};
  const Result<void> finished = first_->finish_preparing();
  if (finished || !make_spare_) return finished;
  first_failed(finished.error());
  return prepare_spare([](const char*, double) { return true; });
}

Result<void> SteadyBackend::replan(const Plan& plan) {
  if (first_ready_)
    if (auto done = first_->replan(plan); !done) return done;
  if (spare_ready_)
    if (auto done = spare_->replan(plan); !done) return done;
  plan_ = plan;
  return {};
}

Result<void> SteadyBackend::prepare_spare(const Progress& progress) {
  if (!spare_) spare_ = make_spare_();
  if (auto prepared = spare_->prepare(*geometry_, plan_, progress); !prepared) return prepared;
  spare_ready_ = true;
  note("the engine " + spare_->name() + " answers instead");
  return {};
}

Result<void> SteadyBackend::ask_first(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  for (;;) {
    if (auto answered = first_->query(pose, ignored, out);
        !answered || !out.truncated || out.truncated_capacity == full_)
      return answered;
    if (auto enlarged = first_->enlarge(); !enlarged) {
      full_ = out.truncated_capacity;
      note(enlarged.error().sentence);
      return {};
    }
    note("a frame had too little room for " + std::string(out.truncated_capacity) +
         ": it was enlarged and the frame asked again");
  }
}

Result<void> SteadyBackend::query(const LatticePose& pose, const Ignored* ignored, Contacts& out) {
  by_spare_ = false;
  if (first_ready_) {
    const Result<void> answered = ask_first(pose, ignored, out);
    // More areas than a frame may have is truncation by definition, whoever answers.
    if (answered && (!out.truncated || std::strcmp(out.truncated_capacity, "areas") == 0)) return answered;
    if (!make_spare_) return answered;
    if (!answered) first_failed(answered.error());
  }
  if (!spare_ready_)
    if (auto prepared = prepare_spare([](const char*, double) { return true; }); !prepared) return prepared;
  by_spare_ = true;
  return spare_->query(pose, ignored, out);
}

namespace {

/// Asks somebody, and notes whether an answer was cut short.
class WatchedQuery final : public PoseQuery {
 public:
  explicit WatchedQuery(PoseQuery& asked) : asked_(asked) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    auto answered = asked_.query(pose, ignored, out);
    truncated |= out.truncated;
    return answered;
  }
  Result<void> query_together(std::span<const LatticePose> poses, std::span<Contacts* const> out) override {
    auto answered = asked_.query_together(poses, out);
    for (const Contacts* one : out) truncated |= one->truncated;
    return answered;
  }
  bool truncated = false;

 private:
  PoseQuery& asked_;
};

}  // namespace

Result<void> SteadyBackend::share(std::size_t count, const PoseWork& work) {
  if (!first_ready_)
    return spare_ready_ ? spare_->share(count, work)
                        : CollisionBackend::share(count, work);  // piece by piece
  // What goes wrong goes wrong again, and is dealt with, piece by piece.
  std::vector<char> again(count, 1);  // a byte each, for several threads
  (void)first_->share(count, [&](PoseQuery& asked, std::size_t i) {
    WatchedQuery watched(asked);
    auto done = work(watched, i);
    again[i] = !done || watched.truncated;
    return done;
  });
  for (std::size_t i = 0; i < count; ++i)
    if (again[i] != 0)
      if (auto done = work(*this, i); !done) return done;
  return {};
}

std::size_t SteadyBackend::poses_together(std::size_t count) {
  if (first_ready_) return first_->poses_together(count);
  return spare_ready_ ? spare_->poses_together(count) : 1;
}

Result<void> SteadyBackend::query_batch(std::span<const LatticePose> poses, std::span<Contacts> out) {
  if (!first_ready_)
    return spare_ready_ ? spare_->query_batch(poses, out)
                        : CollisionBackend::query_batch(poses, out);  // pose by pose
  // Whatever is wrong with the batch shows again, and is dealt with, pose by pose.
  const Result<void> answered = first_->query_batch(poses, out);
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (!answered || out[i].truncated)
      if (auto again = query(poses[i], nullptr, out[i]); !again) return again;
  return {};
}

/// The first back end, or where it can't, the spare.
template <class Ask>
Result<void> SteadyBackend::ask_either(Ask ask) {
  if (first_ready_) {
    measured_by_ = first_->name();
    const Result<void> answered = ask(*first_);
    if (answered || !make_spare_) return answered;
    if (answered.error().code != ErrorCode::kUsage)
      first_failed(answered.error());  // kUsage: it never answers that, and goes on with the rest
  }
  if (!spare_ready_)
    if (auto prepared = prepare_spare([](const char*, double) { return true; }); !prepared) return prepared;
  measured_by_ = spare_->name();
  return ask(*spare_);
}

// Whatever is wrong with the batch is dealt with frame by frame, as for a batch of whole answers.
Result<void> SteadyBackend::touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits) {
  if (first_ready_) {
    measured_by_ = first_->name();
    if (first_->touches(poses, bits)) return {};
  }
  const Result<void> answered = CollisionBackend::touches(poses, bits);
  if (spare_ready_ && measured_by_ != spare_->name())
    measured_by_ += (measured_by_.empty() ? "" : " or ") + spare_->name();
  return answered;
}

Result<void> SteadyBackend::clearance(const LatticePose& pose, std::int32_t within, Clearance& out) {
  return ask_either([&](CollisionBackend& by) { return by.clearance(pose, within, out); });
}

Result<void> SteadyBackend::free_time(const LatticePose& pose, ScrewMotion& motion, double time,
                                      FreeTime& out) {
  return ask_either([&](CollisionBackend& by) { return by.free_time(pose, motion, time, out); });
}

void SteadyBackend::first_failed(const Error& error) {
  note("the engine " + first_->name() + " has failed: " + error.sentence);
  first_.reset();
  first_ready_ = false;
}

std::uint64_t SteadyBackend::memory_bytes() const {
  return (first_ ? first_->memory_bytes() : 0) + (spare_ ? spare_->memory_bytes() : 0);
}

std::vector<std::string> SteadyBackend::take_notes() {
  for (CollisionBackend* part : {first_.get(), spare_.get()})
    if (part != nullptr)
      for (std::string& sentence : part->take_notes()) note(std::move(sentence));
  std::vector<std::string> fresh(notes_.begin() + static_cast<std::ptrdiff_t>(told_), notes_.end());
  told_ = notes_.size();
  return fresh;
}

void SteadyBackend::note(std::string sentence) {
  if (std::find(notes_.begin(), notes_.end(), sentence) == notes_.end())
    notes_.push_back(std::move(sentence));
}

}  // namespace palpate
