#include "service/server/http/problem.h"

#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

namespace palpate {

std::string Problem::json() const {
  std::string title = type;
  for (char& c : title)
    if (c == '-') c = ' ';
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  nlohmann::ordered_json out = {
      {"type", "urn:palpate:problem:" + type}, {"title", title}, {"status", status}, {"detail", detail}};
  if (!field.empty()) out["field"] = field;
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Problem bad_request(std::string detail, std::string field) {
  return {400, "bad-value", std::move(detail), std::move(field)};
}

Problem problem_of(const Error& error, std::string field) {
  if (error.code == ErrorCode::kBadValue) return bad_request(error.sentence, std::move(field));
  if (error.code == ErrorCode::kNoDevice) return {409, "no-device", error.sentence, std::move(field)};
  // What the scene's engine does not do, as the gpu engine no distances.
  if (error.code == ErrorCode::kUsage) return {409, "conflict", error.sentence, std::move(field)};
  return {500, "internal", error.sentence, std::move(field)};
}

}  // namespace palpate
