#include "service/server/http/json_input.h"

#include <algorithm>
#include <set>

#include "model/files/one_line.h"
#include "model/scene/scene_json.h"

namespace palpate {

std::string shown_text(std::string_view text) {
  return one_line(std::string(text.substr(0, 80))) + (text.size() > 80 ? "…" : "");
}

std::string dump(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool nests_deeper(std::string_view text, std::size_t depth) {
  std::size_t open = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++open > depth) return true;
    } else if ((c == ']' || c == '}') && open > 0) {
      --open;
    }
  }
  return false;
}

std::variant<nlohmann::json, Problem> read_json_object(std::string_view text, std::size_t depth,
                                                       const std::vector<std::string>& keys,
                                                       const std::string& what) {
  if (nests_deeper(text, depth))
    return bad_request("the " + what + " nests deeper than " + std::to_string(depth) + " levels", "body");
  nlohmann::json value;
  try {
    value = parse_scene_text(what, std::string(text));
  } catch (const SceneFault& fault) {
    return bad_request(one_line(fault.sentence.substr(0, 400)), "body");
  } catch (const std::exception& error) {
    return bad_request("the " + what + " is no JSON: " + shown_text(error.what()), "body");
  }
  if (!value.is_object()) return bad_request("the " + what + " is no JSON object", "body");
  if (!keys.empty())
    for (const auto& [key, ignored] : value.items())
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        return bad_request("unknown key \"" + shown_text(key) + "\"; the nearest known one is \"" +
                               nearest_word(key.substr(0, 40), keys) + "\"",
                           shown_text(key));
  return value;
}

}  // namespace palpate
