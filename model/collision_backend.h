#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/clearance.h"
#include "model/contact/contacts.h"
#include "model/contact/screw_motion.h"
#include "model/lattice/lattice.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Told about long work; returns false to cancel it. `done` in [0, 1].
using Progress = std::function<bool(const char* what, double done)>;

/// What a stage of `palpate plan` keeps for the prepared scene.
struct StageMemory {
  std::string stage;
  std::uint64_t bytes = 0;
};

/// What queries asked of a device, added up; all 0 where there is none. Bytes are those that a frame itself
/// writes and reads, not what is allocated.
struct DeviceWork {
  std::uint64_t submissions = 0;  ///< each waited for
  std::uint64_t dispatches = 0;   ///< of no workgroup, too
  std::uint64_t barriers = 0;     ///< each drains the device
  std::uint64_t bytes_up = 0, bytes_down = 0;
  double host_us = 0;  ///< of the host beside submitting and waiting

  /// Adds every count.
  DeviceWork& operator+=(const DeviceWork& more) {
    submissions += more.submissions;
    dispatches += more.dispatches;
    barriers += more.barriers;
    bytes_up += more.bytes_up;
    bytes_down += more.bytes_down;
    host_us += more.host_us;
    return *this;
  }
  bool operator==(const DeviceWork&) const = default;
};

/// Answers poses one after the other: an engine, or what a thread has of one to itself.
class PoseQuery {
 public:
  virtual ~PoseQuery() = default;
  /// Answers one pose. `ignored`: what is left out, `refined` only; may be null. Writes `out` whole, reusing
  /// its memory. An error means that the back end itself failed (device lost): the caller sends zero force.
  virtual Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) = 0;
  /// Answers many: `out[i]` is what query(poses[i], nullptr, *out[i]) would make of it but for the times. As
  /// many `out` as `poses`.
  virtual Result<void> query_together(std::span<const LatticePose> poses, std::span<Contacts* const> out) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      if (auto done = query(poses[i], nullptr, *out[i]); !done) return done;
    return {};
  }
  /// Whether the tool touches at each of many poses: bits[i] = 1 where query() would find contact. As many
  /// `bits` as `poses`. Error: as query(), or a frame was truncated.
  virtual Result<void> touch_together(std::span<const LatticePose> poses, std::span<std::uint8_t> bits);
};

/// Piece `i` of some work: asks `asked`, and nobody else, for as many poses as it needs. An error ends the
/// whole.
using PoseWork = std::function<Result<void>(PoseQuery& asked, std::size_t i)>;

/// Finds contacts. prepare() once, off the loops; query() each frame, by one thread at a time.
/// Three engines answer every query with identical integers: compute/gpu (Vulkan), compute/native (this
/// processor) and cpu_ref.
class CollisionBackend : public PoseQuery {
 public:
  /// Builds the voxel partition and whatever else a query needs. `geometry` must outlive the back end.
  /// Allocates; takes as long as it takes. A second call replaces the first scene. What only rare queries
  /// need may be made on another thread and not be there yet on return: the first such query waits for it, or
  /// finish_preparing() does.
  virtual Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) = 0;

  /// Waits for what prepare() or replan() left to another thread, so that no query has to. Call it before a
  /// loop begins, not while a query runs. Error: it can't be made.
  virtual Result<void> finish_preparing() { return {}; }

  /// The same prepared scene under another plan of the same profile: what it adds is made, what it leaves out
  /// is gone. Takes milliseconds; not while a query runs. Error: as prepare(), or the profile is another one;
  /// the back end may have to be prepared again.
  virtual Result<void> replan(const Plan&) {
    return Error{ErrorCode::kInternal, "the " + name() + " back end knows one plan"};
  }

  /// The most memory that prepare() will need on the device for this scene, known before it begins; 0: nobody
  /// knows. More than that was never seen; prepare() refuses at once what can't fit.
  virtual std::uint64_t preparation_bytes(const SceneGeometry& geometry, const Plan& plan) const {
    (void)geometry, (void)plan;
    return 0;
  }

  /// Does pieces 0 … count − 1 of `work` with whatever can work on them side by side, in any order. `work` is
  /// called by several threads at once, each with somebody of its own to ask. The first call that is worth it
  /// may take time and memory to set helpers up; it may start threads.
  virtual Result<void> share(std::size_t count, const PoseWork& work) {
    for (std::size_t i = 0; i < count; ++i)
      if (auto done = work(*this, i); !done) return done;
    return {};
  }

  /// True: from now on query() tells the times of a frame's stages under a plan without telemetry, too. On a
  /// device such a frame takes longer. Returns false where the engine tells them always, and nothing changes.
  /// Not while a query runs.
  virtual bool time_stages(bool) { return false; }

  /// How many of so many poses a piece of share() best asks together; 1: nothing is gained by it. May set
  /// helpers up, as share().
  virtual std::size_t poses_together(std::size_t count) {
    (void)count;
    return 1;
  }

  /// Answers many poses with whatever can work on them side by side: out[i] is what query(poses[i], nullptr,
  /// out[i]) would make of it but for the times. As many `out` as `poses`. Threads and memory as share().
  virtual Result<void> query_batch(std::span<const LatticePose> poses, std::span<Contacts> out);

  /// Whether the tool touches the mock-up, containment included: bits[i] = 1 where query() of poses[i] would
  /// find contact. As many `bits` as `poses`. As query_batch() for the rest, and may stop at the first pair
  /// that it finds. Error: as there, or a frame was truncated.
  virtual Result<void> touches(std::span<const LatticePose> poses, std::span<std::uint8_t> bits);

  /// The exact distance at a pose. What is further than `within` steps need not be measured: kFurther. Error
  /// (kUsage): this engine measures none.
  virtual Result<void> clearance(const LatticePose&, std::int32_t within, Clearance& out) {
    (void)within, (void)out;
    return Error{ErrorCode::kUsage, "the " + name() + " engine measures no distances; cpu and ref do"};
  }

  /// For how long, to the motion's end at most, a tool that has come to a time of it stays free for certain,
  /// of contact of the tool's triangles with the mock-up's at the true and at every rounded pose. `pose`: the
  /// motion's at that time, no earlier than the last, and not in contact. Error: as clearance().
  virtual Result<void> free_time(const LatticePose& pose, ScrewMotion& motion, double time, FreeTime& out);

  /// Name of the engine that answered the last touches(), clearance() or free_time().
  virtual std::string measured_by() const { return name(); }

  /// Makes room for what truncated the last query, so that the same pose can be asked again. Takes time and
  /// memory: not for a loop that somebody waits for. Error: there is no more room, or what ran out is not
  /// room; the back end goes on answering as before.
  virtual Result<void> enlarge() {
    return Error{ErrorCode::kInternal, "the " + name() + " back end has no lists to enlarge"};
  }

  /// The mock-up's partition (`tool` = false) or the tool's (refined only), for export and comparison.
  virtual Result<VoxelPartition> partition(bool tool) const = 0;

  /// The intersecting (static, mobile) pairs that the last query() counted in Contacts::pairs, ascending; for
  /// export and comparison, off the loops: it allocates. An error: this back end lists none.
  virtual Result<std::vector<std::pair<std::uint32_t, std::uint32_t>>> pairs() const {
    return Error{ErrorCode::kInternal, "this back end lists no pairs"};
  }

  virtual bool has_internal_voxels() const = 0;  ///< the mock-up has V_int voxels
  virtual std::string name() const = 0;          ///< the engine: "gpu", "cpu" or "ref"
  virtual std::string device()
      const = 0;  ///< what it runs on: "llvmpipe (LLVM 15.0.6, 256 bits)", "AMD EPYC, 2 threads"
  virtual std::uint64_t memory_bytes() const = 0;  ///< kept for the prepared scene
  /// memory_bytes() by stage; what several stages use counts for the first of them. Empty: this back end
  /// doesn't tell them apart.
  virtual std::vector<StageMemory> memory_by_stage() const { return {}; }
  /// Of all queries since the plan was prepared. Not while a query runs.
  virtual DeviceWork device_work() const { return {}; }
  /// What a user should know of what has happened since the last call, a sentence each. Not while a query
  /// runs.
  virtual std::vector<std::string> take_notes() { return {}; }
};

}  // namespace palpate
