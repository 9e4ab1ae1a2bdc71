#include "service/bench/error/error_subjects.h"

#include <cmath>
#include <utility>

#include "model/generate/solids.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMm = 1e-3;
constexpr double kStiffness = 2000;  // N/m
constexpr double kHalfBlock = 60 * kMm;

/// V, A and the moment of h over the section, below z = 0, of a closed convex mesh at a pose.
struct Immersed {
  double volume = 0, area = 0;
  Vec3 moment{0};
};

/// Each triangle, clipped at z = 0, stands on a prism up to the plane; what looks down counts plus, what
/// looks up minus.
Immersed immersed(const Mesh& mesh, const Pose& pose) {
  Immersed sum;
  std::vector<Vec3> kept;
  for (const auto& triangle : mesh.triangles) {
    kept.clear();
    for (int i = 0; i < 3; ++i) {
      const auto corner = [&](int k) {
        return pose.rotation * mesh.vertices[triangle[static_cast<std::size_t>(k % 3)]] + pose.position;
      };
      const Vec3 a = corner(i), b = corner(i + 1);
      if (a.z <= 0) kept.push_back(a);
      if ((a.z < 0) != (b.z < 0)) kept.push_back(a + (b - a) * (a.z / (a.z - b.z)));
    }
    for (std::size_t i = 1; i + 1 < kept.size(); ++i) {
      const Vec3 &a = kept[0], &b = kept[i], &c = kept[i + 1];
      const double projected = -0.5 * glm::cross(b - a, c - a).z;
      sum.area += projected;
      sum.volume -= projected * (a.z + b.z + c.z) / 3;
      for (int k = 0; k < 2; ++k)  // ∫ −z·x over a triangle, exact for two linear functions
        sum.moment[k] -= ((a[k] + b[k] + c[k]) * (a.z + b.z + c.z) + a[k] * a.z + b[k] * b.z + c[k] * c.z) /
                         12 * projected;
    }
  }
  return sum;
}

/// The response of plane and mesh; gc is the tool's origin.
ContactTruth plane_truth(const Mesh& tool, const Pose& pose) {
  const Immersed in = immersed(tool, pose);
  ContactTruth truth;
  truth.normal = Vec3(0, 0, 1);
  truth.depth = in.volume / in.area;
  truth.point = Vec3(in.moment.x, in.moment.y, 0) / in.volume;
  truth.wrench.force = kStiffness * truth.depth * truth.normal;
  truth.wrench.torque = glm::cross(truth.point - pose.position, truth.wrench.force);
  return truth;
}

/// Of `refined`: a cube of `side` on its corner in a plane. The nearest of its three faces is √3 h times the
/// least of a place's barycentric coordinates away, a ninth on average; the cube's own push by the volume S h
/// / 3 below the section S (both halved: each body says it once). All of it acts through the cube's middle.
ContactTruth corner_field(double side, const Pose& pose) {
  const double h = side / 2 * std::sqrt(3.0) - pose.position.z, section = 1.5 * std::sqrt(3.0) * h * h,
               reference_area = side * side / 64;
  ContactTruth truth;
  truth.normal = Vec3(0, 0, 1);
  truth.depth = std::sqrt(3.0) / 9 * h;
  truth.point = Vec3(pose.position.x, pose.position.y, 0);
  truth.wrench.force = kStiffness / (2 * reference_area) * section * (truth.depth + h / 3) * truth.normal;
  return truth;
}

/// Places with nothing in common with any grid of samples.
Vec3 place(std::size_t i) {
  return Vec3(3.171 * static_cast<double>(i % 7) - 7.3, 2.339 * static_cast<double>(i % 5) - 5.1, 0) * kMm;
}

struct PlaneForm {
  const char* name;
  Mesh tool;
  Quat rotation;
  double reach;                               // of the lowest point below the tool's origin, m
  std::function<double(double)> round_depth;  // d of the round body, h of its lowest point, m
  const char* about;
};

ErrorSubject plane_subject(PlaneForm form, int cells) {
  ErrorSubject subject;
  subject.name = form.name;
  subject.about = form.about;
  subject.meshes.mockup = solids::box(Vec3(-kHalfBlock, -kHalfBlock, -50 * kMm),
                                      Vec3(kHalfBlock, kHalfBlock, 0), Int3(cells, cells, 1));
  subject.meshes.tool = std::move(form.tool);
  subject.settings.voxel_size_m = 2 * kMm;
  subject.settings.centre_of_mass_m = Vec3(0);
  subject.stiffness_n_per_m = kStiffness;
  for (std::size_t i = 0; i < 30; ++i) {
    const double h = (0.5 + 0.12 * static_cast<double>(i)) * kMm;
    subject.poses.push_back({place(i) + Vec3(0, 0, form.reach - h), form.rotation});
    const double depth = plane_truth(subject.meshes.tool, subject.poses.back()).depth;
    subject.tessellation_error =
        std::max(subject.tessellation_error, std::fabs(depth / form.round_depth(h) - 1));
  }
  subject.truth = [tool = subject.meshes.tool](const Pose& pose) { return plane_truth(tool, pose); };
  return subject;
}

/// Two equal spheres, the mock-up's about the origin. d is the mean over the mock-up's cap, by area, of the
/// way down to the tool's lower side: with u = cos θ, h = 2Ru − D for u from D/2R to 1.
ErrorSubject lens_subject(std::uint64_t triangles) {
  const double radius = 10 * kMm;
  ErrorSubject subject;
  subject.name = "sphere_sphere";
  subject.about = "two spheres of 10 mm, 80,000 triangles each; tessellation included";
  subject.meshes = {solids::sphere_of(radius, triangles), solids::sphere_of(radius, triangles)};
  subject.settings.voxel_size_m = 2 * kMm;
  subject.settings.centre_of_mass_m = Vec3(0);
  subject.stiffness_n_per_m = kStiffness;
  subject.truth = [radius](const Pose& pose) {
    const double distance = glm::length(pose.position), least = distance / (2 * radius);
    const auto integral = [&](int power) {  // of (2Ru − D) u^power
      const auto antiderivative = [&](double u) {
        return 2 * radius * std::pow(u, power + 2) / (power + 2) -
               distance * std::pow(u, power + 1) / (power + 1);
      };
      return antiderivative(1) - antiderivative(least);
    };
    ContactTruth truth;
    truth.normal = pose.position / distance;
    truth.depth = integral(0) / (1 - least);
    truth.point = truth.normal * (radius * integral(1) / integral(0));
    truth.wrench.force = kStiffness * truth.depth * truth.normal;
    truth.wrench.torque = glm::cross(truth.point - pose.position, truth.wrench.force);
    return truth;
  };
  for (std::size_t i = 0; i < 30; ++i) {
    const double h = (0.5 + 0.1 * static_cast<double>(i)) * kMm, turn = 0.77 * static_cast<double>(i),
                 rise = 0.3 + 0.09 * static_cast<double>(i % 11);
    const Vec3 towards(std::cos(rise) * std::cos(turn), std::cos(rise) * std::sin(turn), std::sin(rise));
    subject.poses.push_back({towards * (2 * radius - h),
                             glm::angleAxis(0.3 * static_cast<double>(i), glm::normalize(Vec3(1, 2, 3)))});
  }
  return subject;
}

}  // namespace

std::vector<double> tessellation_errors(std::uint64_t triangles) {
  const double radius = 10 * kMm;
  const Mesh ball = solids::sphere_of(radius, triangles);
  std::vector<double> out;
  for (std::size_t i = 0; i < 30; ++i) {
    const double h = (0.5 + 0.12 * static_cast<double>(i)) * kMm;
    const double depth = plane_truth(ball, {place(i) + Vec3(0, 0, radius - h), Quat(1, 0, 0, 0)}).depth;
    out.push_back(std::fabs(depth - h * (3 * radius - h) / (3 * (2 * radius - h))));
  }
  return out;
}

std::vector<ErrorSubject> closed_form_subjects(int cells, std::uint64_t ball_triangles) {
  const double sphere_radius = 10 * kMm, cylinder_radius = 8 * kMm, half = 10 * kMm;
  const Quat upright(1, 0, 0, 0), about_z = glm::angleAxis(0.37, Vec3(0, 0, 1));
  std::vector<ErrorSubject> subjects;
  subjects.push_back(
      plane_subject({"sphere_plane", solids::sphere_of(sphere_radius, 20'000), upright, sphere_radius,
                     [=](double h) { return h * (3 * sphere_radius - h) / (3 * (2 * sphere_radius - h)); },
                     "a sphere of 10 mm, 20,000 triangles"},
                    cells));
  subjects.push_back(plane_subject(
      {"cylinder_plane",
       solids::moved(solids::cylinder(cylinder_radius, 20 * kMm, 400), Pose{Vec3(0, 0, -10 * kMm), upright}),
       about_z * glm::angleAxis(kPi / 2, Vec3(1, 0, 0)), cylinder_radius,
       [=](double h) {
         const double below = cylinder_radius - h, half_width = std::sqrt(2 * cylinder_radius * h - h * h);
         return (cylinder_radius * cylinder_radius * std::acos(below / cylinder_radius) -
                 below * half_width) /
                (2 * half_width);
       },
       "a lying cylinder of 8 mm by 20 mm, turned by 21° to the grid"},
      cells));
  subjects.push_back(
      plane_subject({"corner_plane", solids::box(Vec3(-half), Vec3(half)),
                     glm::angleAxis(0.61, Vec3(0, 0, 1)) *
                         glm::angleAxis(std::atan(std::sqrt(2.0)), glm::normalize(Vec3(1, -1, 0))),
                     half * std::sqrt(3.0), [](double h) { return h / 3; }, "a cube of 20 mm on its corner"},
                    cells));
  subjects.back().field_truth = [half](const Pose& pose) { return corner_field(2 * half, pose); };
  subjects.push_back(lens_subject(ball_triangles));
  return subjects;
}

}  // namespace palpate
