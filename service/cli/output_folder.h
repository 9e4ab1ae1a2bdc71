#pragma once
#include <span>
#include <string>

#include "model/result.h"

namespace palpate {

/// Whether files can be written to a folder that may have to be made: the sentence why not, else empty. For a
/// check before long work; nothing is made.
std::string cannot_write_to(const std::string& folder);

/// Before long work: that `files` can be written to `folder` (of `option`), and, unless told to `overwrite`,
/// that none of them is there already. `whose` names them in the sentence: "a run's".
Result<void> check_output_folder(const std::string& folder, std::span<const char* const> files,
                                 const char* whose, bool overwrite, const char* option = "--out");

}  // namespace palpate
