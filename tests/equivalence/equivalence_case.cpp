#include "tests/equivalence/equivalence_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>

#include "compute/gpu_backend.h"
#include "cpu_ref/cpu_backend.h"
#include "model/response.h"
#include "tests/equivalence/contacts_difference.h"

namespace palpate {
namespace {

std::string text_of(const LatticePose& pose) {
  std::ostringstream text;
  text << "rotation_q30";
  for (const auto& row : pose.rotation_q30)
    for (const std::int32_t entry : row) text << ' ' << entry;
  text << " translation " << pose.translation.x << ' ' << pose.translation.y << ' ' << pose.translation.z;
  return text.str();
}

/// Half a voxel or less from where the tool was, turned as before.
LatticePose moved_on(const LatticePose& from, std::int32_t voxel, std::mt19937_64& random) {
  LatticePose pose = from;
  for (int k = 0; k < 3; ++k) pose.translation[k] += static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(voxel)) - voxel / 2;
  return pose;
}

/// The number in an environment variable, else `otherwise`.
std::uint64_t overridden(const char* variable, std::uint64_t otherwise) {
  const char* wanted = std::getenv(variable);
  return wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : otherwise;
}

/// Stage times of the device, for the log: a test says nothing of speed.
class Medians {
 public:
  void add(const Contacts& contacts) {
    for (const auto& t : contacts.times) times_[t.stage].push_back(t.us);
  }
  std::string text() {
    std::ostringstream out;
    out.precision(0);
    out << std::fixed;
    for (auto& [stage, us] : times_) {
      std::nth_element(us.begin(), us.begin() + static_cast<std::ptrdiff_t>(us.size() / 2), us.end());
      out << stage << ' ' << us[us.size() / 2] << "  ";
    }
    return out.str();
  }

 private:
  std::map<std::string, std::vector<double>> times_;
};

}  // namespace

void expect_equal_answers(const EquivalenceCase& c) {
  const auto geometry = build_geometry(c.mockup(), c.tool(), c.settings);
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  GpuOptions options;
  options.validation = true;
  auto gpu = make_gpu_backend(options);
  ASSERT_TRUE(gpu) << gpu.error().sentence;
  const auto cpu = make_cpu_backend();
  Plan plan;
  plan.profile = c.profile;
  plan.est = c.profile == Profile::kRefined;
  for (CollisionBackend* backend : {gpu->get(), cpu.get()}) {
    const auto prepared = backend->prepare(*geometry, plan, [](const char*, double) { return true; });
    ASSERT_TRUE(prepared) << backend->name() << ": " << prepared.error().sentence;
  }

  const std::uint64_t seed = overridden("PALPATE_SEED", c.seed);
  const int poses = static_cast<int>(overridden("PALPATE_POSES", static_cast<std::uint64_t>(c.poses)));
  std::mt19937_64 random(seed);
  Contacts ours, reference;
  ContactResponse response;
  Held held;
  Medians medians;
  std::optional<LatticePose> pose;
  int contacts = 0, areas = 0, wrong = 0;
  for (int i = 0; i < poses; ++i) {
    const bool follow = c.held && pose && i % 8 != 0;
    if (!follow) held = {};
    pose = follow ? moved_on(*pose, geometry->mockup_grid.size, random) : c.pose(*geometry, random);
    const Held* remembered = c.held ? &held : nullptr;
    const auto a = (*gpu)->query(*pose, remembered, ours);
    ASSERT_TRUE(a) << a.error().sentence;
    const auto b = cpu->query(*pose, remembered, reference);
    ASSERT_TRUE(b) << b.error().sentence;
    const std::string difference = first_difference(ours, reference);
    EXPECT_EQ(difference, "") << c.name << ", seed " << seed << ", pose " << i << ": " << text_of(*pose) << " (gpu, cpu)";
    wrong += difference.empty() ? 0 : 1;
    if (wrong == 5) FAIL() << "five poses differ; the rest is not looked at";
    contacts += reference.contact ? 1 : 0;
    areas += static_cast<int>(reference.areas.size());
    if (reference.contact) medians.add(ours);
    respond(reference, *pose, *geometry, c.profile, 1000, response);
    remember(reference, response, held);
  }
  EXPECT_GT(contacts, poses / 10) << c.name << ": hardly any pose touches";
  std::cout << c.name << ": " << poses << " poses, " << contacts << " with contact, " << areas << " areas; median us of contact frames: " << medians.text() << "\n";
}

}  // namespace palpate
