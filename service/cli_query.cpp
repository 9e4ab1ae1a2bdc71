#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "service/answer.h"
#include "service/cli.h"
#include "service/console.h"
#include "service/export_geometry.h"
#include "service/pose_input.h"
#include "service/query_json.h"
#include "service/scene_host.h"

namespace palpate {
namespace {

/// Poses that are answered and thrown away, so that every pipeline has run once with a contact (chosen).
constexpr std::size_t kWarmUpPoses = 32;

/// Gives every answer of a batch the mean of the batch's times.
void share_times(std::vector<Answer>& batch) {
  const double count = static_cast<double>(batch.size());
  double total = 0;
  std::vector<Contacts::StageTime> sums;
  for (const Answer& answer : batch) {
    total += answer.total_us;
    for (const auto& time : answer.contacts.times) {
      const auto found = std::find_if(sums.begin(), sums.end(), [&](const auto& sum) { return std::string_view(sum.stage) == time.stage; });
      if (found == sums.end())
        sums.push_back(time);
      else
        found->us += time.us;
    }
  }
  for (auto& sum : sums) sum.us /= count;
  for (Answer& answer : batch) {
    answer.total_us = total / count;
    answer.contacts.times = sums;
  }
}

Result<void> put(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return {};
  return Error{ErrorCode::kInternal, "standard output can't be written"};
}

}  // namespace

Result<void> query_command(const QueryOptions& options, const Parts& parts) {
  if (!options.pose && !options.poses)
    return Error{ErrorCode::kUsage, "query needs --pose or --poses (see palpate query --help)"};
  // All poses are read first: a bad one costs no preparation and leaves standard output empty.
  std::vector<Pose> poses;
  if (options.pose) {
    const Result<Pose> pose = parse_pose(*options.pose);
    if (!pose) return pose.error();
    poses.push_back(*pose);
  } else {
    Result<std::vector<Pose>> read = read_poses(*options.poses);
    if (!read) return read.error();
    poses = std::move(*read);
  }

  catch_interrupts();
  Console console;
  Result<std::unique_ptr<HostedScene>> prepared = prepare_scene(options.common, Purpose::kQuery, parts, console);
  if (!prepared) return prepared.error();
  HostedScene& scene = **prepared;

  if (!options.export_directory.empty()) {
    std::vector<std::string> notes;
    if (auto done = export_geometry(options.export_directory, scene.loaded.geometry, *scene.backend, poses, notes); !done) return done;
    for (const std::string& note : notes) console.note(note);
  }

  std::vector<Answer> batch(std::min<std::uint64_t>(options.batch.value_or(1), poses.size()));
  for (std::size_t i = 0; i < std::min(kWarmUpPoses, poses.size()); ++i) {
    if (auto done = answer_pose(scene, poses[i], batch.front()); !done) return done;
    if (batch.front().contacts.contact) break;
  }

  std::string text;
  std::size_t truncated = 0;
  const char* capacity = "";
  for (std::size_t first = 0; first < poses.size(); first += batch.size()) {
    batch.resize(std::min(batch.size(), poses.size() - first));
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (auto done = answer_pose(scene, poses[first + i], batch[i]); !done) return done;
      if (options.export_directory.empty()) continue;
      if (auto done = export_pairs(options.export_directory, *scene.backend, first + i); !done) return done;
    }
    if (options.batch) share_times(batch);
    text.clear();
    for (std::size_t i = 0; i < batch.size(); ++i) {
      append_query_line({first + i, batch[i].total_us, options.batch, std::nullopt}, batch[i].contacts, batch[i].response, text);
      if (!batch[i].contacts.truncated) continue;
      ++truncated;
      capacity = batch[i].contacts.truncated_capacity;
    }
    if (auto done = put(text); !done) return done;
    if (interrupted()) return Error{ErrorCode::kInternal, fmt::format("interrupted after {} of {} poses", first + batch.size(), poses.size())};
  }
  for (const std::string& note : scene.backend->take_notes()) console.note(note);
  if (truncated > 0) console.note(fmt::format("{} of {} poses were truncated and give no force: {} was too small", truncated, poses.size(), capacity));
  return {};
}

}  // namespace palpate
