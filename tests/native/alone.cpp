// A program of the native engine alone: a ball on a block, its force told.
#include <cstdio>

#include "compute/native/native_backend.h"
#include "model/contact/response.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"

int main() {
  using namespace palpate;
  const auto geometry =
      build_geometry(solids::box(Vec3(-0.1, -0.1, -0.05), Vec3(0.1, 0.1, 0)), solids::sphere(0.02), {});
  if (!geometry) return 1;
  const auto backend = make_native_backend();
  if (!backend->prepare(*geometry, Plan{}, {})) return 1;
  const auto pose = to_lattice(Pose{Vec3(0, 0, 0.018), Quat(1, 0, 0, 0)}, *geometry);
  Contacts contacts;
  if (!pose || !backend->query(*pose, nullptr, contacts) || !contacts.contact) return 1;
  ContactResponse response;
  respond(contacts, *pose, *geometry, Profile::kRefined, 2000, response);
  std::printf("%s on %s: %g N\n", contacts.engine, backend->device().c_str(), response.wrench.force.z);
  return response.wrench.force.z > 0 ? 0 : 1;
}
