#include "service/bench/poses.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "model/files/path_file.h"
#include "service/cli/pose_input.h"
#include "service/loop/session.h"

namespace palpate {
namespace {

class PoseKeeper final : public RunObserver {
 public:
  PoseKeeper(Console& console, double duration_s) : console_(console), duration_s_(duration_s) {}
  Result<void> on_frame(const FrameRecord& frame) override {
    poses.push_back(frame.pose);
    return {};
  }
  Result<void> on_tick(const TickRecord& tick) override {
    if (console_.progress("a run in virtual time", tick.time_s / duration_s_)) return {};
    return Error{ErrorCode::kInternal, "interrupted"};
  }
  std::vector<Pose> poses;

 private:
  Console& console_;
  double duration_s_;
};

std::vector<Pose> thinned(const std::vector<Pose>& poses, std::uint64_t count) {
  if (poses.size() <= count) return poses;
  std::vector<Pose> out;
  for (std::uint64_t i = 0; i < count; ++i) out.push_back(poses[i * poses.size() / count]);
  return out;
}

Result<void> write_poses(const std::filesystem::path& file, const std::vector<Pose>& poses) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << "x,y,z,qx,qy,qz,qw\n";
  for (const Pose& p : poses)
    out << fmt::format("{},{},{},{},{},{},{}\n", p.position.x, p.position.y, p.position.z, p.rotation.x,
                       p.rotation.y, p.rotation.z, p.rotation.w);
  out.flush();
  if (!out) return bad_value(file.string() + ": the file can't be written");
  return {};
}

}  // namespace

Result<std::vector<Pose>> bench_poses(const BenchOptions& options, HostedScene& scene, const Parts& parts,
                                      Console& console) {
  const LoadedScene& loaded = scene.loaded;
  if (!options.poses.empty() && options.poses != "run") {
    const Result<std::vector<Pose>> read = read_poses(options.poses);
    if (!read) return read.error();
    return thinned(*read, options.frames);
  }
  if (loaded.scene.device.path.empty())
    return Error{
        ErrorCode::kUsage,
        loaded.scene.file + ": the scene has no path to take poses from; name a file of poses with --poses"};
  if (options.poses.empty()) {
    std::vector<Pose> poses;
    for (const PathPoint& point : loaded.scene.device.path)
      poses.push_back(path_pose(point, loaded.scene.device.guide));
    return thinned(poses, options.frames);
  }
  auto device = parts.make_device("simulated", loaded.scene, loaded.geometry.tool_gc_m, {});
  if (!device) return device.error();
  console.step("taking poses");
  SessionOptions session;
  session.pace = Pace::kAsap;
  session.stop = &interrupt_flag();
  PoseKeeper keeper(console, loaded.scene.device.path.back().time_s);
  const Result<SessionSummary> summary = run_session(loaded, *scene.backend, **device, session, &keeper);
  console.finish();
  if (!summary) return summary.error();
  if (summary->failure) return *summary->failure;
  if (summary->stopped) return Error{ErrorCode::kInternal, "interrupted"};

  const std::vector<Pose> poses = thinned(keeper.poses, options.frames);
  if (options.out.empty()) return poses;
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (auto done = write_poses(std::filesystem::path(options.out) / "poses.csv", poses); !done)
    return done.error();
  return poses;
}

}  // namespace palpate
