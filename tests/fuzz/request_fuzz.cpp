// What strangers send to `palpate serve`, past the HTTP itself: targets, forms, JSON, poses, ids, hosts. The
// first byte says how the rest is cut.
#include <cmath>
#include <string>

#include "service/server/http/auth.h"
#include "service/server/http/http_message.h"
#include "service/server/http/json_input.h"
#include "service/server/http/multipart.h"
#include "service/server/http/safe_path.h"
#include "service/server/queries/pose_body.h"
#include "service/server/scenes/drawing.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace palpate;

void expect_told(const Problem& problem) {
  PALPATE_PROMISE(problem.status >= 400 && problem.status < 600 && !problem.detail.empty());
  for (const char c : problem.detail)
    PALPATE_PROMISE(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);  // a log and a terminal show it
  PALPATE_PROMISE(nlohmann::json::accept(problem.json()));
}

/// The content of all parts, one after the other, or a mark where the form is refused.
std::string read_form(std::string_view text, std::size_t piece) {
  std::string seen;
  bool open = false;
  MultipartReader reader("b", {[&](const PartHead& head) -> std::optional<Problem> {
                                 PALPATE_PROMISE(!open);
                                 open = true;
                                 seen += "<" + head.name + "|" + head.filename + ">";
                                 return std::nullopt;
                               },
                               [&](std::string_view data) -> std::optional<Problem> {
                                 PALPATE_PROMISE(open);
                                 seen.append(data);
                                 return std::nullopt;
                               },
                               [&]() -> std::optional<Problem> {
                                 PALPATE_PROMISE(open);
                                 open = false;
                                 return std::nullopt;
                               }});
  for (std::size_t at = 0; at < text.size(); at += piece)
    if (const auto problem = reader.feed(text.substr(at, piece))) {
      expect_told(*problem);
      return "refused";
    }
  PALPATE_PROMISE(!reader.complete() || !open);
  return seen + (reader.complete() ? "." : "");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0] % 64;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);

  HttpRequest request;
  if (decode_target(text, request)) {
    for (const std::string& segment : request.segments)
      PALPATE_PROMISE(segment.find('\0') == std::string::npos);
    for (const auto& [name, value] : request.query)
      PALPATE_PROMISE(name.find('\0') == std::string::npos && value.find('\0') == std::string::npos);
  }

  // However the form is cut into pieces, it reads the same.
  PALPATE_PROMISE(boundary_of(text).size() <= 70);
  PALPATE_PROMISE(read_form(text, piece) == read_form(text, text.size() + 1));

  const auto json = read_json_object(text, 32, {"pose", "poses"});
  if (const auto* problem = std::get_if<Problem>(&json)) expect_told(*problem);

  ServerLimits limits;
  limits.poses = 100;
  for (const char* type : {"application/json", "text/csv", "application/vnd.palpate.poses", "other"}) {
    const auto poses = read_pose_body(type, text, limits);
    if (const auto* problem = std::get_if<Problem>(&poses)) {
      expect_told(*problem);
      continue;
    }
    const auto& list = std::get<std::vector<Pose>>(poses);
    PALPATE_PROMISE(!list.empty() && list.size() <= limits.poses);
    for (const Pose& pose : list)
      PALPATE_PROMISE(std::isfinite(pose.position.x) && std::abs(glm::length(pose.rotation) - 1) < 2e-3);
  }

  if (const auto ids = parse_ids(text, 1000, 500)) {
    PALPATE_PROMISE(ids->size() <= 500);
    for (const std::uint32_t id : *ids) PALPATE_PROMISE(id < 1000);
  }
  if (plain_name(text))
    PALPATE_PROMISE(text.find('/') == std::string::npos && text != "." && text != ".." && text.size() <= 100);

  const AccessRules rules{{"localhost", "127.0.0.1", "[::1]"}, "the-right-token-0123"};
  const AccessFields as_host{text, {}, "Bearer the-right-token-0123", {}};
  if (!refuse_access(rules, as_host, false)) {  // what passes is one of ours and a port
    const std::string name = host_name(text);
    PALPATE_PROMISE(name == "localhost" || name == "127.0.0.1" || name == "[::1]");
    PALPATE_PROMISE(text.find_first_of("@/\\ ") == std::string::npos);
  }
  const AccessFields as_token{"localhost", {}, text, text};
  if (const auto problem = refuse_access(rules, as_token, false))
    expect_told(*problem);
  else
    PALPATE_PROMISE(text.find("the-right-token-0123") != std::string::npos);
  return 0;
}
