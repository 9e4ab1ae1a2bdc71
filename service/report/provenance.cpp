#include "service/report/provenance.h"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string_view>
#include <thread>

#include "generated/commit.h"
#include "service/server/scenes/content_hash.h"

namespace palpate {
namespace {

/// The value behind `name` in a file of lines "name : value"; empty: none.
std::string line_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name)) continue;
    const std::size_t colon = line.find(':');
    const std::size_t begin = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "";
}

/// The path as the run has it, whichever file it came from.
std::string path_hash(const DeviceSettings& device) {
  ContentHash hash;
  const auto add = [&](const auto&... values) { (hash.add(fmt::format("{},", values)), ...); };
  const auto add_pose = [&](const Pose& p) {
    add(p.position.x, p.position.y, p.position.z, p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w);
  };
  for (const PathPoint& point : device.path) {
    add(point.time_s, point.travel_m, point.stage);
    add_pose(point.pose);
  }
  for (const GuidePoint& point : device.guide) {
    add(point.travel_m);
    add_pose(point.frame);
  }
  return hash.hex();
}

}  // namespace

std::string machine_text() {
  utsname system{};
  const bool known = uname(&system) == 0;
  const std::string cpu = line_of("/proc/cpuinfo", "model name");
  const double gib = std::strtod(line_of("/proc/meminfo", "MemTotal").c_str(), nullptr) / 1048576;
  return fmt::format("{}, {} threads, {:.0f} GiB, {} {}", cpu.empty() ? "unknown CPU" : cpu,
                     std::thread::hardware_concurrency(), gib, known ? system.sysname : "",
                     known ? system.release : "");
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string typed_command() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::string out = "palpate", word;
  std::getline(in, word, '\0');
  while (std::getline(in, word, '\0')) {
    const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
             std::string_view("_./:=,+-").find(c) != std::string_view::npos;
    });
    if (!plain) {
      for (std::size_t at = 0; (at = word.find('\'', at)) != std::string::npos; at += 4)
        word.replace(at, 1, "'\\''");
      word = "'" + word + "'";
    }
    out += " " + word;
  }
  return out;
}

Provenance provenance_of(const Scene& scene, const PlanDecision& plan, const std::string& engine,
                         const std::string& command) {
  Provenance out{PALPATE_VERSION, PALPATE_COMMIT, machine_text(), engine, command, utc_now(), {}, {}, {}};
  out.inputs.emplace_back(scene.file, file_hash(scene.file));
  const auto mesh = [&](const MeshSource& source) {
    if (!source.file.empty()) {
      for (const auto& [name, hash] : out.inputs)
        if (name == source.file) return;
      out.inputs.emplace_back(source.file, file_hash(source.file));
      return;
    }
    std::string parameters = "generated";
    for (const auto& [name, value] : source.generate_parameters)
      parameters += fmt::format(", {} {:g}", name, value);
    out.inputs.emplace_back(source.generate, parameters);
  };
  for (const StaticBody& body : scene.statics) mesh(body.source);
  mesh(scene.tool.source);
  if (!scene.device.path.empty()) out.inputs.emplace_back("path", path_hash(scene.device));
  if (!scene.device.replay_file.empty())
    out.inputs.emplace_back(scene.device.replay_file, file_hash(scene.device.replay_file));
  for (const PlanStage& stage : plan.stages) (stage.kept ? out.kept : out.left_out).push_back(stage.stage);
  return out;
}

}  // namespace palpate
