#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "driver/falcon/serial_line.h"

namespace palpate::falcon {

inline constexpr std::size_t kLargestFirmware = 1 << 20;  ///< bytes; the real one has some tens of thousands
inline constexpr int kLoadAttempts = 10;                  ///< loading is known to be flaky
inline constexpr std::size_t kFirmwareChunk = 62;         ///< bytes sent before their echo is compared

/// Reads the user's firmware file. Errors (kBadValue): can't be read, empty, longer than kLargestFirmware.
Result<std::vector<std::uint8_t>> read_firmware(const std::string& path);

/// Sets the line as the running firmware talks: latency 1 ms, 1.5 Mbaud, nothing left over.
Result<void> set_running_line(SerialLine& line);

/// Whether a firmware already runs: some of a few packets with no force, sent on a running line, are answered
/// by a sound report.
bool answers(SerialLine& line);

/// Loads the firmware, once: greeting, baud change, chunks each echoed verbatim, running line. The error
/// names the step that failed. `stop` ends it between two steps.
Result<void> load_once(SerialLine& line, std::span<const std::uint8_t> image,
                       const std::function<bool()>& stop);

/// load_once up to kLoadAttempts times, until the firmware answers. The error names the last step that failed
/// and the attempts.
Result<void> load_firmware(SerialLine& line, std::span<const std::uint8_t> image,
                           const std::function<bool()>& stop);

}  // namespace palpate::falcon
