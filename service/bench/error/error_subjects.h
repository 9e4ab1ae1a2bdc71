#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/scene/plan.h"
#include "model/scene/scene.h"

namespace palpate {

/// What a pose's response should be, world frame.
struct ContactTruth {
  Vec3 normal{0};    ///< n_c, unit
  double depth = 0;  ///< d, m
  Vec3 point{0};     ///< cp, m
  Wrench wrench;     ///< of the whole pose, about the tool's centre of mass
};

/// Bodies and poses at which the error of a response is measured.
struct ErrorSubject {
  std::string name;
  SceneMeshes meshes;
  GeometrySettings settings;  ///< what is not swept
  double stiffness_n_per_m = 2000;
  std::vector<Pose> poses;
  std::function<ContactTruth(const Pose&)> truth;  ///< of `paper`, whose d is the mean way through the tool:
                                                   ///< closed form; empty: a converged run stands in for it
  std::function<ContactTruth(const Pose&)>
      field_truth{};  ///< of `refined`, whose d is the mean depth below the nearest face: likewise
  double tessellation_error =
      0;  ///< relative, of d: the polyhedron's truth against the round body's; 0 where both are flat
  std::string about;  ///< a clause for the report
};

/// Four contacts with closed forms of `paper` (METHOD section 8), one of them of `refined`, at places that no
/// symmetry of the sampling grid favours: a sphere in a plane, d = h(3R − h) / 3(2R − h); a lying cylinder, d
/// = S/2a with the segment S over the width 2a; a cube on its corner, d = h/3; and a sphere in an equal one.
/// Round bodies in a plane are judged against the polyhedron's own volume over its section;
/// `tessellation_error` tells how far that is from the round one's. `cells`: the plane's top face is cut into
/// cells × cells × 2 triangles (the plane subjects alone); each ball of the last has about `ball_triangles`.
std::vector<ErrorSubject> closed_form_subjects(int cells, std::uint64_t ball_triangles = 80'000);

/// How far d of a ball of so many triangles in a plane is from the round ball's, at the poses of
/// `sphere_plane`, m: the tessellation's own error.
std::vector<double> tessellation_errors(std::uint64_t triangles);

}  // namespace palpate
