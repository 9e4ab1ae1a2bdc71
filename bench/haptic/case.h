#pragma once
#include <optional>
#include <string>
#include <vector>

#include "bench/haptic/mesh.h"

namespace yardstick {

/// What is right at a pose, as far as it is known whatever the method. The ideal is a rigid tool that hangs
/// on the hand by a spring of K and Kρ² (ρ: its surface's radius of gyration) and rests where it does not
/// penetrate: the hand feels the spring.
struct Truth {
  std::optional<Vec3> force;   ///< N; 0: there is none
  std::optional<Vec3> torque;  ///< N·m about the tool's centre
  std::optional<Vec3> way;     ///< unit: the force's direction, where how large it is depends on the material
  double scale = 0;            ///< what errors are shares of, N: |F*|, or |T*|/ρ, or K times the overlap
};

/// Two bodies and the poses at which methods are asked.
struct Case {
  std::string name, group;    ///< group: "closed form", "fit", "stiff", "part"
  std::string truth_from;     ///< a sentence
  TriMesh fixed, tool;        ///< the tool about its centre of volume
  double stiffness = 2000;    ///< K, N/m
  double gyration = 0;        ///< ρ, m
  std::vector<Pose> path;     ///< smooth
  std::vector<Truth> truths;  ///< one for each pose of the path, or none
  std::vector<Pose> loop;     ///< closed: its last pose is its first
  Pose rest;                  ///< in contact; the hand trembles there
};

/// How many poses are asked.
struct Amount {
  std::size_t path = 120, loop = 240, rest = 60;
};

/// The cases whose truth is known.
std::vector<Case> closed_forms(const Amount& amount);
std::vector<Case> fits(const Amount& amount);
std::vector<Case> stiff_cases(const Amount& amount);

/// count poses on the straight ways between corners, evenly shared out; turns along the shortest way.
std::vector<Pose> along(const std::vector<Pose>& corners, std::size_t count);

/// Shifts the tool so that it is about its centre of volume, and sets ρ. For tools of any other origin, whose
/// poses have to be shifted as well, see parts.h.
void finish(Case& subject);

}  // namespace yardstick
