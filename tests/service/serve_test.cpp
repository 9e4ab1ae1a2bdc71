// The whole server in this process, with a device that remembers what it was sent and a back end that answers
// at once. The quick test that runs it under the sanitizers; tests/e2e/serve*.py go through the program.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <mutex>
#include <thread>

#include "service/server/server.h"
#include "tests/service/half_space.h"

namespace palpate {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using namespace std::chrono_literals;

/// What reached the device, in order.
struct Sent {
  std::mutex mutex;
  std::vector<double> forces;  ///< N
  bool closed = false;
  bool zero_when_closed = false;
};

/// Is made, and is not plugged in when it is to be opened.
class AbsentDevice final : public HapticDevice {
 public:
  std::string name() const override { return "absent"; }
  DeviceCapabilities capabilities() const override { return {.max_force_n = 8}; }
  Result<void> open() override { return Error{ErrorCode::kNoDevice, "no such device is plugged in"}; }
  void close() noexcept override {}
  DeviceSample read() noexcept override { return {}; }
  void write(const Wrench&, const Vec3&) noexcept override {}
};

/// A hand that presses 0.1 mm deep and stays there.
class RememberingDevice final : public HapticDevice {
 public:
  explicit RememberingDevice(Sent& sent) : sent_(sent) {}
  std::string name() const override { return "remembering"; }
  DeviceCapabilities capabilities() const override {
    return {.sensed = {true, true, true}, .actuated = {true, true, true}, .max_force_n = 8};
  }
  Result<void> open() override { return {}; }
  void close() noexcept override {
    const std::lock_guard lock(sent_.mutex);
    if (!sent_.closed) sent_.zero_when_closed = !sent_.forces.empty() && sent_.forces.back() == 0;
    sent_.closed = true;
  }
  DeviceSample read() noexcept override {
    DeviceSample sample;
    sample.pose.position.z = -1e-4;
    sample.state = DeviceState::kReady;
    return sample;
  }
  void write(const Wrench& wrench, const Vec3&) noexcept override {
    const std::lock_guard lock(sent_.mutex);  // a test's device may
    sent_.forces.push_back(glm::length(wrench.force));
  }

 private:
  Sent& sent_;
};

/// Counts what it is asked.
struct Asked {
  std::atomic<int> made{0}, poses{0}, partitions{0};
};
class CountingBackend final : public HalfSpace {
 public:
  CountingBackend(Asked& all, std::atomic<int>& mine) : all_(all), mine_(mine) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    ++mine_;
    return HalfSpace::query(pose, ignored, out);
  }
  Result<VoxelPartition> partition(bool tool) const override {
    ++all_.partitions;
    return HalfSpace::partition(tool);
  }

 private:
  Asked& all_;
  std::atomic<int>& mine_;
};

class Serve : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::filesystem::temp_directory_path() / ("palpate_serve_test_" + std::to_string(::getpid()));
    std::filesystem::create_directory(folder_);
    std::ofstream(folder_ / "scene.json")
        << R"({"static":[{"generate":{"name":"contacts","body":"mockup","triangles":2000}}],)"
           R"("tool":{"generate":{"name":"contacts","body":"tool","triangles":1000}},"device":{"driver":"remembering"}})";
    port_ = free_port();
    parts_.make_gpu = [](bool) -> Result<std::unique_ptr<CollisionBackend>> {
      return Error{ErrorCode::kNoDevice, "none here"};
    };
    parts_.has_gpu = [] { return false; };
    parts_.make_ref = [] {
      return std::make_unique<CountingBackend>(
          asked_, queries_[static_cast<std::size_t>(asked_.made++) % queries_.size()]);
    };
    parts_.make_cpu = [](bool) {
      return std::make_unique<CountingBackend>(
          asked_, queries_[static_cast<std::size_t>(asked_.made++) % queries_.size()]);
    };
    parts_.make_device = [](const std::string& name, const Scene&, const Vec3&,
                            const std::string&) -> Result<std::unique_ptr<HapticDevice>> {
      if (name == "absent") return std::unique_ptr<HapticDevice>(std::make_unique<AbsentDevice>());
      return std::unique_ptr<HapticDevice>(std::make_unique<RememberingDevice>(sent_));
    };
    parts_.list_devices = [] { return std::vector<DeviceLine>(); };
    server_ = std::thread([] {
      ServeOptions options;
      options.listen = "127.0.0.1:" + std::to_string(port_);
      options.root = folder_.string();
      options.backend = "cpu";
      outcome_ = serve(options, parts_);
      returned_ = true;
    });
    until([] { return !returned_ && ask("GET", "/readyz").find(" 200 ") != std::string::npos; });
    const std::string scene = ask("POST", "/v1/scenes", R"({"path":"scene.json"})");
    scene_ = field(scene, "id");
    until([] { return field(ask("GET", "/v1/scenes/" + scene_ + "?wait=10"), "state") == "ready"; });
  }
  static void TearDownTestSuite() {
    if (server_.joinable()) {
      ::kill(::getpid(), SIGTERM);
      server_.join();
    }
    std::filesystem::remove_all(folder_);
  }

  template <class Condition>
  static void until(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + 60s;  // a hang is a failure
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) FAIL() << "it does not come about";
      std::this_thread::sleep_for(5ms);
    }
  }
  static int free_port() {
    const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(probe, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
    ::close(probe);
    return ntohs(address.sin_port);
  }
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  /// The whole answer, head and all; empty when nobody is there.
  static std::string ask(const std::string& method, const std::string& path, const std::string& body = "",
                         const std::string& more = "Connection: close\r\n") {
    const int link = ::socket(AF_INET, SOCK_STREAM, 0);
    const sockaddr_in address = loopback(port_);
    std::string answer;
    if (::connect(link, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      const std::string request =
          method + " " + path + " HTTP/1.1\r\nHost: localhost\r\n" + more +
          (body.empty() ? ""
                        : "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) +
                              "\r\n") +
          "\r\n" + body;
      if (::send(link, request.data(), request.size(), MSG_NOSIGNAL) ==
          static_cast<ssize_t>(request.size())) {
        char piece[4096];
        for (ssize_t got = 0; (got = ::recv(link, piece, sizeof piece, 0)) > 0;)
          answer.append(piece, static_cast<std::size_t>(got));
      }
    }
    ::close(link);
    return answer;
  }
  static std::string field(const std::string& json, const std::string& name) {
    const std::string key = "\"" + name + "\":\"";
    const auto at = json.find(key);
    if (at == std::string::npos) return "";
    const auto from = at + key.size();
    return json.substr(from, json.find('"', from) - from);
  }
  static std::string start_session() {
    return field(ask("POST", "/v1/sessions", "{\"scene\":\"" + scene_ + "\"}"), "id");
  }
  static std::string batch(int poses) {
    std::string body = "{\"poses\":[";
    for (int i = 0; i < poses; ++i) body += std::string(i ? "," : "") + "[0,0,-0.0001,0,0,0,1]";
    return ask("POST", "/v1/scenes/" + scene_ + "/query", body + "]}");
  }
  static double last_force() {
    const std::lock_guard lock(sent_.mutex);
    return sent_.forces.empty() ? 0 : sent_.forces.back();
  }

  static inline std::filesystem::path folder_;
  static inline int port_ = 0;
  static inline Sent sent_;
  static inline Asked asked_;
  static inline std::array<std::atomic<int>, 4> queries_{};  ///< of the first back end made, the second, …
  static inline Parts parts_;
  static inline Result<void> outcome_ = Error{};
  static inline std::atomic<bool> returned_{false};
  static inline std::thread server_;
  static inline std::string scene_;
};

TEST_F(Serve, ABatchAloneUsesTheScenesBackEnd) {
  EXPECT_THAT(batch(100), HasSubstr("\"contact\":true"));
  EXPECT_EQ(asked_.made, 1);
  EXPECT_EQ(queries_[0], 200) << "each pose, and where the tool hangs meanwhile";
}

TEST_F(Serve, BesideASessionABatchHoldsNothingThatTheLoopNeeds) {
  const std::string session = start_session();
  until([] { return last_force() > 0.1; });
  EXPECT_THAT(batch(300), HasSubstr("\"contact\":true"));
  EXPECT_EQ(asked_.made, 2);
  EXPECT_EQ(queries_[1], 600);
  EXPECT_THAT(ask("GET", "/v1/scenes/" + scene_ + "/voxels"), StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(asked_.partitions, 1);
  EXPECT_EQ(asked_.made, 2);
  EXPECT_EQ(field(ask("DELETE", "/v1/sessions/" + session), "state"), "ended");
  EXPECT_TRUE(sent_.closed && sent_.zero_when_closed);
}

// It was 201, and then a session that had failed by "a fault of ours".
TEST_F(Serve, ADeviceThatIsNotPluggedInIsToldAtOnceAndLeavesNothing) {
  const std::string before = ask("GET", "/v1/sessions");
  for (int i = 0; i < 2; ++i) {  // the recording's name is free again
    const std::string answer =
        ask("POST", "/v1/sessions", "{\"scene\":\"" + scene_ + R"(","device":"absent","record":"try"})");
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 409 "));
    EXPECT_EQ(field(answer, "type"), "urn:palpate:problem:no-device");
    EXPECT_EQ(field(answer, "field"), "device");
    EXPECT_EQ(field(answer, "detail"), "no such device is plugged in");
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "try"));
  EXPECT_EQ(ask("GET", "/v1/sessions"), before);
}

// The last: afterwards nobody is there.
TEST_F(Serve, SigtermInMidSessionSendsZeroForceFirst) {
  {
    const std::lock_guard lock(sent_.mutex);
    sent_.forces.clear();
    sent_.closed = sent_.zero_when_closed = false;
  }
  start_session();
  until([] { return last_force() > 0.1; });
  // Others are busy with it meanwhile; none may hold up the zero.
  std::atomic<bool> done{false};
  std::vector<std::thread> others;
  others.emplace_back([&] {
    while (!done) batch(1000);
  });
  others.emplace_back([&] {
    while (!done) ask("GET", "/v1/sessions");
  });
  others.emplace_back([&] {
    while (!done) ask("GET", "/metrics");
  });
  std::this_thread::sleep_for(200ms);
  ::kill(::getpid(), SIGTERM);
  server_.join();
  done = true;
  for (std::thread& other : others) other.join();
  EXPECT_TRUE(outcome_) << outcome_.error().sentence;
  const std::lock_guard lock(sent_.mutex);
  EXPECT_GT(sent_.forces.size(), 10u);
  EXPECT_TRUE(sent_.closed);
  EXPECT_TRUE(sent_.zero_when_closed);
  EXPECT_EQ(sent_.forces.back(), 0);  // and nothing came after
}

}  // namespace
}  // namespace palpate
