#pragma once
#include <map>
#include <string>
#include <vector>

#include "model/result.h"
#include "tests/equivalence/digest.h"

namespace palpate::equivalence {

/// What is kept of a case's answers: how many poses of seed 1, and a hash of each part as 16 hexadecimal
/// digits.
struct StoredHashes {
  int poses = 0;
  std::string preparation, sets, areas, sums, response;
};

StoredHashes stored(const CaseHashes& hashes, int poses);

/// The parts in which two differ: "sets, areas". Empty: none.
std::string differing_parts(const StoredHashes& a, const StoredHashes& b);

struct HashesFile {
  std::string reason;  ///< why they were last written anew
  std::map<std::string, StoredHashes> cases;
};

/// Errors (kBadValue): no such file, or not one that write_hashes() made.
Result<HashesFile> read_hashes(const std::string& file);
Result<void> write_hashes(const std::string& file, const HashesFile& hashes);

}  // namespace palpate::equivalence
