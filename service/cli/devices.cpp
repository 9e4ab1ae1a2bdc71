#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "service/cli/cli.h"

namespace palpate {

Result<void> devices_command(const Parts& parts) {
  const std::vector<DeviceLine> lines = parts.list_devices();
  std::size_t width = 0;
  for (const DeviceLine& line : lines) width = std::max(width, line.name.size());
  for (const char* kind : {"vulkan", "haptic"}) {
    fmt::print("{} devices\n", kind[0] == 'v' ? "Vulkan" : "Haptic");
    for (const DeviceLine& line : lines) {
      if (line.kind != kind) continue;
      fmt::print("  {:<{}}  {:<10}  {}\n", line.name, width, line.usable ? "usable" : "not usable",
                 line.reason);
    }
  }
  return {};
}

}  // namespace palpate
