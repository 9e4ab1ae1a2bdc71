#pragma once
#include <string>
#include <vector>

namespace palpate {

/// What a device has to tell once a run is over: reports that came late or broken, and the like. A device
/// that has something to tell derives from this too; the session asks after it has closed it.
class DeviceNotes {
 public:
  virtual ~DeviceNotes() = default;
  virtual std::vector<std::string> notes() const = 0;  ///< one sentence each; none when all went well
};

}  // namespace palpate
