#pragma once
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"
#include "model/result.h"
#include "model/scene/geometry_build.h"
#include "model/scene/plan.h"
#include "model/scene/workspace_settings.h"

namespace palpate {

/// Where triangles come from: a file, a generator by name, or whoever has them in memory.
struct MeshSource {
  std::string file;                             ///< absolute after loading; empty when generated
  std::shared_ptr<const Mesh> given;            ///< in place of the file, whose name it has then
  double scale = 1;                             ///< metres per file unit
  bool scale_stated = false;                    ///< the scene says `units` or `scale`
  std::string part;                             ///< node taken out; empty: all
  std::vector<std::string> without;             ///< nodes left out
  std::optional<double> sheet_thickness_m = 0;  ///< walls of what is open (thicken()); 0: none; empty: auto,
                                                ///< a 64th of the tool, where no inside is bounded
  std::string generate;                         ///< generator name, e.g. "disassembly/mockup"
  std::map<std::string, double> generate_parameters;  ///< "triangles", …
};

/// A body of the mock-up.
struct StaticBody {
  MeshSource source;
  Pose placement;  ///< world from file
};

/// The body in the hand.
struct ToolSettings {
  MeshSource source;
  double mass_kg = 0.3;
  std::optional<Vec3> centre_of_mass_m;  ///< tool frame; empty: auto
};

/// How contacts become force and torque (scene key `response`).
struct ResponseSettings {
  Profile profile = Profile::kRefined;
  double stiffness_n_per_m = 2000;  ///< K
  double smooth_angle_deg = 30;
  std::optional<double> sample_spacing_m;           ///< empty: auto
  std::uint32_t contact_samples = kContactSamples;  ///< SceneGeometry::contact_samples
  double budget_us = 4000;  ///< of a frame in real time, above which it is sampled coarser; 0: none
  std::optional<double> voxel_size_m;  ///< empty: auto
  std::optional<double>
      tessellation_m;  ///< Tessellation::deflection_m; empty: auto, what a sample's spacing asks for
  double tessellation_angle_deg = 15;  ///< Tessellation::angle_deg
};

/// The scene's choice: equation 5 as printed, or with the hand's motion between ticks.
enum class ForceLaw : std::uint8_t { kPrinted, kCorrected };

/// How the 1 kHz loop uses them (scene key `control`).
struct ControlSettings {
  ForceLaw law = ForceLaw::kCorrected;  ///< with the scene's profile; `paper` without a stated one: printed
  bool law_stated = false;              ///< by the file: then it is any profile's
  std::optional<int> transitions;       ///< n; empty: auto (measured age of results)
  int virtual_delay_ticks = 3;
  double watchdog_ms = 20;
  double fade_in_ms = 200;
  double change_n_per_s =
      100;  ///< law `corrected`: force that comes or goes with the areas, not the hand; 0: unlimited
  double slew_ms = 5;      ///< from no force to the device's largest takes at least this long; 0: unlimited
  bool passivity = false;  ///< damping takes back what the wall has made by itself
  std::optional<double> coupling_n_per_m;     ///< virtual coupling: the spring between device and tool, law
                                              ///< `corrected` only; 0: rigid; empty: auto
  std::optional<double> coupling_nm_per_rad;  ///< the same for rotation
};

/// A tick of the hand's intended motion. With a guide, position.x is the travel in m and the rest is unused.
struct PathPoint {
  double time_s = 0;
  Pose pose;            ///< free: tool pose; guided: rotation relative to the guide's frame
  double travel_m = 0;  ///< guided only
  int stage = 0;        ///< numbered from 1; 0: none
};

/// A curve along which a linear actuator moves the tool (the chapter's rig, section 4.2).
struct GuidePoint {
  double travel_m = 0;
  Pose frame;  ///< world from tool when the three rotations are 0
};

/// Which device, and the hand of the simulated one (scene key `device`).
struct DeviceSettings {
  std::string driver = "simulated";
  double mass_kg = 0.5;  ///< apparent, of device and tool
  double inertia_kg_m2 = 2e-3;
  double damping_n_s_per_m = 1;
  double angular_damping_nm_s = 5e-3;
  double hand_stiffness_n_per_m = 135, hand_damping_n_s_per_m = 6.5,
         hand_mass_kg = 0.55;  ///< impedance to the path
  double hand_angular_stiffness_nm = 2, hand_angular_damping_nm_s = 0.05;
  double max_force_n = 20, max_torque_nm = 2;
  std::array<bool, 6> actuated{true, true, true,
                               true, true, true};  ///< fx fy fz tx ty tz; guided: fx is the travel
  std::vector<PathPoint> path;    ///< ascending time; empty: the tool rests at its start pose
  std::vector<GuidePoint> guide;  ///< ascending travel; empty: free motion in 6 degrees of freedom
  WorkspaceSettings workspace;    ///< of a device that a hand holds
  std::string replay_file;        ///< driver `replay`: the recorded trace.csv, absolute after loading
};

/// What becomes of contacts that are there where the tool starts.
enum class StartContacts : std::uint8_t {
  kAsIs,           ///< they push
  kIgnoreInitial,  ///< profile `refined`: a run leaves them out, patch by patch of the mock-up, until they
                   ///< have opened once
};

/// A scene file, read, checked and completed with defaults.
struct Scene {
  std::string file;
  std::vector<StaticBody> statics;
  ToolSettings tool;
  ResponseSettings response;
  ControlSettings control;
  DeviceSettings device;
  StartContacts start_contacts = StartContacts::kAsIs;
  Pose start;                            ///< first path point, else the part's assembled place, else identity
  std::vector<std::string> stage_names;  ///< stage i is stage_names[i − 1]
  std::vector<std::string> warnings;     ///< one sentence each
};

/// A scene with its geometry on the lattice, ready for a back end.
struct LoadedScene {
  Scene scene;
  SceneGeometry geometry;
  bool from_cache = false;  ///< no mesh was read
};

/// A scene's triangles as its files have them.
struct SceneMeshes {
  Mesh mockup;  ///< world frame, m, all static bodies in scene order
  Mesh tool;    ///< tool frame, m
};

}  // namespace palpate
