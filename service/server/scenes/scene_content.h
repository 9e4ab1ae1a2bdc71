#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "model/scene/plan.h"
#include "service/server/http/limits.h"
#include "service/server/http/problem.h"

namespace palpate {

/// A scene's files on this machine, and the id that their content gives.
struct SceneContent {
  std::string id;                ///< 32 hexadecimal digits
  std::string name;              ///< for people
  std::filesystem::path file;    ///< the scene file, real path
  std::filesystem::path folder;  ///< real path; nothing outside may be read for this scene
  std::optional<Profile> profile;
  bool ignore_initial = false;   ///< contacts at the start are left out, whatever the file says
  std::string engine;            ///< asked for, as `--backend` has it; empty: the server's
  bool uploaded = false;         ///< the folder is ours, to be removed with the scene
  std::uint64_t disk_bytes = 0;  ///< of an upload
};

/// What stands for files that a mesh names in turn, as a glTF does its buffers.
enum class Neighbours : std::uint8_t {
  kByContent,  ///< all files of `folder` are hashed, which is the scene's alone
  kByTime      ///< names, sizes and times of change of the files beside such a mesh, and below
};

/// Another engine than the server's answers the scene: another scene, with another id. `wanted`: JSON, auto,
/// gpu, cpu or ref; no such name is a problem.
std::optional<Problem> choose_engine(const nlohmann::json& wanted, SceneContent& content);

/// Reads which files the scene file names, sees that all of them lie below `folder` (a real path), and
/// hashes. Takes as long as reading them.
std::variant<SceneContent, Problem> read_scene_content(const std::filesystem::path& file,
                                                       const std::filesystem::path& folder,
                                                       std::optional<Profile> profile,
                                                       const ServerLimits& limits, Neighbours neighbours);

}  // namespace palpate
