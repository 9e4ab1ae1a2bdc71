#include "model/scene/scene_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>

#include "model/files/one_line.h"
#include "model/files/path_file.h"
#include "model/generate.h"
#include "model/mesh/mesh_import.h"
#include "model/mesh/thicken.h"
#include "model/scene/scene_json.h"
#include "model/scene/scene_keys.h"

namespace palpate {

const std::map<std::string, std::vector<std::string>>& scene_keys() {
  static const std::map<std::string, std::vector<std::string>> keys{
      {"scene", {"$schema", "description", "static", "tool", "response", "control", "device", "start"}},
      {"static",
       {"mesh", "generate", "units", "scale", "part", "without", "sheet_thickness", "position", "rotation"}},
      {"tool",
       {"mesh", "generate", "units", "scale", "part", "without", "sheet_thickness", "mass",
        "centre_of_mass"}},
      {"generate", {"name", "body", "triangles"}},
      {"response",
       {"profile", "stiffness", "smooth_angle_deg", "sample_spacing", "voxel_size", "contact_samples",
        "budget_us", "tessellation", "tessellation_angle_deg"}},
      {"control",
       {"law", "transitions", "virtual_delay_ticks", "watchdog_ms", "fade_in_ms", "change_n_per_s", "slew_ms",
        "passivity", "coupling_n_per_m", "coupling_nm_per_rad"}},
      {"device",
       {"driver", "path", "guide", "stages", "actuated", "mass", "inertia", "damping", "angular_damping",
        "hand", "max_force", "max_torque", "workspace"}},
      {"workspace", {"scale", "offset", "axes", "clutch_button"}},
      {"hand", {"stiffness", "damping", "mass", "angular_stiffness", "angular_damping"}},
  };
  return keys;
}

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 16u << 20;  ///< bytes (chosen: a scene file is a page)
constexpr double kFarthest = 1e4;                   ///< m; scenes over 100 m are warned about

const std::vector<std::string>& keys_of(const char* object) { return scene_keys().at(object); }

[[noreturn]] void fault(std::string sentence) { throw SceneFault{std::move(sentence)}; }

/// Lets a Result's error end the reading.
template <class T>
T must(Result<T> result) {
  if (!result) fault(result.error().sentence);
  return std::move(*result);
}

std::string beside(const std::string& scene_file, const std::string& path) {
  return fs::weakly_canonical(fs::absolute(fs::path(scene_file)).parent_path() / path).string();
}

std::string text_of(const std::string& file) {
  std::error_code fault_code;
  if (!fs::exists(file, fault_code)) fault(file + " does not exist");
  if (fs::is_directory(file, fault_code)) fault(file + " is a directory; a scene is a JSON file");
  const std::uintmax_t size = fs::file_size(file, fault_code);
  if (!fault_code && size > kLargestFile)
    fault(file + " has " + std::to_string(size) + " bytes; a scene file has at most " +
          std::to_string(kLargestFile));
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) fault(file + " cannot be read");
  return text.str();
}

void read_generate(const SceneObject& body, const char* usual_body, MeshSource& source) {
  const SceneObject generate(body.file(), body.pointer("generate"), body.at("generate"), keys_of("generate"));
  if (!generate.has("name")) generate.fail("name", "is missing; it must be " + listed(generator_names()));
  const std::size_t name = *generate.choice("name", generator_names());
  const std::vector<std::string> bodies{"mockup", "tool"};
  const auto chosen = generate.choice("body", bodies);
  source.generate = generator_names()[name] + "/" + (chosen ? bodies[*chosen] : usual_body);
  int triangles = 0;
  generate.whole("triangles", 1'000, 10'000'000, triangles);
  if (triangles > 0) source.generate_parameters["triangles"] = triangles;
}

void read_source(const SceneObject& body, const char* usual_body, const GivenMeshes& given,
                 MeshSource& source) {
  if (body.has("mesh") == body.has("generate"))
    body.fail("mesh", body.has("mesh") ? "stands beside \"generate\"; only one of them may"
                                       : "is missing, and so is \"generate\"; one is wanted");
  if (body.has("units") && body.has("scale"))
    body.fail("units", "stands beside \"scale\"; only one of them may");
  if (body.has("generate")) {
    for (const char* key : {"units", "scale"})
      if (body.has(key)) body.fail(key, "stands beside \"generate\"; a generated body is in metres");
    read_generate(body, usual_body, source);
  } else {
    body.text("mesh", source.file);
    if (const auto found = given.find(source.file); found != given.end())
      source.given = found->second;
    else
      source.file = beside(body.file(), source.file);
    if (!source.given && body.has("units") && states_unit(source.file))
      body.fail("units",
                "stands beside a file that states its unit and comes in metres; leave it out (\"scale\" "
                "makes it larger or smaller)");
  }
  const std::vector<std::string> units{"m", "mm", "cm", "in"};
  constexpr double kMetres[] = {1, 1e-3, 1e-2, 0.0254};
  if (const auto unit = body.choice("units", units)) source.scale = kMetres[*unit];
  body.number("scale", {0, 1e6, " m per unit of the file", true}, source.scale);
  source.scale_stated = body.has("units") || body.has("scale");
  body.text("part", source.part);
  body.texts("without", source.without);
  if (body.is_auto("sheet_thickness")) {
    source.sheet_thickness_m.reset();
  } else {
    if (body.has("sheet_thickness") && body.at("sheet_thickness").is_string())
      body.fail("sheet_thickness",
                "is " + body.at("sheet_thickness").dump() + "; it must be \"auto\" or a number of metres");
    body.number("sheet_thickness", {0, kThickestSheet, " m"}, *source.sheet_thickness_m);
    if (*source.sheet_thickness_m > 0 && *source.sheet_thickness_m < kThinnestSheet)
      body.fail("sheet_thickness",
                "is " + body.at("sheet_thickness").dump() + "; it must be 0, \"auto\", or from 1e-06 to 1 m");
  }
}

void read_statics(const SceneObject& scene_json, const GivenMeshes& given, Scene& scene) {
  if (!scene_json.has("static")) scene_json.fail("static", "is missing; an array of bodies is wanted");
  const json& list = scene_json.at("static");
  if (!list.is_array() || list.empty()) scene_json.fail("static", "must be an array of at least one body");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const SceneObject body(scene.file, scene_json.pointer("static") + "/" + std::to_string(i), list[i],
                           keys_of("static"));
    StaticBody& out = scene.statics.emplace_back();
    read_source(body, "mockup", given, out.source);
    body.vector("position", kFarthest, " m", out.placement.position);
    body.rotation("rotation", out.placement.rotation);
  }
}

void read_tool(const SceneObject& scene_json, const GivenMeshes& given, Scene& scene) {
  if (!scene_json.has("tool")) scene_json.fail("tool", "is missing; an object is wanted");
  const SceneObject body(scene.file, scene_json.pointer("tool"), scene_json.at("tool"), keys_of("tool"));
  read_source(body, "tool", given, scene.tool.source);
  body.number("mass", {0, 1e3, " kg", true}, scene.tool.mass_kg);
  if (body.has("centre_of_mass") && !body.is_auto("centre_of_mass")) {
    if (body.at("centre_of_mass").is_string())
      body.fail("centre_of_mass", "is " + body.at("centre_of_mass").dump() +
                                      "; it must be \"auto\" or three numbers [x, y, z]");
    body.vector("centre_of_mass", kFarthest, " m", scene.tool.centre_of_mass_m.emplace());
  }
}

/// A length that may be "auto".
void read_length(const SceneObject& object, const char* key, std::optional<double>& out) {
  if (!object.has(key) || object.is_auto(key)) return;
  if (object.at(key).is_string())
    object.fail(key, "is " + object.at(key).dump() + "; it must be \"auto\" or a number of metres");
  object.number(key, {0, 100, " m", true}, out.emplace());
}

void read_response(const SceneObject& scene_json, ResponseSettings& response) {
  if (!scene_json.has("response")) return;
  const SceneObject body(scene_json.file(), scene_json.pointer("response"), scene_json.at("response"),
                         keys_of("response"));
  if (const auto profile = body.choice("profile", {"paper", "refined"}))
    response.profile = *profile == 0 ? Profile::kPaper : Profile::kRefined;
  body.number("stiffness", {0, 1e6, " N/m"}, response.stiffness_n_per_m);
  body.number("smooth_angle_deg", {0, 90, " degrees"}, response.smooth_angle_deg);
  read_length(body, "sample_spacing", response.sample_spacing_m);
  read_length(body, "voxel_size", response.voxel_size_m);
  read_length(body, "tessellation", response.tessellation_m);
  body.number("tessellation_angle_deg", {1, 90, " degrees"}, response.tessellation_angle_deg);
  body.number("budget_us", {0, 1e6, " us"}, response.budget_us);
  int samples = static_cast<int>(response.contact_samples);
  body.whole("contact_samples", 0, 1 << 20, samples);
  response.contact_samples = static_cast<std::uint32_t>(samples);
}

/// A spring that may be "auto".
void read_spring(const SceneObject& object, const char* key, const Limits& limits,
                 std::optional<double>& out) {
  if (!object.has(key) || object.is_auto(key)) return;
  if (object.at(key).is_string())
    object.fail(key, "is " + object.at(key).dump() + "; it must be \"auto\" or a number of" + limits.unit);
  object.number(key, limits, out.emplace());
}

void read_control(const SceneObject& scene_json, Profile profile, ControlSettings& control) {
  if (profile == Profile::kPaper)
    control.law = ForceLaw::kPrinted;  // the chapter's own, unless the file says otherwise
  if (!scene_json.has("control")) return;
  const SceneObject body(scene_json.file(), scene_json.pointer("control"), scene_json.at("control"),
                         keys_of("control"));
  if (const auto law = body.choice("law", {"printed", "corrected"})) {
    control.law = *law == 0 ? ForceLaw::kPrinted : ForceLaw::kCorrected;
    control.law_stated = true;
  }
  if (body.has("transitions") && !body.is_auto("transitions")) {
    if (body.at("transitions").is_string())
      body.fail("transitions",
                "is " + body.at("transitions").dump() + "; it must be \"auto\" or a whole number of ticks");
    body.whole("transitions", 1, 1000, control.transitions.emplace());
  }
  body.whole("virtual_delay_ticks", 1, 1000, control.virtual_delay_ticks);
  body.number("watchdog_ms", {0, 1e4, " ms", true}, control.watchdog_ms);
  body.number("fade_in_ms", {0, 6e4, " ms"}, control.fade_in_ms);
  body.number("change_n_per_s", {0, 1e9, " N/s"}, control.change_n_per_s);
  body.number("slew_ms", {0, 1e4, " ms"}, control.slew_ms);
  if (const auto passivity = body.choice("passivity", {"off", "on"})) control.passivity = *passivity == 1;
  read_spring(body, "coupling_n_per_m", {0, 1e6, " N/m"}, control.coupling_n_per_m);
  read_spring(body, "coupling_nm_per_rad", {0, 1e5, " N·m/rad"}, control.coupling_nm_per_rad);
}

void read_hand(const SceneObject& device_json, DeviceSettings& device) {
  if (!device_json.has("hand")) return;
  const SceneObject body(device_json.file(), device_json.pointer("hand"), device_json.at("hand"),
                         keys_of("hand"));
  body.number("stiffness", {0, 1e5, " N/m"}, device.hand_stiffness_n_per_m);
  body.number("damping", {0, 1e4, " N·s/m"}, device.hand_damping_n_s_per_m);
  body.number("mass", {0, 1e3, " kg"}, device.hand_mass_kg);
  body.number("angular_stiffness", {0, 1e3, " N·m/rad"}, device.hand_angular_stiffness_nm);
  body.number("angular_damping", {0, 1e2, " N·m·s/rad"}, device.hand_angular_damping_nm_s);
}

void read_actuated(const SceneObject& body, DeviceSettings& device) {
  if (!body.has("actuated")) return;
  const std::vector<std::string> axes{"fx", "fy", "fz", "tx", "ty", "tz"};
  std::vector<std::string> named;
  body.texts("actuated", named);
  device.actuated = {};
  for (const std::string& name : named) {
    const auto axis = std::find(axes.begin(), axes.end(), name);
    if (axis == axes.end())
      body.fail("actuated", "has " + json(name).dump() + "; each must be " + listed(axes));
    device.actuated[static_cast<std::size_t>(axis - axes.begin())] = true;
  }
}

/// "axes": ["y", "-x", "z"]: which way of the device the world's x, y and z are. A rotation: nobody can guide
/// a mirrored hand.
void read_axes(const SceneObject& body, WorkspaceSettings& workspace) {
  if (!body.has("axes")) return;
  const std::vector<std::string> ways{"x", "-x", "y", "-y", "z", "-z"};
  std::vector<std::string> named;
  body.texts("axes", named);
  if (named.size() != 3)
    body.fail("axes", "is " + body.at("axes").dump() +
                          "; three ways of the device are wanted, for the world's x, y and z");
  Vec3 rows[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto way = std::find(ways.begin(), ways.end(), named[i]);
    if (way == ways.end())
      body.fail("axes", "has " + json(named[i]).dump() + "; each must be " + listed(ways));
    const auto at = static_cast<std::size_t>(way - ways.begin());
    workspace.axes[i] = {};
    workspace.axes[i][at / 2] = at % 2 == 0 ? 1 : -1;
    rows[i] = {workspace.axes[i][0], workspace.axes[i][1], workspace.axes[i][2]};
  }
  if (glm::dot(glm::cross(rows[0], rows[1]), rows[2]) != 1)
    body.fail("axes", "is " + body.at("axes").dump() +
                          "; each of x, y and z must stand there once, and right-handed");
}

void read_workspace(const SceneObject& device_json, WorkspaceSettings& workspace) {
  if (!device_json.has("workspace")) return;
  const SceneObject body(device_json.file(), device_json.pointer("workspace"), device_json.at("workspace"),
                         keys_of("workspace"));
  body.number("scale", {0, 1e3, " m of the tool for a metre of the hand", true}, workspace.scale);
  if (body.has("offset")) body.vector("offset", kFarthest, " m", workspace.offset_m.emplace());
  read_axes(body, workspace);
  int button = 0;
  body.whole("clutch_button", 1, 32, button);
  if (button > 0) workspace.clutch_buttons = std::uint32_t{1} << (button - 1);
}

/// What a generator's tool does when the file has no path: the generator's own. It doesn't depend on the
/// number of triangles.
void take_generated_motion(const SceneObject* body, Scene& scene) {
  const std::string& generate = scene.tool.source.generate;
  if (generate.empty() || scene.device.driver != "simulated") return;
  GeneratedScene motion = must(generate_scene(generate.substr(0, generate.find('/')), 1'000, 1'000));
  scene.device.path = std::move(motion.path);
  scene.device.guide = std::move(motion.guide);
  if (!body || !body->has("actuated")) scene.device.actuated = motion.actuated;
  if (!body || !body->has("stages")) scene.stage_names = std::move(motion.stage_names);
}

void read_device(const SceneObject& scene_json, Scene& scene) {
  if (!scene_json.has("device")) return take_generated_motion(nullptr, scene);
  const SceneObject body(scene.file, scene_json.pointer("device"), scene_json.at("device"),
                         keys_of("device"));
  DeviceSettings& device = scene.device;
  body.text("driver", device.driver);
  body.number("mass", {0, 1e3, " kg", true}, device.mass_kg);
  body.number("inertia", {0, 1e2, " kg·m²", true}, device.inertia_kg_m2);
  body.number("damping", {0, 1e4, " N·s/m"}, device.damping_n_s_per_m);
  body.number("angular_damping", {0, 1e2, " N·m·s/rad"}, device.angular_damping_nm_s);
  body.number("max_force", {0, 1e3, " N"}, device.max_force_n);
  body.number("max_torque", {0, 1e2, " N·m"}, device.max_torque_nm);
  read_hand(body, device);
  read_actuated(body, device);
  read_workspace(body, device.workspace);
  body.texts("stages", scene.stage_names);
  if (body.has("guide") && !body.has("path"))
    body.fail("guide", "needs \"path\" beside it, which says how to travel along it");
  if (!body.has("path")) return take_generated_motion(&body, scene);

  std::string file;
  if (device.driver == "replay") {
    if (body.has("guide")) body.fail("guide", "is for the simulated device; a replay needs none");
    body.text("path", file);
    device.replay_file = beside(scene.file, file);  // read when the device is made
    return;
  }
  if (body.has("guide")) {
    body.text("guide", file);
    device.guide = must(read_guide(beside(scene.file, file)));
  }
  body.text("path", file);
  device.path = must(read_path(beside(scene.file, file), body.has("guide")));
  for (const PathPoint& point : device.path)
    if (!scene.stage_names.empty() && point.stage > static_cast<int>(scene.stage_names.size()))
      body.fail("stages", "names " + std::to_string(scene.stage_names.size()) +
                              " stages; the path has a stage " + std::to_string(point.stage));
}

/// Where the tool is before anybody moves it.
Pose start_of(const Scene& scene) {
  if (!scene.device.path.empty()) return path_pose(scene.device.path.front(), scene.device.guide);
  if (!scene.tool.source.part.empty())
    for (const StaticBody& body : scene.statics)
      if (body.source.file == scene.tool.source.file && body.source.scale == scene.tool.source.scale)
        return body.placement;
  return {};
}

/// `text_from` gives the text.
template <class Read>
Result<Scene> read(const std::string& path, Read text_from, const GivenMeshes& given,
                   std::optional<Profile> profile) {
  try {
    Scene scene;
    scene.file = path;
    const json text = parse_scene_text(path, text_from());
    const SceneObject root(scene.file, "", text, keys_of("scene"));
    std::string ignored;
    root.text("$schema", ignored);
    root.text("description", ignored);
    read_statics(root, given, scene);
    read_tool(root, given, scene);
    read_response(root, scene.response);
    if (profile) scene.response.profile = *profile;
    read_control(root, scene.response.profile, scene.control);
    read_device(root, scene);
    if (const auto start = root.choice("start", {"as_is", "ignore_initial"}))
      scene.start_contacts = *start == 0 ? StartContacts::kAsIs : StartContacts::kIgnoreInitial;
    scene.start = start_of(scene);
    return scene;
  } catch (const SceneFault& found) {
    return bad_value(one_line(found.sentence));
  } catch (const std::exception&
               found) {  // of the JSON library or the file system: nothing of theirs leaves this file
    return bad_value(one_line(path + " cannot be read: " + found.what()));
  }
}

}  // namespace

Result<Scene> read_scene(const std::string& path, std::optional<Profile> profile) {
  return read(
      path, [&] { return text_of(path); }, {}, profile);
}

Result<Scene> read_scene_text(const std::string& text, const std::string& name, const GivenMeshes& given,
                              std::optional<Profile> profile) {
  return read(
      name,
      [&] {
        if (text.size() > kLargestFile)
          fault(name + " has " + std::to_string(text.size()) + " bytes; a scene has at most " +
                std::to_string(kLargestFile));
        return text;
      },
      given, profile);
}

}  // namespace palpate
