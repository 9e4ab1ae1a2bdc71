#pragma once
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// All keys that a scene file may have, by the object they stand in: "scene", "static", "tool", "generate",
/// "response", "control", "device", "workspace", "hand". scenes/scene.schema.json has the same, which a test
/// sees to.
const std::map<std::string, std::vector<std::string>>& scene_keys();

}  // namespace palpate
