#pragma once
#include <array>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/lattice/vector.h"

namespace palpate {

/// Thrown inside the reading of a scene file, caught where that begins: one sentence.
struct SceneFault {
  std::string sentence;
};

/// What a number may be.
struct Limits {
  double least, most;
  const char* unit = "";    ///< " N/m", with the space
  bool open_below = false;  ///< `least` itself is not allowed
};

/// An object of a scene file that is read key by key. Every fault is a SceneFault that names the file, the
/// JSON pointer, what was found and what is wanted. The object must outlive its readers.
class SceneObject {
 public:
  /// `value` must be an object whose keys are all among `keys`.
  SceneObject(const std::string& file, std::string pointer, const nlohmann::json& value,
              const std::vector<std::string>& keys);

  bool has(const char* key) const { return value_.contains(key); }
  std::string pointer(const std::string& key) const { return pointer_ + "/" + key; }
  const nlohmann::json& at(const char* key) const { return value_.at(key); }
  const std::string& file() const { return file_; }

  // Each leaves `out` as it is when the key is missing.
  void number(const char* key, const Limits& limits, double& out) const;
  void whole(const char* key, int least, int most, int& out) const;
  void text(const char* key, std::string& out) const;  ///< not empty
  void texts(const char* key, std::vector<std::string>& out) const;
  void vector(const char* key, double reach, const char* unit,
              Vec3& out) const;                     ///< three numbers within ±reach
  void rotation(const char* key, Quat& out) const;  ///< [x, y, z, w], unit; normalised
  bool is_auto(const char* key) const { return has(key) && at(key).is_string() && at(key) == "auto"; }

  /// The index of the text among `choices`, or nothing when the key is missing.
  std::optional<std::size_t> choice(const char* key, const std::vector<std::string>& choices) const;

  /// Ends the reading: "FILE: POINTER WHAT".
  [[noreturn]] void fail(const char* key, const std::string& what) const;

 private:
  std::vector<double> numbers(const char* key, std::size_t count, const char* wanted) const;

  const std::string& file_;
  std::string pointer_;
  const nlohmann::json& value_;
};

/// Parses strictly: no duplicate keys, no comments, UTF-8 only. Throws SceneFault with line and column.
nlohmann::json parse_scene_text(const std::string& file, const std::string& text);

/// The member of `known` that takes the fewest single-letter changes to become `word`.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// "\"a\", \"b\" or \"c\"".
std::string listed(const std::vector<std::string>& words);

}  // namespace palpate
