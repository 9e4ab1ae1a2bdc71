#include "model/scene/scene_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "model/lattice/pose.h"

namespace palpate {
namespace {

using nlohmann::json;

/// The kind and, when it is short, the value itself: "a string (\"2 kg\")".
std::string described(const json& value) {
  const std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  const std::string shown = text.size() <= 60 ? " (" + text + ")" : "";
  switch (value.type()) {
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "an array" + shown;
    case json::value_t::string:
      return "a string" + shown;
    case json::value_t::boolean:
      return "a boolean" + shown;
    case json::value_t::null:
      return "null";
    default:
      return "a number" + shown;
  }
}

std::string printed(double value) {
  std::string text = json(value).dump();
  if (text.ends_with(".0")) text.erase(text.size() - 2);
  return text;
}

std::string allowed(const Limits& limits) {
  if (limits.most >= 1e300)
    return std::string(limits.open_below ? "above " : "at least ") + printed(limits.least) + limits.unit;
  return (limits.open_below ? "above " + printed(limits.least) + " and at most "
                            : "from " + printed(limits.least) + " to ") +
         printed(limits.most) + limits.unit;
}

/// A key as it may stand in a sentence and a JSON pointer.
std::string plain(const std::string& key) {
  std::string out = json(key.substr(0, 60)).dump(-1, ' ', true, json::error_handler_t::replace);
  std::string pointer;
  for (const char c : out.substr(1, out.size() - 2))
    pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return pointer;
}

/// Where the parser is, as a JSON pointer, and the keys of every open object.
class Place {
 public:
  void open(bool array) { open_.push_back({array, 0, "", {}}); }
  void close() {
    open_.pop_back();
    count();
  }
  void count() {
    if (!open_.empty() && open_.back().array) ++open_.back().index;
  }
  /// False when the object has this key already.
  bool key(const std::string& name) {
    open_.back().key = name;
    return open_.back().keys.insert(name).second;
  }
  std::string pointer() const {
    std::string out;
    for (const Level& level : open_)
      out += "/" + (level.array ? std::to_string(level.index) : plain(level.key));
    return out;
  }

 private:
  struct Level {
    bool array;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };
  std::vector<Level> open_;
};

}  // namespace

SceneObject::SceneObject(const std::string& file, std::string pointer, const json& value,
                         const std::vector<std::string>& keys)
    : file_(file), pointer_(std::move(pointer)), value_(value) {
  if (!value.is_object())
    throw SceneFault{file_ + ": " + (pointer_.empty() ? "the whole" : pointer_) + " is " + described(value) +
                     "; an object is wanted"};
  for (const auto& [key, ignored] : value.items())
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      throw SceneFault{file_ + ": " + pointer_ + "/" + plain(key) + " is not a known key; the nearest is \"" +
                       nearest_word(key, keys) + "\""};
}

void SceneObject::fail(const char* key, const std::string& what) const {
  throw SceneFault{file_ + ": " + pointer(key) + " " + what};
}

void SceneObject::number(const char* key, const Limits& limits, double& out) const {
  if (!has(key)) return;
  const json& value = at(key);
  if (!value.is_number()) fail(key, "is " + described(value) + "; a number is wanted");
  const double number = value.get<double>();
  const bool inside = std::isfinite(number) && number <= limits.most &&
                      (limits.open_below ? number > limits.least : number >= limits.least);
  if (!inside) fail(key, "is " + value.dump() + "; it must be " + allowed(limits));
  out = number;
}

void SceneObject::whole(const char* key, int least, int most, int& out) const {
  if (!has(key)) return;
  double number = 0;
  this->number(key, {double{-1e300}, 1e300}, number);
  if (number != std::floor(number) || number < least || number > most)
    fail(key, "is " + at(key).dump() + "; it must be a whole number from " + std::to_string(least) + " to " +
                  std::to_string(most));
  out = static_cast<int>(number);
}

void SceneObject::text(const char* key, std::string& out) const {
  if (!has(key)) return;
  const json& value = at(key);
  if (!value.is_string()) fail(key, "is " + described(value) + "; a string is wanted");
  out = value.get<std::string>();
  if (out.empty()) fail(key, "is empty");
  if (out.find('\0') != std::string::npos) fail(key, "contains a zero byte");
}

void SceneObject::texts(const char* key, std::vector<std::string>& out) const {
  if (!has(key)) return;
  const json& value = at(key);
  const auto wrong = [&](const json& found) {
    fail(key, "has " + described(found) + "; an array of strings is wanted");
  };
  if (!value.is_array()) wrong(value);
  for (const json& each : value) {
    if (!each.is_string()) wrong(each);
    if (each.get_ref<const std::string&>().empty()) fail(key, "has an empty string");
    out.push_back(each.get<std::string>());
  }
}

std::vector<double> SceneObject::numbers(const char* key, std::size_t count, const char* wanted) const {
  const json& value = at(key);
  const bool good =
      value.is_array() && value.size() == count &&
      std::all_of(value.begin(), value.end(), [](const json& each) { return each.is_number(); });
  if (!good) fail(key, "is " + described(value) + "; " + wanted + " are wanted");
  return value.get<std::vector<double>>();
}

void SceneObject::vector(const char* key, double reach, const char* unit, Vec3& out) const {
  if (!has(key)) return;
  const std::vector<double> values = numbers(key, 3, "three numbers [x, y, z]");
  for (const double value : values)
    if (!(std::abs(value) <= reach))
      fail(key, "has " + printed(value) + "; each must be within ±" + printed(reach) + unit);
  out = {values[0], values[1], values[2]};
}

void SceneObject::rotation(const char* key, Quat& out) const {
  if (!has(key)) return;
  const std::vector<double> q = numbers(key, 4, "four numbers [x, y, z, w]");
  const double square = std::inner_product(q.begin(), q.end(), q.begin(), 0.0);
  if (!(std::abs(square - 1) <= kUnitQuaternionTolerance))
    fail(key, "is " + at(key).dump() + ", of length " + printed(std::sqrt(square)) +
                  "; a unit quaternion [x, y, z, w] has length 1");
  const double length = std::sqrt(square);
  out = Quat(q[3] / length, q[0] / length, q[1] / length, q[2] / length);
}

std::optional<std::size_t> SceneObject::choice(const char* key,
                                               const std::vector<std::string>& choices) const {
  if (!has(key)) return std::nullopt;
  std::string word;
  text(key, word);
  const auto found = std::find(choices.begin(), choices.end(), word);
  if (found == choices.end()) fail(key, "is " + at(key).dump() + "; it must be " + listed(choices));
  return static_cast<std::size_t>(found - choices.begin());
}

json parse_scene_text(const std::string& file, const std::string& text) {
  constexpr int kDeepest = 64;  // values are printed and taken apart by recursion (chosen)
  Place place;
  const auto watch = [&](int depth, json::parse_event_t event, json& value) {
    if (depth > kDeepest) throw SceneFault{fmt::format("{}: it nests more than {} deep", file, kDeepest)};
    switch (event) {
      case json::parse_event_t::object_start:
        place.open(false);
        break;
      case json::parse_event_t::array_start:
        place.open(true);
        break;
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        place.close();
        break;
      case json::parse_event_t::value:
        place.count();
        break;
      case json::parse_event_t::key:
        if (!place.key(value.get<std::string>()))
          throw SceneFault{file + ": " + place.pointer() + " stands there twice"};
        break;
    }
    return true;
  };
  // The library takes a zero for the end of the text, and says so.
  if (const auto zero = text.find('\0'); zero != std::string::npos)
    throw SceneFault{fmt::format("{}: byte {} is zero: this is no text", file, zero)};
  try {
    return json::parse(text, watch);
  } catch (const json::exception& fault) {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error …": the number is of no
    // use to a reader.
    std::string what = fault.what();
    if (const auto end = what.find("] "); end != std::string::npos) what.erase(0, end + 2);
    for (char& c : what)
      if (c < ' ' || c > '~') c = '?';
    throw SceneFault{file + ": " + what};
  }
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  const std::string* nearest = nullptr;
  std::size_t least = 0;
  word = word.substr(0, 100);
  for (const std::string& each : known) {
    // Levenshtein, one row at a time.
    std::vector<std::size_t> row(each.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < each.size(); ++j) {
        const std::size_t changed = diagonal + (word[i] != each[j]);
        diagonal = row[j + 1];
        row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
      }
    }
    if (!nearest || row.back() < least) {
      nearest = &each;
      least = row.back();
    }
  }
  return nearest ? *nearest : std::string();
}

std::string listed(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + ("\"" + words[i] + "\"");
  return out;
}

}  // namespace palpate
