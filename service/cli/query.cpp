#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string_view>

#include "service/cli/answer.h"
#include "service/cli/cli.h"
#include "service/cli/console.h"
#include "service/cli/export_geometry.h"
#include "service/cli/output_folder.h"
#include "service/cli/pose_input.h"
#include "service/cli/query_text.h"
#include "service/cli/scene_host.h"
#include "service/cli/text_output.h"
#include "service/queries/query_json.h"
#include "service/scene_talk.h"

namespace palpate {
namespace {

/// Poses that are answered and thrown away, so that every pipeline has run once with a contact (chosen).
constexpr std::size_t kWarmUpPoses = 32;

/// Gives every answer of a batch the mean of the batch's times.
void share_times(std::vector<Contacts>& batch) {
  std::vector<Contacts::StageTime> sums;
  for (const Contacts& contacts : batch)
    for (const auto& time : contacts.times) {
      const auto found = std::find_if(sums.begin(), sums.end(), [&](const auto& sum) {
        return std::string_view(sum.stage) == time.stage;
      });
      if (found == sums.end())
        sums.push_back(time);
      else
        found->us += time.us;
    }
  for (auto& sum : sums) sum.us /= static_cast<double>(batch.size());
  for (Contacts& contacts : batch) contacts.times = sums;
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
    Result<std::vector<Pose>> read = read_poses_of_scene(*options.poses, options.common.scene);
    if (!read) return read.error();
    poses = std::move(*read);
  }

  if (options.any || options.clearance || options.within_m) return verdicts_command(options, poses, parts);
  if (options.tolerance_m > 0)
    return Error{ErrorCode::kUsage, "--tolerance goes with --any, --clearance or --within"};

  if (!options.export_directory.empty())
    if (auto done = check_output_folder(options.export_directory, kExportedFiles, "an export's",
                                        options.overwrite, "--export-geometry");
        !done)
      return done;

  catch_interrupts();
  Console console;
  Result<std::unique_ptr<HostedScene>> prepared =
      prepare_scene(options.common, Purpose::kQuery, parts, console);
  if (!prepared) return prepared.error();
  HostedScene& scene = **prepared;

  if (!options.export_directory.empty()) {
    std::vector<std::string> notes;
    if (auto done =
            export_geometry(options.export_directory, scene.loaded.geometry, *scene.backend, poses, notes);
        !done)
      return done;
    for (const std::string& note : notes) console.note(note);
  }

  const Result<SceneTalk> talk =
      scene_talk(scene.loaded, *scene.backend, poses.empty() ? std::nullopt : std::optional(poses.front()));
  if (!talk) return talk.error();
  for (const std::string& sentence : talk->bodies) console.note(sentence);

  Answer answer;
  for (std::size_t i = 0; i < std::min(kWarmUpPoses, poses.size()); ++i) {
    if (auto done = answer_pose(scene, poses[i], answer); !done) return done;
    if (answer.contacts.contact) break;
  }

  const TouchedParts named(scene.loaded.geometry);
  std::string text;
  std::size_t truncated = 0, unsettled = 0, directionless = 0;
  const char* capacity = "";
  const TouchedParts* const parts_asked = options.names ? &named : nullptr;
  const bool for_people = !options.json && ::isatty(STDOUT_FILENO) == 1;
  if (for_people) console.finish();
  const auto print = [&](std::size_t number, double total_us, const Contacts& contacts,
                         const ContactResponse& response) {
    if (!for_people)
      append_query_line({.number = number,
                         .total_us = total_us,
                         .batch = options.batch,
                         .tick = std::nullopt,
                         .parts = parts_asked,
                         .pose = &poses[number]},
                        contacts, response, text);
    else if (poses.size() == 1)
      text += answer_text(poses[number], contacts, response, parts_asked);
    else
      text += (number == 0 ? answer_table_head() : std::string()) +
              answer_table_line(number, contacts, response, parts_asked);
    if (response.flags & kFlagUnsettled) ++unsettled;
    if (response.flags & kFlagNoDirection) ++directionless;
    if (!contacts.truncated) return;
    ++truncated;
    capacity = contacts.truncated_capacity;
  };
  // Pairs are exported pose by pose: a back end knows those of its last answer alone.
  const bool together = options.batch && options.export_directory.empty();
  BatchAnswer batch;
  Answer asked;
  for (std::size_t first = 0, count = 0; first < poses.size(); first += count) {
    text.clear();
    if (together) {
      count = std::min<std::size_t>(*options.batch, poses.size() - first);
      if (auto done = answer_batch(scene, {poses.data() + first, count}, batch); !done) return done;
      share_times(batch.contacts);
      for (std::size_t i = 0; i < count; ++i)
        print(first + i, batch.total_us / static_cast<double>(count), batch.contacts[i], batch.responses[i]);
    } else {
      count = 1;
      if (auto done = answer_pose(scene, poses[first], answer); !done) return done;
      if (!options.export_directory.empty()) {
        // A back end knows the pairs of its last evaluation alone, which was where the tool would be.
        if (auto done = answer_frame(scene, poses[first], asked); !done) return done;
        if (auto done = export_pairs(options.export_directory, *scene.backend, first); !done) return done;
      }
      print(first, answer.total_us, answer.contacts, answer.response);
    }
    if (auto done = print_text(text); !done) return done;
    if (interrupted() && first + count < poses.size())
      return Error{ErrorCode::kInternal,
                   fmt::format("interrupted after {} of {} poses", first + count, poses.size())};
  }
  for (const std::string& note : scene.backend->take_notes()) console.note(note);
  if (unsettled > 0)
    console.note(
        fmt::format("{} of {} poses found no balance of spring and contact (flag unsettled): their force is "
                    "the nearest to one",
                    unsettled, poses.size()));
  if (directionless > 0)
    console.note(
        fmt::format("{} of {} poses are in touch where nothing tells the way out, as between open surfaces "
                    "(flag no_direction): they give no force",
                    directionless, poses.size()));
  if (truncated > 0)
    console.note(fmt::format("{} of {} poses were truncated and give no force: {} was too small", truncated,
                             poses.size(), capacity));
  return {};
}

}  // namespace palpate
