#pragma once
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace palpate {

/// Lines on standard error, each written whole. Any thread but a loop's.
class Log {
 public:
  /// kJson: an object a line, {"time","level","event",…}, for programs that keep logs. kPlain: sentences,
  /// without one for each request, for a terminal.
  enum class Form { kJson, kPlain };
  /// `quiet`: warnings alone.
  explicit Log(Form form = Form::kJson, bool quiet = false) : form_(form), quiet_(quiet) {}

  void info(const char* event, const nlohmann::ordered_json& fields);
  void warn(const char* event, const nlohmann::ordered_json& fields);

 private:
  void write(const char* level, const char* event, const nlohmann::ordered_json& fields);
  Form form_;
  bool quiet_;
  std::mutex mutex_;
};

}  // namespace palpate
