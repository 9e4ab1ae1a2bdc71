#include "service/server/log.h"

#include <fmt/chrono.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate {

void Log::info(const char* event, const nlohmann::ordered_json& fields) { write("info", event, fields); }
void Log::warn(const char* event, const nlohmann::ordered_json& fields) { write("warning", event, fields); }

void Log::write(const char* level, const char* event, const nlohmann::ordered_json& fields) {
  const auto now = std::chrono::time_point_cast<std::chrono::milliseconds>(std::chrono::system_clock::now());
  const auto ms = now.time_since_epoch().count() % 1000;
  nlohmann::ordered_json line = {{"time", fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)), ms)},
                                 {"level", level},
                                 {"event", event}};
  line.update(fields);
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace palpate
