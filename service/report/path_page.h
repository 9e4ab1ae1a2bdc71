#pragma once
#include <string>

#include "model/scene/scene.h"
#include "service/queries/path_check.h"

namespace palpate {

/// A path report as one self-contained page: verdict, clearance and depth along the way, sections through the
/// closest moments.
std::string path_page(const LoadedScene& scene, const PathReport& report, const std::string& path_file,
                      const std::string& engine);

}  // namespace palpate
