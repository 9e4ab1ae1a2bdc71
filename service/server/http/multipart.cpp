#include "service/server/http/multipart.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "service/server/http/http_message.h"

namespace palpate {
namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

bool same_word(std::string_view a, std::string_view b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) { return lower(x) == lower(y); });
}

/// The value of `name` in "form-data; name=\"x\"; filename=\"y\"", quoted or not.
std::optional<std::string> parameter(std::string_view field, std::string_view name) {
  std::size_t at = field.find(';');
  while (at != std::string_view::npos) {
    std::string_view rest = without_blanks(field.substr(at + 1));
    const auto equals = rest.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    const std::string_view key = without_blanks(rest.substr(0, equals));
    std::string_view value = rest.substr(equals + 1);
    std::string text;
    std::size_t used = 0;
    if (!value.empty() && value.front() == '"') {
      for (used = 1; used < value.size() && value[used] != '"'; ++used) {
        if (value[used] == '\\' && used + 1 < value.size()) ++used;
        text.push_back(value[used]);
      }
      if (used >= value.size()) return std::nullopt;  // no closing quote
    } else {
      used = std::min(value.find(';'), value.size());
      text = std::string(without_blanks(value.substr(0, used)));
    }
    if (same_word(key, name)) return text;
    const auto next = value.find(';', used);
    if (next == std::string_view::npos) return std::nullopt;
    field = value;
    at = next;
  }
  return std::nullopt;
}

}  // namespace

std::string boundary_of(std::string_view content_type) {
  if (!same_word(without_blanks(content_type.substr(0, content_type.find(';'))), "multipart/form-data"))
    return {};
  const auto boundary = parameter(content_type, "boundary");
  if (!boundary || boundary->empty() || boundary->size() > 70) return {};
  for (const char c : *boundary)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) return {};
  return *boundary;
}

MultipartReader::MultipartReader(const std::string& boundary, Events events)
    : delimiter_("\r\n--" + boundary),
      pending_("\r\n"),
      events_(std::move(events)) {}  // the first boundary may stand at the very start

std::optional<Problem> MultipartReader::feed(std::string_view bytes) {
  if (state_ == State::kOver) return std::nullopt;  // an epilogue says nothing
  pending_.append(bytes);
  std::size_t at = 0;  // what stands before is done with
  std::optional<Problem> problem;
  for (bool more = true; more && !problem;) {
    const std::string_view rest = std::string_view(pending_).substr(at);
    switch (state_) {
      case State::kPreamble:
      case State::kData: {
        const auto found = rest.find(delimiter_);
        const std::size_t sure = found != std::string_view::npos
                                     ? found
                                     : rest.size() - std::min(rest.size(), delimiter_.size() - 1);
        if (state_ == State::kData && sure > 0) problem = events_.data(rest.substr(0, sure));
        at += sure;
        if (found == std::string_view::npos) {
          more = false;
          break;
        }
        at += delimiter_.size();
        if (!problem && state_ == State::kData) problem = events_.end();
        state_ = State::kAfterBoundary;
        break;
      }
      case State::kAfterBoundary:
        if (rest.size() < 2) {
          more = false;
        } else if (rest.starts_with("--")) {
          state_ = State::kOver;
          more = false;
        } else if (rest.starts_with("\r\n")) {
          state_ = State::kHead;  // the line end stays: a head may be empty
        } else {
          problem = bad_request("a boundary of the form is followed by rubbish", "body");
        }
        break;
      case State::kHead: {
        const auto end = rest.find("\r\n\r\n");
        if (end > kLongestHead) {  // npos, too
          if (rest.size() > kLongestHead)
            problem = bad_request("the header of a part is longer than 8192 bytes", "body");
          more = false;
          break;
        }
        problem = read_head(rest.substr(0, end));
        at += end + 4;
        state_ = State::kData;
        break;
      }
      case State::kOver:
        more = false;
        break;
    }
  }
  if (problem) state_ = State::kOver;
  pending_.erase(0, at);
  return problem;
}

std::optional<Problem> MultipartReader::read_head(std::string_view head) {
  PartHead part;
  bool found = false;
  while (!head.empty()) {
    const auto end = head.find("\r\n");
    const std::string_view line = head.substr(0, end);
    head = end == std::string_view::npos ? std::string_view{} : head.substr(end + 2);
    const auto colon = line.find(':');
    if (colon == std::string_view::npos ||
        !same_word(without_blanks(line.substr(0, colon)), "content-disposition"))
      continue;
    const auto name = parameter(line.substr(colon + 1), "name");
    if (!name) break;
    part.name = *name;
    part.filename = parameter(line.substr(colon + 1), "filename").value_or("");
    found = true;
  }
  if (!found) return bad_request("a part of the form has no name", "body");
  return events_.part(part);
}

}  // namespace palpate
