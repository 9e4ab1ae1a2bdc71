// The program itself, unmodified, on an emulated USB bus: the real libusb finds, opens and loses the devices.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "driver/falcon/falcon_device.h"
#include "driver/falcon/kinematics.h"
#include "driver/falcon/packet.h"
#include "driver/spacemouse/report.h"
#include "tests/driver/fake_usb/falcon_model.h"
#include "tests/driver/fake_usb/testbed_front.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using falcon::MotorCounts;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr std::size_t kFirmwareBytes = 1000;
constexpr MotorCounts kNone{0, 0, 0};

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

/// The program, started; its output goes to files.
class Program {
 public:
  Program(const fs::path& folder, const std::vector<std::string>& arguments, bool as_nobody = false,
          const std::string& terminal = {})
      : out_(folder / "stdout"), err_(folder / "stderr") {
    std::vector<std::string> words{PALPATE_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = out_, err = terminal.empty() ? err_.string() : terminal;
    child_ = ::fork();
    if (child_ != 0) return;
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 1);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), 2);
    if (as_nobody && ::getuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(126);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ~Program() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  bool alive() {
    if (child_ <= 0) return false;
    int status = 0;
    if (::waitpid(child_, &status, WNOHANG) == 0) return true;
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    child_ = 0;
    return false;
  }
  int code() {
    while (alive()) std::this_thread::sleep_for(10ms);
    return code_;
  }
  void interrupt() { ::kill(child_, SIGINT); }
  void terminate() { ::kill(child_, SIGTERM); }
  std::string out() const { return text_of(out_); }
  std::string err() const { return text_of(err_); }

 private:
  fs::path out_, err_;
  pid_t child_ = 0;
  int code_ = -1;
};

class OnTheBus : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(umockdev_in_mock_environment()) << "run under umockdev-wrapper, as ctest does";
    folder_ = fs::path(testing::TempDir()) / ("palpate_bus_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    fs::permissions(folder_, fs::perms::all);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fake::DeviceCalls calls(fake::FalconModel& model) {
    return {[&model](std::uint8_t r, std::uint16_t v) { return model.control(r, v); },
            [this, &model](std::span<const std::uint8_t> b) {
              model.out(b);
              if (model.motors() != kNone) ++(model.homed() ? forces_homed_ : forces_unhomed_);
            },
            [&model] { return model.in(); }, [&model] { return model.has_bytes(); }};
  }
  void plug_falcon(fake::FalconModel& model) {
    front_ = std::make_unique<fake::TestbedFront>(bed_, calls(model),
                                                  fake::bulk_pair_descriptors(0x0403, 0xcb48), address_++);
  }
  std::string firmware() {
    const fs::path file = folder_ / "firmware.bin";
    std::ofstream out(file, std::ios::binary);
    for (std::size_t i = 0; i < kFirmwareBytes; ++i) out.put(static_cast<char>(i * 37 + i / 256));
    return file;
  }
  /// The program's list of haptic devices.
  std::string devices(bool as_nobody = false) {
    Program program(folder_, {"devices"}, as_nobody);
    EXPECT_EQ(program.code(), 0) << program.err();
    return program.out();
  }
  template <class Condition>
  bool comes(Program& program, Condition condition) {
    for (int i = 0; i < 6000 && program.alive(); ++i) {  // a minute: only a hang takes so long
      if (front_->locked(condition)) return true;
      std::this_thread::sleep_for(10ms);
    }
    return false;
  }

  /// The model's grip: at `way_m_` from the middle, outwards, on its way to `wanted_m_` by 0.02 mm a report.
  void hold(fake::FalconModel& model) {
    model.encoders = [this](int) {
      way_m_ += std::clamp(wanted_m_ - way_m_, -2e-5, 2e-5);
      const auto angles = falcon::angles_of_position(falcon::kCentre + Vec3(0, 0, way_m_));
      falcon::Encoders counts{};
      if (angles)
        for (std::size_t i = 0; i < 3; ++i)
          counts[i] = static_cast<std::int16_t>(std::lround(falcon::counts_of_angle((*angles)[i])));
      return counts;
    };
  }

  double way_m_ = 0, wanted_m_ = 0;
  fake::Testbed bed_;
  std::unique_ptr<fake::TestbedFront> front_;
  fs::path folder_;
  int address_ = 4;
  int forces_homed_ = 0, forces_unhomed_ = 0;  // commands with force, by whether the model was homed
};

TEST_F(OnTheBus, NothingIsPluggedIn) { EXPECT_THAT(devices(), HasSubstr("not usable  not plugged in")); }

TEST_F(OnTheBus, AFalconWithoutItsFirmwareSaysSo) {
  fake::FalconModel model;
  plug_falcon(model);
  EXPECT_THAT(devices(),
              HasSubstr("Novint Falcon, 3 forces; firmware missing: name your file with --firmware"));
}

TEST_F(OnTheBus, AFalconThatRunsSaysSo) {
  fake::FalconModel model({}, true);
  plug_falcon(model);
  EXPECT_THAT(devices(), HasSubstr("Novint Falcon, 3 forces; its firmware runs"));
  EXPECT_EQ(forces_homed_ + forces_unhomed_, 0);
}

TEST_F(OnTheBus, ADeviceInUseSaysSo) {
  fake::FalconModel model({}, true);
  plug_falcon(model);
  front_->faults.busy = true;
  EXPECT_THAT(devices(), HasSubstr("not usable  USB device 0403:cb48 is in use by another program"));
}

TEST_F(OnTheBus, WithoutPermissionTheRuleToAddIsNamed) {
  fake::FalconModel model({}, true);
  plug_falcon(model);
  fs::permissions(bed_.root(), fs::perms::all);  // the hot-plug messages' sockets come to lie there
  // The emulation's own sockets stay open to all: what is to be refused is the device.
  for (const auto& entry : fs::recursive_directory_iterator(bed_.root()))
    if (entry.is_socket()) fs::permissions(entry.path(), fs::perms::all);
  ASSERT_EQ(::chmod((bed_.root() + front_->node()).c_str(), ::getuid() == 0 ? 0600 : 0), 0);
  EXPECT_THAT(
      devices(true),
      HasSubstr("not usable  USB device 0403:cb48 may not be opened by this user: install 70-palpate.rules"));
}

TEST_F(OnTheBus, ASpaceMouseThatTheKernelHasIsTakenOver) {
  const UsbId id = spacemouse::kModels.front();
  fake::DeviceCalls quiet{[](std::uint8_t, std::uint16_t) { return true; },
                          [](std::span<const std::uint8_t>) {}, [] { return std::vector<std::uint8_t>{}; },
                          [] { return false; }};
  front_ = std::make_unique<fake::TestbedFront>(bed_, quiet, fake::hid_descriptors(id.vendor, id.product),
                                                address_++);
  front_->faults.kernel_driver = true;
  EXPECT_THAT(devices(), HasSubstr("the kernel's own driver has it now, palpate takes it over for a run"));
  EXPECT_TRUE(front_->faults.kernel_driver) << "a list leaves it where it is";
}

TEST_F(OnTheBus, EveryModelOfTheSpaceMouseIsFoundAndNoOrdinaryMouseOfItsMaker) {
  fake::DeviceCalls quiet{[](std::uint8_t, std::uint16_t) { return true; },
                          [](std::span<const std::uint8_t>) {}, [] { return std::vector<std::uint8_t>{}; },
                          [] { return false; }};
  const auto found = [&](UsbId id) {
    front_ = std::make_unique<fake::TestbedFront>(bed_, quiet, fake::hid_descriptors(id.vendor, id.product),
                                                  address_++);
    const auto list = list_usb_devices(spacemouse::kModels);
    EXPECT_TRUE(list) << list.error().sentence;
    return list && list->size() == 1 && list->front().usable && list->front().id == id;
  };
  for (const UsbId id : spacemouse::kModels) EXPECT_TRUE(found(id)) << std::hex << id.product;
  for (std::uint16_t product = 0xc650; product <= 0xc658; ++product) {
    if (std::find(spacemouse::kModels.begin(), spacemouse::kModels.end(), UsbId{0x256f, product}) ==
        spacemouse::kModels.end()) {
      EXPECT_FALSE(found({0x256f, product})) << std::hex << product;
    }
  }
}

TEST_F(OnTheBus, OnATerminalTheLiveLineSaysWhatToDo) {
  fake::FalconModel model({}, true);
  model.homes_after = 1'000'000;  // nobody homes it
  plug_falcon(model);
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal) | ::unlockpt(terminal), 0);
  winsize size{.ws_row = 40, .ws_col = 200, .ws_xpixel = 0, .ws_ypixel = 0};
  ::ioctl(terminal, TIOCSWINSZ, &size);
  const std::string shown_on = ::ptsname(terminal);
  ::setenv("TERM", "xterm", 1);
  Program program(folder_,
                  {"run", PALPATE_SCENE, "--device", "falcon", "--backend", "cpu", "--out", folder_ / "run"},
                  false, shown_on);
  ::fcntl(terminal, F_SETFL, O_NONBLOCK);
  std::string shown;
  for (int i = 0;
       i < 6000 && program.alive() && shown.find("home the Falcon: pull the grip") == std::string::npos;
       ++i) {
    char bytes[4096];
    for (ssize_t n; (n = ::read(terminal, bytes, sizeof bytes)) > 0;)
      shown.append(bytes, static_cast<std::size_t>(n));
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_THAT(shown,
              HasSubstr(" s  home the Falcon: pull the grip all the way out, then push it all the way in"));
  program.interrupt();
  for (int i = 0; i < 3000 && program.alive(); ++i) {  // a full terminal would hold it up
    char bytes[4096];
    while (::read(terminal, bytes, sizeof bytes) > 0) {
    }
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(program.code(), 0);
  EXPECT_EQ(forces_homed_ + forces_unhomed_, 0);
  ::close(terminal);
}

/// Columns of trace.csv.
struct Ticks {
  std::vector<double> z, force,
      response;  ///< force: the length of what was sent, response: of what the back end found
};

Ticks ticks_of(const fs::path& trace) {
  Ticks ticks;
  std::ifstream in(trace);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<double> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      row.push_back(std::strtod(cell.c_str(), &end));  // std::stod throws at a number below 1e-307
      EXPECT_TRUE(end != cell.c_str() && *end == '\0') << "not a number: " << cell;
    }
    if (row.size() < 17) continue;
    ticks.z.push_back(row[3]);
    ticks.force.push_back(std::hypot(row[8], row[9], row[10]));
    ticks.response.push_back(std::hypot(row[14], row[15], row[16]));
  }
  return ticks;
}

// The whole way of a person with a Falcon: firmware, homing, contact; the plug comes out while the clamp
// presses on the pipe and goes in again.
TEST_F(OnTheBus, TheChaptersSceneIsFeltLostAndFeltAgain) {
  fake::FalconModel model;
  model.firmware_size = kFirmwareBytes;
  model.homes_after = 200;
  hold(model);  // then 12 mm further out: there the clamp meets the pipe
  plug_falcon(model);
  Program program(folder_, {"run", PALPATE_SCENE, "--device", "falcon", "--firmware", firmware(), "--backend",
                            "cpu", "--out", folder_ / "run"});
  ASSERT_TRUE(comes(program, [&] { return model.homed(); })) << program.err();
  EXPECT_EQ(model.loads(), 1);
  front_->locked([&] { return wanted_m_ = 0.012; });
  ASSERT_TRUE(comes(program, [&] { return model.motors() != kNone && way_m_ > 0.0119; }))
      << "no contact force: " << program.err();
  const int reports = front_->locked([&] { return model.reports(); });
  ASSERT_TRUE(comes(program, [&] { return model.reports() > reports + 500; }));  // faded in

  front_->unplug();
  std::this_thread::sleep_for(500ms);
  // It hears of the loss by the first transfer that fails, so at most a packet that was being sent still had
  // force; the next control tick has none.
  int too_late = 0;
  for (const auto& bytes : front_->sent_too_late()) {
    ASSERT_EQ(bytes.size(), falcon::kPacketBytes);
    const auto command = falcon::decode_command(
        std::span<const std::uint8_t, falcon::kPacketBytes>(bytes.data(), falcon::kPacketBytes));
    ASSERT_TRUE(command);
    too_late += command->motors != kNone;
  }
  EXPECT_LE(too_late, 1);
  ASSERT_TRUE(program.alive()) << program.err();

  model.power_cycle();
  forces_homed_ = forces_unhomed_ = 0;
  plug_falcon(model);
  ASSERT_TRUE(comes(program, [&] { return model.homed(); })) << program.err();
  ASSERT_TRUE(comes(program, [&] { return model.motors() != kNone; }))
      << "force does not come back: " << program.err();
  EXPECT_EQ(model.loads(), 2);
  EXPECT_EQ(forces_unhomed_, 0) << "force before homing";

  program.interrupt();
  ASSERT_EQ(program.code(), 0) << program.err();
  EXPECT_EQ(front_->locked([&] { return model.motors(); }), kNone) << "the run's end is without force";
  const std::string said = program.err();
  EXPECT_THAT(said, HasSubstr("loading the Falcon's firmware"));
  EXPECT_THAT(said, HasSubstr("home the Falcon: pull the grip all the way out"));
  EXPECT_THAT(said, HasSubstr("the Falcon is gone; plug it in again"));
  EXPECT_THAT(said, HasSubstr("was not ready (unplugged, loading, homing) in "));

  // As recorded: force, then none for as long as the plug was out and the device homed, then force.
  const Ticks ticks = ticks_of(folder_ / "run" / "trace.csv");
  const auto pushes = [](double force) { return force > 0; };
  const auto first = std::find_if(ticks.force.begin(), ticks.force.end(), pushes);
  ASSERT_NE(first, ticks.force.end());
  std::size_t longest = 0, quiet = 0;
  for (auto at = first; at != ticks.force.end(); ++at) {
    quiet = pushes(*at) ? 0 : quiet + 1;
    longest = std::max(longest, quiet);
  }
  EXPECT_GT(longest, 400u) << "ticks without force while the plug was out";
  // On a busy machine results come too late and the watchdog takes most of the force away; what was found is
  // what it is.
  EXPECT_GT(*std::max_element(ticks.response.begin(), ticks.response.end()), 2.0)
      << "N; the scene says 2.75 at 10 mm";
  EXPECT_LE(*std::max_element(ticks.force.begin(), ticks.force.end()), 8.0 + 1e-9)
      << "the device's rating, N";

  // What was recorded from it can be done again without it: the same places at the same times, to the bit.
  Program again(folder_,
                {"run", PALPATE_SCENE, "--device", "replay:" + (folder_ / "run" / "trace.csv").string(),
                 "--pace", "asap", "--duration", "0.2", "--backend", "cpu", "--out", folder_ / "again"});
  ASSERT_EQ(again.code(), 0) << again.err();
  const std::vector<double> replayed = ticks_of(folder_ / "again" / "trace.csv").z;
  ASSERT_EQ(replayed.size(), 200u);
  EXPECT_EQ(replayed.front(), ticks.z.front());
}

/// What follows `before` in `text`, up to `end`; empty: it is not there yet.
std::string between(const std::string& text, const std::string& before, char end) {
  const auto at = text.find(before);
  return at == std::string::npos
             ? ""
             : text.substr(at + before.size(), text.find(end, at + before.size()) - at - before.size());
}

/// A server's whole answer on this machine.
std::string ask(const std::string& port, const std::string& method, const std::string& path,
                const std::string& body = "") {
  const int link = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  const std::string request = method + " " + path +
                              " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: "
                              "application/json\r\nContent-Length: " +
                              std::to_string(body.size()) + "\r\n\r\n" + body;
  if (::connect(link, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      ::send(link, request.data(), request.size(), MSG_NOSIGNAL) > 0) {
    char piece[4096];
    for (ssize_t got = 0; (got = ::recv(link, piece, sizeof piece, 0)) > 0;)
      answer.append(piece, static_cast<std::size_t>(got));
  }
  ::close(link);
  return answer;
}

// The server with a session on the Falcon, while the clamp presses on the pipe.
TEST_F(OnTheBus, AServerThatIsToldToStopSendsZeroFirst) {
  fake::FalconModel model({}, true);
  model.homes_after = 200;
  hold(model);
  plug_falcon(model);
  const fs::path scene = PALPATE_SCENE;
  Program program(folder_,
                  {"serve", "--listen", "127.0.0.1:0", "--root", scene.parent_path(), "--backend", "cpu"});
  std::string port;
  ASSERT_TRUE(comes(program, [&] {
    return !(port = between(program.err(), R"("address":"127.0.0.1:)", '"')).empty();
  })) << program.err();
  const std::string id = between(
      ask(port, "POST", "/v1/scenes", "{\"path\":\"" + scene.filename().string() + "\"}"), "\"id\":\"", '"');
  ASSERT_TRUE(comes(program, [&] {
    return between(ask(port, "GET", "/v1/scenes/" + id + "?wait=10"), "\"state\":\"", '"') == "ready";
  })) << program.err();
  const std::string session =
      ask(port, "POST", "/v1/sessions", "{\"scene\":\"" + id + R"(","device":"falcon"})");
  ASSERT_THAT(session, HasSubstr(R"("state":"running")"));
  ASSERT_TRUE(comes(program, [&] { return model.homed(); })) << program.err();
  front_->locked([&] { return wanted_m_ = 0.012; });
  ASSERT_TRUE(comes(program, [&] { return model.motors() != kNone && way_m_ > 0.0119; }))
      << "no contact force: " << program.err();
  EXPECT_EQ(forces_unhomed_, 0) << "force before homing";

  program.terminate();
  // What tells the world that the session is over comes after the zero, not before.
  ASSERT_TRUE(
      comes(program, [&] { return program.err().find("\"event\":\"session_over\"") != std::string::npos; }) ||
      program.code() == 0)
      << program.err();
  const int forces = front_->locked([&] { return forces_homed_; });
  EXPECT_EQ(front_->locked([&] { return model.motors(); }), kNone);
  EXPECT_EQ(program.code(), 0) << program.err();
  EXPECT_EQ(front_->locked([&] { return model.motors(); }), kNone);
  EXPECT_EQ(front_->locked([&] { return forces_homed_; }), forces) << "force after the session's end";
  const std::string log = program.err();
  EXPECT_LT(log.find("\"event\":\"stopping\""), log.find("\"event\":\"session_over\""));
  EXPECT_LT(log.find("\"event\":\"session_over\""), log.find("\"event\":\"stopped\""));
}

}  // namespace
}  // namespace palpate
