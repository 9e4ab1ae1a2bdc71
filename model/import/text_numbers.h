#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

/// Takes the next word off a line of text; empty at its end.
std::string_view take_word(std::string_view& line);

/// Whether a word is one decimal number and nothing else: "-1.5e3", ".5", "2.", "nan", "inf"; "1,5" too, as
/// some programs write 1.5 where people do. (The importer behind us takes what a word begins with: 1.5 of
/// "1.5.2", 0 of "0x10", 1 of "1d3".)
bool is_decimal(std::string_view word);

/// Takes `wanted` words off a line that must be numbers; what is wrong with them, as the rest of a sentence
/// that begins with the file's name, or nothing. `where` and `number` say where they stand: "line" 12.
std::string distrust_numbers(std::string_view& line, std::size_t wanted, const char* where,
                             std::size_t number);

}  // namespace palpate
