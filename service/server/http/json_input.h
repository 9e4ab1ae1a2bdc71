#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/server/http/problem.h"

namespace palpate {

/// JSON of a client: an object that has only `keys` (empty: any), nested no deeper than `depth`, without
/// duplicate keys. Never throws. `what` it is, for sentences.
std::variant<nlohmann::json, Problem> read_json_object(std::string_view text, std::size_t depth,
                                                       const std::vector<std::string>& keys = {},
                                                       const std::string& what = "body");

/// Whether brackets nest deeper than `depth`, told without parsing.
bool nests_deeper(std::string_view text, std::size_t depth);

/// A client's text, short enough and without control characters, as a sentence may repeat it.
std::string shown_text(std::string_view text);

/// JSON text of a value; bytes that are no UTF-8 are replaced, since names of files may hold any.
std::string dump(const nlohmann::ordered_json& value);

}  // namespace palpate
