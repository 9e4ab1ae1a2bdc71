#include "driver/falcon/firmware.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "driver/falcon/packet.h"

namespace palpate::falcon {
namespace {

using std::chrono::milliseconds;

constexpr std::array<std::uint8_t, 3> kGreeting{0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kGreeted{0x0A, 0x44, 0x2C, 0x0D};
constexpr std::array<std::uint8_t, 1> kReady{0x41};
constexpr int kGreetings = 100;
constexpr auto kGreetingTime =
    milliseconds(20);  // four bytes at 9600 baud take 4 ms, the chip's latency timer 16 ms more
constexpr auto kWriteTime = milliseconds(500);
constexpr auto kEchoTime = milliseconds(500);
constexpr int kProbes = 10;
constexpr auto kProbeTime = milliseconds(10);

Error failed(const std::string& step, const std::string& why) {
  return {ErrorCode::kNoDevice,
          "the Falcon's firmware did not load: " + step + (why.empty() ? "" : " (" + why + ")")};
}

/// Runs set-up requests in order; the first that fails is named.
Result<void> in_order(const std::string& step,
                      std::initializer_list<std::function<Result<void>()>> requests) {
  for (const auto& request : requests)
    if (auto done = request(); !done) return failed(step, done.error().sentence);
  return {};
}

Result<void> greet(SerialLine& line, const std::function<bool()>& stop) {
  for (int i = 0; i < kGreetings && !stop() && !line.lost(); ++i) {
    if (auto sent = line.write(kGreeting, kWriteTime); !sent)
      return failed("sending the greeting", sent.error().sentence);
    std::vector<std::uint8_t> answer = line.read(kGreeted.size(), kGreetingTime);
    if (!answer.empty() && answer.front() == 0) {  // some devices lead with a zero
      answer.erase(answer.begin());
      for (const std::uint8_t byte : line.read(kGreeted.size() - answer.size(), kGreetingTime))
        answer.push_back(byte);
    }
    if (std::equal(answer.begin(), answer.end(), kGreeted.begin(), kGreeted.end())) return {};
  }
  return failed("the greeting was not answered", std::to_string(kGreetings) + " tries");
}

Result<void> send_image(SerialLine& line, std::span<const std::uint8_t> image,
                        const std::function<bool()>& stop) {
  const std::size_t chunks = (image.size() + kFirmwareChunk - 1) / kFirmwareChunk;
  for (std::size_t i = 0; i < chunks; ++i) {
    if (stop()) return failed("stopped", "");
    const auto chunk =
        image.subspan(i * kFirmwareChunk, std::min(kFirmwareChunk, image.size() - i * kFirmwareChunk));
    const std::string step = "chunk " + std::to_string(i + 1) + " of " + std::to_string(chunks);
    if (auto sent = line.write(chunk, kWriteTime); !sent)
      return failed("sending " + step, sent.error().sentence);
    const std::vector<std::uint8_t> echo = line.read(chunk.size(), kEchoTime);
    if (echo.size() < chunk.size())
      return failed("the echo of " + step + " is missing",
                    std::to_string(echo.size()) + " of " + std::to_string(chunk.size()) + " bytes");
    if (!std::equal(echo.begin(), echo.end(), chunk.begin()))
      return failed("the echo of " + step + " differs", "");
  }
  return {};
}

}  // namespace

Result<std::vector<std::uint8_t>> read_firmware(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return bad_value(path + ": the firmware file can't be read");
  std::vector<std::uint8_t> image;
  image.reserve(65536);
  for (std::istreambuf_iterator<char> byte(in), end; byte != end; ++byte) {
    if (image.size() == kLargestFirmware)
      return bad_value(path + ": the firmware is longer than " + std::to_string(kLargestFirmware) +
                       " bytes, so it is none");
    image.push_back(static_cast<std::uint8_t>(*byte));
  }
  if (image.empty()) return bad_value(path + ": the firmware file is empty");
  return image;
}

Result<void> set_running_line(SerialLine& line) {
  return in_order("setting the running line",
                  {[&] { return line.set_latency(1); }, [&] { return line.set_baud(Baud::k1500000); },
                   [&] { return line.purge(); }});
}

bool answers(SerialLine& line) {
  PacketStream stream;
  for (int i = 0; i < kProbes && !line.lost(); ++i) {
    if (!line.write(encode(Command{}), kWriteTime)) return false;
    for (const std::uint8_t byte : line.read(kPacketBytes, kProbeTime))
      if (const auto packet = stream.take(byte)) return decode_report(*packet).has_value();
  }
  return false;
}

Result<void> load_once(SerialLine& line, std::span<const std::uint8_t> image,
                       const std::function<bool()>& stop) {
  if (auto done = in_order("setting the line for the greeting",
                           {[&] { return line.purge(); }, [&] { return line.set_latency(16); },
                            [&] { return line.set_baud(Baud::k9600); }, [&] { return line.set_frame_8n1(); },
                            [&] { return line.set_no_flow_control(); }, [&] { return line.set_rts_low(); },
                            [&] { return line.set_dtr(false); }, [&] { return line.set_dtr(true); }});
      !done)
    return done;
  if (auto done = greet(line, stop); !done) return done;
  if (auto done = in_order("changing the baud rate",
                           {[&] { return line.set_dtr(false); }, [&] { return line.set_baud(Baud::k142857); },
                            [&] { return line.write(kReady, kWriteTime); }});
      !done)
    return done;
  const std::vector<std::uint8_t> ready = line.read(kReady.size(), kEchoTime);
  if (!std::equal(ready.begin(), ready.end(), kReady.begin(), kReady.end()))
    return failed(
        ready.empty() ? "the new baud rate was not answered" : "the new baud rate was answered wrongly", "");
  if (auto done = send_image(line, image, stop); !done) return done;
  return set_running_line(line);
}

Result<void> load_firmware(SerialLine& line, std::span<const std::uint8_t> image,
                           const std::function<bool()>& stop) {
  Error last = failed("stopped", "");
  int attempts = 0;
  while (attempts < kLoadAttempts && !stop() && !line.lost()) {
    ++attempts;
    if (auto loaded = load_once(line, image, stop); !loaded)
      last = loaded.error();
    else if (answers(line))
      return {};
    else
      last = failed("loaded to the end, and then silent", "");
  }
  last.sentence += ", " + std::to_string(attempts) + " attempts";
  return last;
}

}  // namespace palpate::falcon
