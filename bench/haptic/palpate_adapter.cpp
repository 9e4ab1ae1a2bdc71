// palpate over its C interface, with all settings as they are by default; the spring is its own.
#include "bench/haptic/palpate_adapter.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "service/library/palpate.h"

namespace yardstick {
namespace {

void check(int32_t code, palpate_error* error) {
  if (code == PALPATE_OK) return;
  const std::string sentence = palpate_error_sentence(error);
  palpate_error_free(error);
  throw std::runtime_error("palpate: " + sentence);
}

void add(palpate_source* source, const char* name, const TriMesh& mesh) {
  palpate_error* error = nullptr;
  check(palpate_source_mesh(source, name, &mesh.vertices.data()->x, mesh.vertices.size(),
                            mesh.triangles.data()->data(), mesh.triangles.size(), &error),
        error);
}

class Palpate final : public Adapter {
 public:
  explicit Palpate(const char* engine) : engine_(engine) {}
  Palpate(const Palpate&) = delete;
  Palpate& operator=(const Palpate&) = delete;
  ~Palpate() override {
    palpate_scene_close(scene_);
    palpate_source_free(source_);
  }

  std::string name() const override { return "palpate"; }
  std::string version() const override {
    return std::string(palpate_version()) + ", engine " + engine_ + ", settings by default";
  }

  void prepare(const Case& subject) override {
    palpate_error* error = nullptr;
    source_ = palpate_source_new();
    if (source_ == nullptr) throw std::runtime_error("palpate: no memory");
    add(source_, "fixed", subject.fixed);
    add(source_, "tool", subject.tool);
    const nlohmann::json scene{{"static", {{{"mesh", "fixed"}}}},
                               {"tool", {{"mesh", "tool"}}},
                               {"response", {{"stiffness", subject.stiffness}}}};
    check(palpate_source_text(source_, scene.dump().c_str(), nullptr, &error), error);
    check(palpate_source_engine(source_, engine_, &error), error);
    check(palpate_source_cache(source_, 0, &error), error);
    check(palpate_scene_open(source_, nullptr, &scene_, &error), error);
    const auto said = nlohmann::json::parse(palpate_scene_description(scene_));
    for (int k = 0; k < 3; ++k)
      centre_[k] = said.at("centre_of_mass").at(static_cast<std::size_t>(k)).get<double>();
  }

  Answer answer(const Pose& hand) override {
    const double pose[7] = {hand.position.x, hand.position.y, hand.position.z, hand.rotation.x,
                            hand.rotation.y, hand.rotation.z, hand.rotation.w};
    Answer out;
    uint8_t truncated = 0;
    uint32_t flags = 0;
    palpate_columns columns{};
    columns.size = sizeof columns;
    columns.force = &out.wrench.force.x;
    columns.torque = &out.wrench.torque.x;
    columns.evaluations = &out.evaluations;
    columns.flags = &flags;
    columns.truncated = &truncated;
    palpate_error* error = nullptr;
    check(palpate_query(scene_, pose, 1, &columns, nullptr, &error), error);
    out.settled = truncated == 0 && (flags & PALPATE_FLAG_UNSETTLED) == 0;
    // Its torque is about its own centre, which an open body has elsewhere.
    out.wrench.torque += glm::cross(hand.rotation * centre_, out.wrench.force);
    return out;
  }

 private:
  const char* engine_;
  palpate_source* source_ = nullptr;
  palpate_scene* scene_ = nullptr;
  Vec3 centre_{0};
};

}  // namespace

std::unique_ptr<Adapter> make_palpate() { return std::make_unique<Palpate>("cpu"); }

}  // namespace yardstick
