#include "service/server/queries/batch_queue.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "service/cli/answer.h"
#include "service/loop/thread_share.h"
#include "service/queries/query_json.h"
#include "service/server/http/problem.h"
#include "service/server/queries/polite_backend.h"

namespace palpate {
namespace {

constexpr std::size_t kSlicePoses =
    64;  ///< chosen: few enough that a lone pose behind many batches is soon answered
constexpr auto kSliceTime = std::chrono::milliseconds(10);  ///< chosen, for poses that take long
constexpr std::size_t kReadAhead = 1 << 20;                 ///< bytes made before the client has read; chosen

/// The 64 bytes of docs/SERVICE.md.
void append_wrench(const Contacts& contacts, const ContactResponse& response, std::string& out) {
  struct Record {
    double force[3], torque[3];
    std::uint32_t pairs, flags, areas, bits;
  } record{};
  static_assert(sizeof(Record) == 64);
  for (int i = 0; i < 3; ++i) {
    record.force[i] = response.told().force[i];
    record.torque[i] = response.told().torque[i];
  }
  record.pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(contacts.pairs, UINT32_MAX));
  record.flags = response.flags;
  record.areas = static_cast<std::uint32_t>(contacts.areas.size());
  record.bits = (contacts.contact ? 1u : 0u) | (contacts.truncated ? 2u : 0u);
  out.append(reinterpret_cast<const char*>(&record), sizeof record);
}

}  // namespace

struct BatchQueue::Batch {
  // The queue's thread alone:
  BatchRequest request;
  Reply reply;  ///< empty once replied
  std::size_t next = 0;
  Answer answer;
  std::size_t together = kSlicePoses;  ///< most poses asked at once, for them to take no longer than a slice
  BatchAnswer answers;                 ///< of such
  std::string made;                    ///< by the slice under way
  std::optional<Error> failure;

  // Shared with the connection:
  std::mutex mutex;
  std::string ready;
  std::function<void(Chunk)> taker;
  bool done = false, broken = false, cancelled = false, parked = false;

  /// Hands on what is ready, if somebody asked; called without the mutex. Returns whether something was
  /// taken.
  void serve() {
    std::function<void(Chunk)> take;
    Chunk chunk;
    {
      const std::lock_guard lock(mutex);
      if (!taker || (ready.empty() && !done)) return;
      take = std::exchange(taker, nullptr);
      chunk.data = std::exchange(ready, {});
      chunk.last = done;
      chunk.broken = broken;
    }
    take(std::move(chunk));
  }
};

/// The connection's end of a batch.
class BatchQueue::Source final : public BodySource {
 public:
  Source(BatchQueue& queue, std::shared_ptr<Batch> batch)
      : queue_(queue), metrics_(queue.metrics_), batch_(std::move(batch)) {}
  ~Source() override {
    const std::lock_guard lock(batch_->mutex);
    batch_->cancelled = true;
    if (batch_->parked) --metrics_.batches_now;  // nobody will look at it again
  }
  void next(std::function<void(Chunk)> take) override {
    bool resume = false;
    {
      const std::lock_guard lock(batch_->mutex);
      batch_->taker = std::move(take);
      resume = std::exchange(batch_->parked, false);
    }
    if (resume) queue_.resume(batch_);
    batch_->serve();
  }

 private:
  BatchQueue& queue_;
  Metrics& metrics_;
  std::shared_ptr<Batch> batch_;
};

BatchQueue::BatchQueue(SceneStore& store, const ServerLimits& limits, Metrics& metrics)
    : store_(store), limits_(limits), metrics_(metrics), thread_([this] { run(); }) {}

BatchQueue::~BatchQueue() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  work_.notify_all();
  thread_.join();
}

void BatchQueue::add(BatchRequest request, Reply reply) {
  auto batch = std::make_shared<Batch>();
  batch->request = std::move(request);
  batch->reply = std::move(reply);
  bool taken = false;
  {
    const std::lock_guard lock(mutex_);
    if (!stop_ && metrics_.batches_now < limits_.batches) {
      ++metrics_.batches_now;
      ring_.push_back(batch);
      taken = true;
    }
  }
  if (!taken)
    return batch->reply(Problem{503, "busy", "there are too many queries under way; ask again", ""});
  work_.notify_one();
}

void BatchQueue::resume(const std::shared_ptr<Batch>& batch) {
  {
    const std::lock_guard lock(mutex_);
    ring_.push_back(batch);
  }
  work_.notify_one();
}

void BatchQueue::run() {
  set_nice(kNiceBatches);
  for (;;) {
    std::shared_ptr<Batch> batch;
    {
      std::unique_lock lock(mutex_);
      work_.wait(lock, [&] { return stop_ || !ring_.empty(); });
      if (stop_) break;
      batch = std::move(ring_.front());
      ring_.pop_front();
    }
    bool cancelled = false;
    {
      const std::lock_guard lock(batch->mutex);
      cancelled = batch->cancelled;
    }
    if (cancelled) {
      --metrics_.batches_now;
      continue;
    }
    answer_slice(*batch);
    const bool done = batch->failure.has_value() || batch->next == batch->request.poses.size();
    if (batch->failure && batch->reply) {  // nothing was sent: the client gets the reason
      --metrics_.batches_now;
      batch->reply(problem_of(*batch->failure));
      continue;
    }
    bool parked = false;
    {
      const std::lock_guard lock(batch->mutex);
      batch->ready += batch->made;
      batch->done = done;
      batch->broken = batch->failure.has_value();
      parked = batch->parked =
          !done && !batch->cancelled &&
          batch->ready.size() > kReadAhead;  // whoever has gone would never come back for it
    }
    batch->made.clear();
    if (done) {
      --metrics_.batches_now;
      batch->request.scene.reset();
    }
    if (batch->reply) {
      HttpResponse response;
      response.type = batch->request.binary ? "application/vnd.palpate.wrenches" : "application/x-ndjson";
      if (done)
        response.body = std::move(batch->ready);
      else
        response.source = std::make_shared<Source>(*this, batch);
      std::exchange(batch->reply, nullptr)(std::move(response));
    } else {
      batch->serve();
    }
    if (!done && !parked) resume(batch);
  }
  // Stopping: whoever waits hears that it is over.
  const std::lock_guard lock(mutex_);
  for (const auto& batch : ring_) {
    if (batch->reply) {
      batch->reply(Problem{503, "busy", "the server stops", ""});
      continue;
    }
    {
      const std::lock_guard inner(batch->mutex);
      batch->done = batch->broken = true;
    }
    batch->serve();
  }
}

/// Touch or not, of as many poses as fit a slice.
Result<void> BatchQueue::touch_slice(Batch& batch) {
  const BatchRequest& request = batch.request;
  HostedScene& scene = **request.scene;
  std::vector<LatticePose> poses;
  for (std::size_t i = batch.next; i < std::min(batch.next + kSlicePoses, request.poses.size()); ++i) {
    const auto pose = to_lattice(request.poses[i], scene.loaded.geometry);
    if (!pose) return pose.error();
    poses.push_back(*pose);
  }
  std::vector<std::uint8_t> bits(poses.size());
  PoliteBackend backend(store_, *request.scene);
  if (auto done = backend.touches(poses, bits); !done) return done;
  for (const std::uint8_t bit : bits) {
    batch.made += "{\"number\":" + std::to_string(batch.next++) + ",\"engine\":\"" + backend.measured_by() +
                  (bit != 0 ? "\",\"touches\":true}\n" : "\",\"touches\":false}\n");
    ++metrics_.poses;
  }
  return {};
}

/// How far, of as many poses as fit a slice.
Result<void> BatchQueue::clearance_slice(Batch& batch, std::chrono::steady_clock::time_point start) {
  const BatchRequest& request = batch.request;
  const SceneGeometry& geometry = (*request.scene)->loaded.geometry;
  PoliteBackend backend(store_, *request.scene);
  const std::int32_t within = within_steps(geometry, request.within_m);
  for (std::size_t i = 0; i < kSlicePoses && batch.next < request.poses.size(); ++i, ++batch.next) {
    if (i > 0 && std::chrono::steady_clock::now() - start > kSliceTime) break;
    const Pose& pose = request.poses[batch.next];
    const auto lattice = to_lattice(pose, geometry);
    if (!lattice) return lattice.error();
    Clearance clearance;
    if (auto done = backend.clearance(*lattice, within, clearance); !done) return done;
    ++metrics_.poses;
    if (request.within_m && clearance.kind == Clearance::Kind::kFurther) continue;
    append_clearance_line(geometry, batch.next, pose, clearance, clearance.kind == Clearance::Kind::kTouching,
                          backend.measured_by(), batch.made);
  }
  return {};
}

/// One pose into batch.answer; or, where nobody waits for a pose's end and it pays, several, `most` at most,
/// into batch.answers. How many.
Result<std::size_t> BatchQueue::answer_some(Batch& batch, CollisionBackend& backend, bool several,
                                            std::size_t most) {
  const LoadedScene& scene = (*batch.request.scene)->loaded;
  const std::span<const Pose> poses = batch.request.poses;
  std::size_t count = 1;
  if (several)
    count = std::min({backend.poses_together(poses.size()), batch.together, most, poses.size() - batch.next});
  if (count == 1) {
    if (auto done = answer_pose(scene, backend, poses[batch.next], batch.answer); !done) return done.error();
    return count;
  }
  if (auto done = answer_batch(scene, backend, poses.subspan(batch.next, count), batch.answers); !done)
    return done.error();
  const bool long_one = batch.answers.total_us > std::chrono::microseconds(kSliceTime).count();
  batch.together = long_one ? std::max<std::size_t>(batch.together / 2, 1)
                            : std::min<std::size_t>(batch.together * 2, kSlicePoses);
  return count;
}

void BatchQueue::answer_slice(Batch& batch) {
  const auto start = std::chrono::steady_clock::now();
  const BatchRequest& request = batch.request;
  HostedScene& scene = **request.scene;
  try {
    if (request.any || request.clearance) {
      const Result<void> answered = request.any ? touch_slice(batch) : clearance_slice(batch, start);
      if (answered) return;
      ++metrics_.backend_errors;
      batch.failure = answered.error();
      return;
    }
    const auto parts =
        request.names ? std::optional<TouchedParts>(std::in_place, scene.loaded.geometry) : std::nullopt;
    const auto tell = [&](const Contacts& contacts, const ContactResponse& response, double us) {
      ++metrics_.poses;
      metrics_.query_s.add(us / 1e6);
      for (const auto& time : contacts.times) metrics_.add_stage(contacts.engine, time.stage, time.us);
      if (contacts.truncated) ++metrics_.truncated;
      if (request.binary)
        append_wrench(contacts, response, batch.made);
      else
        append_query_line({.number = batch.next,
                           .total_us = us,
                           .batch = std::nullopt,
                           .tick = std::nullopt,
                           .sets = request.sets,
                           .parts = request.names ? &*parts : nullptr,
                           .pose = &request.poses[batch.next]},
                          contacts, response, batch.made);
      ++batch.next;
    };
    for (std::size_t asked = 0, count = 0; asked < kSlicePoses && batch.next < request.poses.size();
         asked += count) {
      if (asked > 0 && std::chrono::steady_clock::now() - start > kSliceTime) break;
      Result<std::size_t> answered = std::size_t{0};
      {
        const bool beside = request.scene->loops() > 0;
        const Aside aside = beside ? store_.aside(*request.scene) : Aside{};
        if (aside.backend) {
          answered = answer_some(batch, *aside.backend, true, kSlicePoses - asked);
        } else {
          const TurnGuard turn(request.scene->turns(), TurnGuard::Kind::kBatch);
          answered = answer_some(batch, *scene.backend, !beside, kSlicePoses - asked);
        }
      }
      if (!answered) {
        ++metrics_.backend_errors;
        batch.failure = answered.error();
        return;
      }
      count = *answered;
      if (count == 1) {
        tell(batch.answer.contacts, batch.answer.response, batch.answer.total_us);
      } else {
        for (std::size_t i = 0; i < count; ++i)
          tell(batch.answers.contacts[i], batch.answers.responses[i],
               batch.answers.total_us / static_cast<double>(count));
      }
    }
  } catch (const std::exception& error) {
    batch.failure = Error{ErrorCode::kInternal, std::string("answering the poses failed: ") + error.what()};
  }
}

}  // namespace palpate
