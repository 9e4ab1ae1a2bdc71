// Finds a way out for a part: OMPL's RRT-Connect plans, palpate says whether a pose is free and a motion
// clear.
//
//   way_out SCENE.json DX DY DZ [SECONDS]     from the scene's start pose to the same moved by DX DY DZ
//   metres
//
// Prints the poses of the way, a line each: x y z qx qy qz qw. Between two of them the part moves on a screw,
// as `palpate path` checks it and palpate_first_contact decides it: never a contact overlooked between
// samples.
#include <ompl/base/MotionValidator.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>
#include <palpate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

namespace ob = ompl::base;
using Pose = std::array<double, 7>;  // x y z (m) qx qy qz qw, world from tool

/// A planner can't go on without an answer, so a fault ends the program with palpate's sentence and code.
void must(std::int32_t code, palpate_error* error) {
  if (code == PALPATE_OK) return;
  std::fprintf(stderr, "way_out: %s\n", palpate_error_sentence(error));
  std::exit(code);
}

Pose pose_of(const ob::State* state) {
  const auto& at = *state->as<ob::SE3StateSpace::StateType>();
  const auto& q = at.rotation();
  return {at.getX(), at.getY(), at.getZ(), q.x, q.y, q.z, q.w};
}

void set(ob::State* state, const Pose& pose) {
  auto& at = *state->as<ob::SE3StateSpace::StateType>();
  at.setXYZ(pose[0], pose[1], pose[2]);
  auto& q = at.rotation();
  q.x = pose[3], q.y = pose[4], q.z = pose[5], q.w = pose[6];
}

/// Valid: the part touches nothing there, and does not lie inside anything.
class Free : public ob::StateValidityChecker {
 public:
  Free(const ob::SpaceInformationPtr& space, palpate_scene* scene)
      : StateValidityChecker(space), scene_(scene) {}
  bool isValid(const ob::State* state) const override {
    if (!si_->satisfiesBounds(state)) return false;
    const Pose pose = pose_of(state);
    std::uint8_t touches = 1;
    palpate_error* error = nullptr;
    must(palpate_touches(scene_, pose.data(), 1, 0, &touches, nullptr, &error), error);
    return touches == 0;
  }

 private:
  palpate_scene* scene_;
};

/// Valid: the screw between two poses is clear all the way, for certain.
class Clear : public ob::MotionValidator {
 public:
  Clear(const ob::SpaceInformationPtr& space, palpate_scene* scene) : MotionValidator(space), scene_(scene) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    double time = 0;
    Pose there;
    return clear(from, to, time, there);
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last) const override {
    Pose there;
    const bool whole = clear(from, to, last.second, there);
    if (!whole && last.first != nullptr) set(last.first, there);
    return whole;
  }

 private:
  bool clear(const ob::State* from, const ob::State* to, double& time, Pose& there) const {
    const Pose begin = pose_of(from), end = pose_of(to);
    std::uint8_t kind = PALPATE_MOTION_UNDECIDED;
    palpate_motions found{};
    found.size = sizeof found;
    found.kind = &kind, found.time = &time, found.pose = there.data();
    palpate_error* error = nullptr;
    must(palpate_first_contact(scene_, begin.data(), end.data(), 1, 0, &found, nullptr, &error), error);
    return kind == PALPATE_MOTION_CLEAR;
  }

  palpate_scene* scene_;
};

/// The scene's start pose, out of its description.
Pose start_of(const palpate_scene* scene) {
  Pose start{0, 0, 0, 0, 0, 0, 1};
  const char* found = std::strstr(palpate_scene_description(scene), "\"start\":[");
  if (found == nullptr) return start;
  char* next = const_cast<char*>(found + std::strlen("\"start\":["));
  for (double& value : start) value = std::strtod(next, &next), ++next;
  return start;
}

int main(int count, char** words) {
  if (count < 5) return std::fprintf(stderr, "usage: way_out SCENE.json DX DY DZ [SECONDS]\n"), 2;
  palpate_scene* scene = nullptr;
  palpate_error* error = nullptr;
  must(palpate_scene_open_file(words[1], nullptr, &scene, &error), error);
  const Pose start = start_of(scene);
  Pose goal = start;
  double reach = 0;
  for (int i = 0; i < 3; ++i) goal[i] += std::atof(words[2 + i]), reach += std::pow(goal[i] - start[i], 2);
  reach = std::sqrt(reach);
  const double seconds = count > 5 ? std::atof(words[5]) : 60;
  ompl::RNG::setSeed(1);                         // the same way each time
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);  // standard output is for the way

  // Room to plan in: as far as the goal is, beyond both ends.
  const auto space = std::make_shared<ob::SE3StateSpace>();
  ob::RealVectorBounds bounds(3);
  for (unsigned i = 0; i < 3; ++i) {
    bounds.setLow(i, std::min(start[i], goal[i]) - reach);
    bounds.setHigh(i, std::max(start[i], goal[i]) + reach);
  }
  space->setBounds(bounds);
  ompl::geometric::SimpleSetup setup(space);
  const auto& information = setup.getSpaceInformation();
  setup.setStateValidityChecker(std::make_shared<Free>(information, scene));
  information->setMotionValidator(std::make_shared<Clear>(information, scene));
  setup.setPlanner(std::make_shared<ompl::geometric::RRTConnect>(information));

  ob::ScopedState<ob::SE3StateSpace> from(space), to(space);
  set(from.get(), start), set(to.get(), goal);
  setup.setStartAndGoalStates(from, to);
  if (setup.solve(seconds) != ob::PlannerStatus::EXACT_SOLUTION) {
    std::fprintf(stderr, "way_out: no way within %g s\n", seconds);
    palpate_scene_close(scene);
    return 5;
  }
  setup.simplifySolution(seconds);
  std::puts("x,y,z,qx,qy,qz,qw");
  for (const ob::State* state : setup.getSolutionPath().getStates()) {
    const auto [x, y, z, qx, qy, qz, qw] = pose_of(state);
    std::printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", x, y, z, qx, qy, qz, qw);
  }
  palpate_scene_close(scene);
}
