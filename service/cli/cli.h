#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "driver/haptic_device.h"
#include "model/cache/disk_cache.h"
#include "model/collision_backend.h"
#include "model/lattice/pose.h"
#include "model/mesh/mesh_import.h"
#include "model/scene/scene.h"
#include "service/bench/time/peer.h"

namespace palpate {

/// A device of either kind, and why it can or can't be used.
struct DeviceLine {
  std::string kind;  ///< "vulkan" or "haptic"
  std::string name;
  bool usable = false;
  std::string reason;  ///< one sentence
};

/// What main.cpp plugs in; it alone knows back ends and drivers by name.
struct Parts {
  /// Must be called before any thread exists (compute/gpu/gpu_backend.h). `cached`: what it prepares is
  /// looked for and kept in `cache`.
  std::function<Result<std::unique_ptr<CollisionBackend>>(bool cached)> make_gpu;
  std::function<std::unique_ptr<CollisionBackend>(bool cached)> make_cpu;  ///< the native engine
  std::function<std::unique_ptr<CollisionBackend>()> make_ref;
  /// Whether Vulkan shows a device that can be used and is not the host's own processor.
  std::function<bool()> has_gpu;
  /// Keeps what loading and preparing worked out; null: nothing is kept.
  std::shared_ptr<DiskCache> cache;
  /// A haptic device by name, closed; `tool_gc_m` is the tool's centre of mass, tool frame. Errors: kBadValue
  /// for an unknown name or a setting, kNoDevice for one that this version can't drive.
  std::function<Result<std::unique_ptr<HapticDevice>>(const std::string& name, const Scene& scene,
                                                      const Vec3& tool_gc_m, const std::string& firmware)>
      make_device;
  std::function<std::vector<DeviceLine>()> list_devices;
  /// Other collision libraries, for `bench peers`, and the judge of their pairs (service/bench/time/peer.h);
  /// empty where they were not built.
  std::function<std::vector<std::unique_ptr<Peer>>()> make_peers;
  std::function<std::unique_ptr<Peer>()> make_judge;
  std::function<std::vector<std::unique_ptr<QuestionPeer>>()> make_question_peers;
};

/// What several commands share.
struct SceneOptions {
  std::string scene;    ///< path of the scene file
  std::string backend;  ///< "gpu", "cpu" or "ref"; "auto" or empty: on a GPU the quicker of gpu and cpu, else
                        ///< cpu, with a sentence
  std::optional<Profile> profile;  ///< in place of the scene's
  bool full_plan = false;
  bool second_backend = false;        ///< for going over to another plan in mid-run
  bool all_samples = false;           ///< `contact_samples` = 0 in place of the scene's
  ImportLimits import = {};           ///< of each mesh file
  std::optional<double> unit_m = {};  ///< of mesh files whose unit neither they nor the scene state; empty: 1
};

struct RunOptions {
  SceneOptions common;
  bool asap = false;
  std::string device;  ///< in place of the scene's; empty: the scene's
  std::string firmware;
  std::optional<double> duration_s;
  std::vector<std::string>
      switches;  ///< "SECONDS:WORD", WORD paper, refined, full or auto: what the run goes over to, and when
  std::string out;         ///< empty: a fresh directory
  bool overwrite = false;  ///< the files of a run that `out` has already
};

struct QueryOptions {
  SceneOptions common;
  std::optional<std::string> pose;   ///< "x y z qx qy qz qw"
  std::optional<std::string> poses;  ///< CSV file
  std::optional<std::uint64_t> batch;
  bool names = false;              ///< the parts that touch, by their paths
  bool json = false;               ///< even at a terminal
  std::string export_directory;    ///< empty: none
  bool overwrite = false;          ///< the files of an export that it has already
  bool any = false;                ///< touch or not, and nothing else
  bool clearance = false;          ///< the smallest distance, and nothing else
  std::optional<double> within_m;  ///< the same, of poses nearer than that
  double tolerance_m = 0;          ///< of `any` and `clearance`: a contact no deeper does not count
};

struct GenerateOptions {
  std::string name;
  std::uint64_t triangles = 0, tool_triangles = 0;  ///< 0: the chapter's
  std::string out;
  bool overwrite = false;  ///< the files of a scene that `out` has already
};

struct InfoOptions {
  std::vector<std::string> files;  ///< meshes, and scenes (.json)
  bool json = false, tree = false;
  std::optional<double> unit_m = {};  ///< of a file's coordinates; empty: sizes are in file units
  ImportLimits import = {};           ///< of each mesh file
  Tessellation tessellation = {};     ///< of CAD files
};

// Each command prints its result on standard output, all else on standard error, and returns the reason if it
// failed.
Result<void> run_command(const RunOptions& options, const Parts& parts);
/// `query` with `any`, `clearance` or `within_m`.
Result<void> verdicts_command(const QueryOptions& options, const std::vector<Pose>& poses,
                              const Parts& parts);
Result<void> query_command(const QueryOptions& options, const Parts& parts);
Result<void> plan_command(const SceneOptions& options, bool json, const Parts& parts);
Result<void> info_command(const InfoOptions& options, const Parts& parts);
Result<void> generate_command(const GenerateOptions& options);
Result<void> devices_command(const Parts& parts);

/// Parses the command line and runs the command. Returns the exit code (ErrorCode's numbers, 0 for success);
/// never throws.
int command_line(int argc, const char* const* argv, const Parts& parts) noexcept;

}  // namespace palpate
