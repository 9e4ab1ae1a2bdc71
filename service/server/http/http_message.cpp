#include "service/server/http/http_message.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace palpate {

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

namespace {

/// What stands before the next `separator`; `text` becomes what stands behind it.
std::string_view take_piece(std::string_view& text, char separator) {
  const auto end = text.find(separator);
  const std::string_view piece = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  return without_blanks(piece);
}

/// The weight of a media range: its parameter q, else 1; one that is no number is 0.
double weight_of(std::string_view parameters) {
  while (!parameters.empty()) {
    const std::string_view parameter = take_piece(parameters, ';');
    if (parameter.size() < 2 || (parameter[0] != 'q' && parameter[0] != 'Q') || parameter[1] != '=') continue;
    double weight = 0;
    const std::string_view digits = parameter.substr(2);
    std::from_chars(digits.data(), digits.data() + digits.size(), weight);
    return weight;
  }
  return 1;
}

}  // namespace

std::string media_type(std::string_view content_type) {
  std::string type(without_blanks(content_type.substr(0, content_type.find(';'))));
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return type;
}

bool prefers(std::string_view accept, std::string_view type, std::string_view otherwise) {
  double wanted = 0;
  // The nearest range decides: the type itself, then its kind, then any.
  const std::string kind = std::string(otherwise.substr(0, otherwise.find('/'))) + "/*";
  std::array<double, 3> others{-1, -1, -1};
  while (!accept.empty()) {
    std::string_view parameters = take_piece(accept, ',');
    const std::string range = media_type(take_piece(parameters, ';'));
    const double weight = weight_of(parameters);
    if (range == type) wanted = weight;
    if (range == otherwise) others[0] = weight;
    if (range == kind) others[1] = weight;
    if (range == "*/*") others[2] = weight;
  }
  const auto other = std::find_if(others.begin(), others.end(), [](double weight) { return weight >= 0; });
  return wanted > 0 && (other == others.end() || wanted >= *other);
}

bool percent_decode(std::string_view text, std::string& out) {
  out.clear();
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      unsigned value = 0;
      if (i + 2 >= text.size()) return false;
      const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16);
      if (error != std::errc() || end != text.data() + i + 3) return false;
      c = static_cast<char>(value);
      i += 2;
    }
    if (c == '\0') return false;
    out.push_back(c);
  }
  return true;
}

bool decode_target(std::string_view target, HttpRequest& request) {
  if (target.empty() || target.front() != '/') return false;
  const auto question = target.find('?');
  std::string_view path = target.substr(1, question == std::string_view::npos ? question : question - 1);
  request.path = std::string(target.substr(0, question));
  request.segments.clear();
  while (!path.empty()) {
    const auto slash = path.find('/');
    std::string segment;
    if (!percent_decode(path.substr(0, slash), segment)) return false;
    request.segments.push_back(std::move(segment));
    path = slash == std::string_view::npos ? std::string_view{} : path.substr(slash + 1);
  }
  request.query.clear();
  request.repeated.clear();
  std::string_view rest =
      question == std::string_view::npos ? std::string_view{} : target.substr(question + 1);
  while (!rest.empty()) {
    const auto amp = rest.find('&');
    const std::string_view pair = rest.substr(0, amp);
    const auto equals = pair.find('=');
    std::string name, value;
    if (!percent_decode(pair.substr(0, equals), name)) return false;
    if (equals != std::string_view::npos && !percent_decode(pair.substr(equals + 1), value)) return false;
    if (!request.query.emplace(name, std::move(value)).second) request.repeated = name;
    rest = amp == std::string_view::npos ? std::string_view{} : rest.substr(amp + 1);
  }
  return true;
}

}  // namespace palpate
