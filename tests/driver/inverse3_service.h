#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "model/lattice/pose.h"

namespace palpate::fake {

/// What the stand-in's devices are at, and how it misbehaves. Read and written under its lock.
struct Inverse3Model {
  Vec3 cursor{0.01, -0.11, 0.16};
  Quat grip{1, 0, 0, 0};
  bool a = false, b = false;
  bool ready = true;
  bool plugged = true;        ///< the arm is in the lists
  bool has_grip = true;       ///< a grip is in the lists
  bool grip_speaks = true;    ///< the grip's state has an orientation
  bool session_ids = true;    ///< as from service 3.5 on: forces come as "vector", else as "values"
  bool silent = false;        ///< takes messages, answers none
  bool wordless = false;      ///< takes connections and says nothing at all
  std::string garbage;        ///< what it answers instead of a state, where not empty
  Vec3 force{0};              ///< the last one that it was sent
  std::uint64_t forces = 0;   ///< messages with a force in the spelling that it knows
  std::uint64_t strange = 0;  ///< messages that it doesn't understand
};

/// Stands for the service of Haply's devices: speaks its published protocol on a port of 127.0.0.1, to one
/// client at a time. Written from the protocol's description, against which it is as good as that reading.
class Inverse3Service {
 public:
  Inverse3Service();
  ~Inverse3Service();
  Inverse3Service(const Inverse3Service&) = delete;
  Inverse3Service& operator=(const Inverse3Service&) = delete;

  std::uint16_t port() const { return port_; }
  /// The service ends, connections with it, and comes back on the same port.
  void stop();
  void start();

  template <class Change>
  auto locked(Change change) {
    const std::lock_guard lock(mutex_);
    return change(model);
  }
  Inverse3Model model;

 private:
  struct Server;
  void serve();
  void answer(const std::string& message);
  nlohmann::json devices(bool inventory) const;

  std::mutex mutex_;
  std::uint16_t port_ = 0;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

}  // namespace palpate::fake
