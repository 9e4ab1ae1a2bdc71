#include "service/server/log.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "model/files/one_line.h"

namespace palpate {

namespace {

/// "listening: url http://127.0.0.1:8090/, root /srv/scenes"; nothing of what is empty.
std::string sentence_of(const char* event, const nlohmann::ordered_json& fields) {
  std::string name = event, told;
  std::replace(name.begin(), name.end(), '_', ' ');
  for (const auto& [key, value] : fields.items()) {
    const std::string text = value.is_string()
                                 ? value.get<std::string>()
                                 : value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (!text.empty()) told += (told.empty() ? ": " : ", ") + key + " " + one_line(text);
  }
  return "palpate: " + name + told + "\n";
}

}  // namespace

void Log::info(const char* event, const nlohmann::ordered_json& fields) {
  const bool shown = !quiet_ && (form_ == Form::kJson || std::string_view(event) != "request");
  if (shown) write("info", event, fields);
}
void Log::warn(const char* event, const nlohmann::ordered_json& fields) { write("warning", event, fields); }

void Log::write(const char* level, const char* event, const nlohmann::ordered_json& fields) {
  if (form_ == Form::kPlain) {
    const std::string text = sentence_of(event, fields);
    const std::lock_guard lock(mutex_);
    std::fwrite(text.data(), 1, text.size(), stderr);
    return;
  }
  const auto now = std::chrono::time_point_cast<std::chrono::milliseconds>(std::chrono::system_clock::now());
  const auto ms = now.time_since_epoch().count() % 1000;
  nlohmann::ordered_json line = {
      {"time", fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z",
                           fmt::gmtime(std::chrono::system_clock::to_time_t(now)), ms)},
      {"level", level},
      {"event", event}};
  line.update(fields);
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

}  // namespace palpate
