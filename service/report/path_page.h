#pragma once
#include <string>

#include "model/scene/scene.h"
#include "service/queries/path_check.h"

namespace palpate {

/// A path report as one self-contained page: verdict, clearance and depth along the way, sections through the
/// closest moments. `path_name`, `scene_name`: what the page calls them.
std::string path_page(const LoadedScene& scene, const PathReport& report, const std::string& path_name,
                      const std::string& scene_name, const std::string& engine);

}  // namespace palpate
