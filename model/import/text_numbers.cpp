#include "model/import/text_numbers.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/files/one_line.h"

namespace palpate {
namespace {

constexpr std::size_t kMostDigits = 19;  ///< in front of the point: more don't fit the importer's integers
constexpr std::string_view kBetweenWords = " \t\r\n\v\f";

/// Takes the digits off a word; how many.
std::size_t take_digits(std::string_view& word) {
  const std::size_t digits = std::min(word.find_first_not_of("0123456789"), word.size());
  word.remove_prefix(digits);
  return digits;
}

void take_sign(std::string_view& word) {
  if (!word.empty() && (word[0] == '+' || word[0] == '-')) word.remove_prefix(1);
}

/// `small` is in small letters.
bool is_in_any_case(std::string_view word, std::string_view small) {
  return std::equal(word.begin(), word.end(), small.begin(), small.end(),
                    [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a - 'A' + 'a' == b); });
}

}  // namespace

std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBetweenWords), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBetweenWords));
  line.remove_prefix(word.size());
  return word;
}

bool is_decimal(std::string_view word) {
  take_sign(word);
  for (const std::string_view name : {"nan", "inf", "infinity"})
    if (is_in_any_case(word, name)) return true;
  std::size_t digits = take_digits(word);
  if (digits > kMostDigits) return false;
  if (!word.empty() && (word[0] == '.' || word[0] == ',')) {
    word.remove_prefix(1);
    digits += take_digits(word);
  }
  if (digits == 0) return false;
  if (word.empty()) return true;
  if (word[0] != 'e' && word[0] != 'E') return false;
  word.remove_prefix(1);
  take_sign(word);
  return take_digits(word) > 0 && word.empty();
}

std::string distrust_numbers(std::string_view& line, std::size_t wanted, const char* where,
                             std::size_t number) {
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::string_view word = take_word(line);
    if (word.empty()) return fmt::format("has {} of {} numbers in {} {}", k, wanted, where, number);
    if (!is_decimal(word))
      return fmt::format("has '{}' for a number in {} {}", one_line(std::string(word.substr(0, 40))), where,
                         number);
  }
  return {};
}

}  // namespace palpate
