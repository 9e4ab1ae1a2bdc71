#include "service/server/queries/batch_queue.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include "service/cli/answer.h"
#include "service/loop/thread_share.h"
#include "service/queries/query_json.h"
#include "service/server/queries/polite_backend.h"

namespace palpate {
namespace {

constexpr std::size_t kSlicePoses =
    64;  ///< chosen: few enough that a lone pose behind many batches is soon answered
constexpr auto kSliceTime = std::chrono::milliseconds(10);  ///< chosen, for poses that take long
constexpr std::size_t kReadAhead = 1 << 20;                 ///< bytes made before the client has read; chosen

/// The 64 bytes of docs/SERVICE.md.
void append_wrench(const Answer& answer, std::string& out) {
  struct Record {
    double force[3], torque[3];
    std::uint32_t pairs, flags, areas, bits;
  } record{};
  static_assert(sizeof(Record) == 64);
  for (int i = 0; i < 3; ++i) {
    record.force[i] = answer.response.told().force[i];
    record.torque[i] = answer.response.told().torque[i];
  }
  record.pairs = static_cast<std::uint32_t>(std::min<std::uint64_t>(answer.contacts.pairs, UINT32_MAX));
  record.flags = answer.response.flags;
  record.areas = static_cast<std::uint32_t>(answer.contacts.areas.size());
  record.bits = (answer.contacts.contact ? 1u : 0u) | (answer.contacts.truncated ? 2u : 0u);
  out.append(reinterpret_cast<const char*>(&record), sizeof record);
}

}  // namespace

struct BatchQueue::Batch {
  // The queue's thread alone:
  BatchRequest request;
  Reply reply;  ///< empty once replied
  std::size_t next = 0;
  Answer answer;
  std::string made;  ///< by the slice under way
  bool failed = false;
  std::string failure;

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
    const bool done = batch->failed || batch->next == batch->request.poses.size();
    if (batch->failed && batch->reply) {  // nothing was sent: the client gets the reason
      --metrics_.batches_now;
      batch->reply(Problem{500, "internal", batch->failure, ""});
      continue;
    }
    bool parked = false;
    {
      const std::lock_guard lock(batch->mutex);
      batch->ready += batch->made;
      batch->done = done;
      batch->broken = batch->failed;
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
  for (std::size_t i = 0; i < kSlicePoses && batch.next < request.poses.size(); ++i, ++batch.next) {
    if (i > 0 && std::chrono::steady_clock::now() - start > kSliceTime) break;
    const Pose& pose = request.poses[batch.next];
    const auto lattice = to_lattice(pose, geometry);
    if (!lattice) return lattice.error();
    Clearance clearance;
    if (auto done = backend.clearance(*lattice, INT32_MAX - 2, clearance); !done) return done;
    append_clearance_line(geometry, batch.next, pose, clearance, clearance.kind == Clearance::Kind::kTouching,
                          backend.measured_by(), batch.made);
    ++metrics_.poses;
  }
  return {};
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
      batch.failed = true;
      batch.failure = answered.error().sentence;
      return;
    }
    const auto parts =
        request.names ? std::optional<TouchedParts>(std::in_place, scene.loaded.geometry) : std::nullopt;
    for (std::size_t i = 0; i < kSlicePoses && batch.next < request.poses.size(); ++i, ++batch.next) {
      if (i > 0 && std::chrono::steady_clock::now() - start > kSliceTime) break;
      Result<void> answered;
      {
        const Aside aside = request.scene->loops() > 0 ? store_.aside(*request.scene) : Aside{};
        if (aside.backend) {
          answered = answer_pose(scene.loaded, *aside.backend, request.poses[batch.next], batch.answer);
        } else {
          const TurnGuard turn(request.scene->turns(), TurnGuard::Kind::kBatch);
          answered = answer_pose(scene, request.poses[batch.next], batch.answer);
        }
      }
      if (!answered) {
        ++metrics_.backend_errors;
        batch.failed = true;
        batch.failure = answered.error().sentence;
        return;
      }
      ++metrics_.poses;
      metrics_.query_s.add(batch.answer.total_us / 1e6);
      for (const auto& time : batch.answer.contacts.times)
        metrics_.add_stage(batch.answer.contacts.engine, time.stage, time.us);
      if (batch.answer.contacts.truncated) ++metrics_.truncated;
      if (request.binary)
        append_wrench(batch.answer, batch.made);
      else
        append_query_line({.number = batch.next,
                           .total_us = batch.answer.total_us,
                           .batch = std::nullopt,
                           .tick = std::nullopt,
                           .sets = request.sets,
                           .parts = request.names ? &*parts : nullptr,
                           .pose = &request.poses[batch.next]},
                          batch.answer.contacts, batch.answer.response, batch.made);
    }
  } catch (const std::exception& error) {
    batch.failed = true;
    batch.failure = std::string("answering the poses failed: ") + error.what();
  }
}

}  // namespace palpate
