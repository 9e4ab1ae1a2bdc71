#pragma once
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate {

/// A JSON object a line on standard error: {"time","level","event",…}. Any thread but a loop's. A line is written whole.
class Log {
 public:
  void info(const char* event, const nlohmann::ordered_json& fields);
  void warn(const char* event, const nlohmann::ordered_json& fields);

 private:
  void write(const char* level, const char* event, const nlohmann::ordered_json& fields);
  std::mutex mutex_;
};

}  // namespace palpate
