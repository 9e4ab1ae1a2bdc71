#include "tests/equivalence/hashes_file.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

namespace palpate::equivalence {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, std::string StoredHashes::*>, 5> kParts = {
    {{"preparation", &StoredHashes::preparation},
     {"sets", &StoredHashes::sets},
     {"areas", &StoredHashes::areas},
     {"sums", &StoredHashes::sums},
     {"response", &StoredHashes::response}}};

std::string text_of(const Digest& digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest.value()));
  return text;
}

}  // namespace

StoredHashes stored(const CaseHashes& hashes, int poses) {
  return {poses,
          text_of(hashes.preparation),
          text_of(hashes.sets),
          text_of(hashes.areas),
          text_of(hashes.sums),
          text_of(hashes.response)};
}

std::string differing_parts(const StoredHashes& a, const StoredHashes& b) {
  std::string parts;
  for (const auto& [name, part] : kParts)
    if (a.*part != b.*part) parts += (parts.empty() ? "" : ", ") + std::string(name);
  return parts;
}

Result<HashesFile> read_hashes(const std::string& file) {
  std::ifstream in(file);
  if (!in) return bad_value(file + " could not be read");
  try {
    const Json json = Json::parse(in);
    HashesFile out;
    out.reason = json.at("reason");
    for (const auto& [name, entry] : json.at("cases").items()) {
      StoredHashes& hashes = out.cases[name];
      hashes.poses = entry.at("poses");
      for (const auto& [key, part] : kParts) hashes.*part = entry.at(key);
    }
    return out;
  } catch (const Json::exception& fault) {
    return bad_value(file + " is not a file of hashes: " + fault.what());
  }
}

Result<void> write_hashes(const std::string& file, const HashesFile& hashes) {
  Json cases;
  for (const auto& [name, entry] : hashes.cases) {
    Json& out = cases[name];
    out["poses"] = entry.poses;
    for (const auto& [key, part] : kParts) out[key] = entry.*part;
  }
  std::ofstream out(file);
  out << Json{{"reason", hashes.reason}, {"cases", cases}}.dump(1) << "\n";
  if (!out.flush()) return bad_value(file + " could not be written");
  return {};
}

}  // namespace palpate::equivalence
