#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace palpate {

/// What the program tells about itself beyond --help, all of it made from the commands and options that the parser itself goes by.

/// The part of --help that the manual's pages share: variables that the program reads.
extern const char* const kEnvironmentText;

/// A completion script for a shell: "bash", "zsh" or "fish".
std::string completion_script(const CLI::App& app, const std::string& shell);

/// The manual page of a command of `app`, or of the program itself (empty), in roff's man macros, UTF-8. `version` stands in its foot.
std::string manual_page(const CLI::App& app, const std::string& command, const std::string& version);

/// The command or option of `words` that `word` was probably meant to be; empty: none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

/// One sentence for words that no command or option takes: "'--backed' is no option of palpate query; did you mean '--backend'?".
/// `name`: the command's, "palpate query".
std::string unexpected_words(const CLI::App& command, const std::string& name, const std::vector<std::string>& words);

}  // namespace palpate
