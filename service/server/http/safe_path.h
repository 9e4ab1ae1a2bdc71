#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// The real path of `name` below `root` (itself a real path), all symbolic links followed; nothing when it
/// does not exist or lies elsewhere.
std::optional<std::filesystem::path> path_below(const std::filesystem::path& root,
                                                const std::filesystem::path& name);

/// Whether a file of an upload may be called so: letters, digits, '.', '_', '-'; at most 100; no dot in
/// front.
bool plain_name(std::string_view name);

/// A sentence without where `folder` lies on this machine: a client learns what is wrong with its files, and
/// they are called as it called them.
std::string without_folder(std::string sentence, const std::filesystem::path& folder);

}  // namespace palpate
