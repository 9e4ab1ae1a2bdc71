#include "service/cli/manual.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cctype>

namespace palpate {

const char* const kEnvironmentText = R"(Environment:
  PALPATE_CACHE   folder of the cache, or off; without it $XDG_CACHE_HOME/palpate, else ~/.cache/palpate
  LP_NUM_THREADS  threads of Mesa's Vulkan driver for processors; without it a lone frame runs on palpate's own
  TERM            dumb: no bar and no line that is redrawn
  TMPDIR          where `serve` keeps uploads, unless --spool says otherwise)";

namespace {

// ---- the table: commands, options, what an option takes ----

enum class Takes { kNothing, kWords, kFile, kFolder, kText };

struct OptionLine {
  std::vector<std::string> names;  ///< "-h", "--help"
  std::string type, help;
  Takes takes = Takes::kNothing;
  std::vector<std::string> words;
  bool again = false;  ///< may be given several times, or with several values
};

struct CommandLine {
  const CLI::App* app = nullptr;
  std::vector<std::string> path;  ///< "bench", "latency"; empty: the program
  std::vector<OptionLine> options, positionals;
  std::vector<const CLI::App*> below;
};

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// "auto|gpu|cpu|ref" as words; none where anything but small letters stands between the bars.
std::vector<std::string> words_of(const std::string& type) {
  std::vector<std::string> out(1);
  for (const char c : type) {
    if (c == '|')
      out.emplace_back();
    else if (std::islower(static_cast<unsigned char>(c)) != 0)
      out.back() += c;
    else
      return {};
  }
  const bool sound = out.size() > 1 && std::none_of(out.begin(), out.end(),
                                                    [](const std::string& word) { return word.empty(); });
  return sound ? out : std::vector<std::string>{};
}

OptionLine line_of(const CLI::Option& option) {
  OptionLine line;
  for (const std::string& name : option.get_snames()) line.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) line.names.push_back("--" + name);
  if (line.names.empty()) line.names.push_back(option.get_single_name());
  line.help = option.get_description();
  line.again = option.get_expected_max() > 1;
  if (option.get_items_expected_max() == 0) return line;
  line.type = option.get_type_name();
  line.words = words_of(line.type);
  line.takes = !line.words.empty()                                                           ? Takes::kWords
               : has(line.type, "FILE") || has(line.type, "SCENE") || has(line.type, "MESH") ? Takes::kFile
               : has(line.type, "DIR")                                                       ? Takes::kFolder
                                                                                             : Takes::kText;
  return line;
}

void list_commands(const CLI::App& app, const std::vector<std::string>& path, std::vector<CommandLine>& out) {
  CommandLine command{.app = &app, .path = path, .options = {}, .positionals = {}, .below = {}};
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? command.positionals : command.options).push_back(line_of(*option));
  for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; }))
    command.below.push_back(below);
  out.push_back(command);
  for (const CLI::App* below : command.below) {
    std::vector<std::string> further = path;
    further.push_back(below->get_name());
    list_commands(*below, further, out);
  }
}

std::vector<CommandLine> list_commands(const CLI::App& app) {
  std::vector<CommandLine> out;
  list_commands(app, {}, out);
  return out;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

std::vector<std::string> all_names(const std::vector<OptionLine>& options) {
  std::vector<std::string> out;
  for (const OptionLine& option : options) out.insert(out.end(), option.names.begin(), option.names.end());
  return out;
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> out;
  out.reserve(commands.size());
  for (const CLI::App* command : commands) out.push_back(command->get_name());
  return out;
}

/// The text with a backslash before each of `which`.
std::string escaped(const std::string& text, const char* which) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(which).find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

// ---- bash ----

std::string bash_script(const std::vector<CommandLine>& commands) {
  std::string paths, offers, values;
  for (const CommandLine& command : commands) {
    const std::string path = joined(command.path, " ");
    if (!command.path.empty()) {
      const std::vector<std::string> above(command.path.begin(), command.path.end() - 1);
      paths += fmt::format("      '{} {}') path='{}' ;;\n", joined(above, " "), command.path.back(), path);
    }
    const OptionLine own = command.positionals.empty() ? OptionLine{} : command.positionals.front();
    offers += fmt::format("    '{}') commands='{}' options='{}' words='{}' files={} ;;\n", path,
                          joined(names_of(command.below), " "), joined(all_names(command.options), " "),
                          joined(own.words, " "), own.takes == Takes::kFile ? "yes" : "");
    for (const OptionLine& option : command.options) {
      if (option.takes == Takes::kNothing) continue;
      std::vector<std::string> cases;
      for (const std::string& name : option.names) cases.push_back("'" + path + " " + name + "'");
      const std::string reply =
          option.takes == Takes::kWords
              ? fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", joined(option.words, " "))
          : option.takes == Takes::kFile   ? "COMPREPLY=($(compgen -f -- \"$cur\"))"
          : option.takes == Takes::kFolder ? "COMPREPLY=($(compgen -d -- \"$cur\"))"
                                           : "COMPREPLY=()";
      values += fmt::format("    {}) {}; return ;;\n", joined(cases, "|"), reply);
    }
  }
  return "# bash completion of palpate; made by `palpate completions bash`\n"
         "_palpate() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} path= commands= options= "
         "words= files= i\n"
         "  local IFS=$' \\t\\n'\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case \"$path ${COMP_WORDS[i]}\" in\n" +
         paths +
         "    esac\n"
         "  done\n"
         "  case \"$path\" in\n" +
         offers +
         "  esac\n"
         "  case \"$path $prev\" in\n" +
         values +
         "  esac\n"
         "  if [[ $cur == -* ]]; then COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n"
         "  elif [[ -n $commands$words ]]; then COMPREPLY=($(compgen -W \"$commands $words\" -- \"$cur\"))\n"
         "  elif [[ -n $files ]]; then IFS=$'\\n'; COMPREPLY=($(compgen -f -- \"$cur\"))\n"
         "  else COMPREPLY=()\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _palpate palpate\n";
}

// ---- zsh ----

std::string quoted_for_zsh(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// What stands behind an option's or a positional's name: ":what:how to complete it".
std::string zsh_value(const OptionLine& option) {
  const std::string how = option.takes == Takes::kWords    ? "(" + joined(option.words, " ") + ")"
                          : option.takes == Takes::kFile   ? "_files"
                          : option.takes == Takes::kFolder ? "_files -/"
                                                           : " ";
  return ":" + escaped(option.type, "\\:[]") + ":" + how;
}

std::string zsh_script(const std::vector<CommandLine>& commands) {
  std::string out = "#compdef palpate\n# zsh completion of palpate; made by `palpate completions zsh`\n";
  for (const CommandLine& command : commands) {
    out += "\n_palpate" + (command.path.empty() ? "" : "_" + joined(command.path, "_")) + "() {\n";
    if (!command.below.empty()) out += "  local state line\n";
    out += "  _arguments -s";
    if (!command.below.empty()) out += " -C";
    for (const OptionLine& option : command.options)
      for (const std::string& name : option.names) {
        std::string spec = (option.again ? "*" : "") + name + "[" + escaped(option.help, "\\:[]") + "]";
        if (option.takes != Takes::kNothing) spec += zsh_value(option);
        out += " \\\n    " + quoted_for_zsh(spec);
      }
    for (const OptionLine& positional : command.positionals)
      out += " \\\n    " + quoted_for_zsh((positional.again ? "*" : "") + zsh_value(positional));
    if (command.below.empty()) {
      out += "\n}\n";
      continue;
    }
    out +=
        " \\\n    '1:command:->command' '*::argument:->argument'\n  case $state in\n  command) local -a "
        "all=(";
    for (const CLI::App* below : command.below)
      out += "\n    " + quoted_for_zsh(below->get_name() + ":" + escaped(below->get_description(), "\\:"));
    out += "\n    ); _describe command all ;;\n  argument) case $line[1] in\n";
    for (const CLI::App* below : command.below) {
      std::vector<std::string> path = command.path;
      path.push_back(below->get_name());
      out += fmt::format("    {}) _palpate_{} ;;\n", below->get_name(), joined(path, "_"));
    }
    out += "    esac ;;\n  esac\n}\n";
  }
  return out +
         "\nif [ \"$funcstack[1]\" = _palpate ]; then _palpate \"$@\"; else compdef _palpate palpate; fi\n";
}

// ---- fish ----

std::string quoted_for_fish(const std::string& text) { return "'" + escaped(text, "\\'") + "'"; }

/// Where a command's own words may stand: each word of its path, and none of the commands that are called
/// like one of its others.
std::string fish_place(const CommandLine& command, const std::vector<CommandLine>& commands) {
  if (command.path.empty()) return "__fish_use_subcommand";
  std::string out;
  for (const std::string& word : command.path)
    out += (out.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
  if (!command.below.empty())
    out += "; and not __fish_seen_subcommand_from " + joined(names_of(command.below), " ");
  for (const CommandLine& other : commands)
    if (command.path.size() == 1 && other.path.size() == 2 && other.path.back() == command.path.front())
      out += "; and not __fish_seen_subcommand_from " + other.path.front();
  return out;
}

std::string fish_script(const std::vector<CommandLine>& commands) {
  std::string out = "# fish completion of palpate; made by `palpate completions fish`\n";
  for (const CommandLine& command : commands) {
    const std::string start =
        fmt::format("complete -c palpate -n {}", quoted_for_fish(fish_place(command, commands)));
    for (const CLI::App* below : command.below)
      out += fmt::format("{} -f -a {} -d {}\n", start, below->get_name(),
                         quoted_for_fish(below->get_description()));
    for (const OptionLine& option : command.options) {
      out += start;
      for (const std::string& name : option.names)
        out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.takes == Takes::kWords)
        out += " -x -a " + quoted_for_fish(joined(option.words, " "));
      else if (option.takes == Takes::kFile)
        out += " -r -F";
      else if (option.takes == Takes::kFolder)
        out += " -x -a '(__fish_complete_directories)'";
      else if (option.takes == Takes::kText)
        out += " -x";
      out += " -d " + quoted_for_fish(option.help) + "\n";
    }
    for (const OptionLine& positional : command.positionals)
      if (positional.takes == Takes::kWords)
        out += start + " -f -a " + quoted_for_fish(joined(positional.words, " ")) + "\n";
  }
  return out;
}

// ---- manual pages ----

/// Text that roff takes for text: no escapes, no macros at a line's beginning.
std::string roff(const std::string& text, bool hyphens_as_minus = false) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-' && hyphens_as_minus)
      out += "\\-";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

/// Lines as they stand.
std::string roff_block(const std::string& text) { return ".nf\n" + roff(text, true) + "\n.fi\n"; }

std::string roff_options(const std::vector<OptionLine>& options) {
  std::string out;
  for (const OptionLine& option : options) {
    out += ".TP\n.B \"" + roff(escaped(joined(option.names, ", "), ""), true);
    std::string type = option.type;
    std::replace(type.begin(), type.end(), '"', '\'');
    if (!type.empty() && option.names.front() != type) out += " " + roff(type, true);
    out += "\"\n" + (option.help.empty() ? std::string("\\&") : roff(option.help)) + "\n";
  }
  return out;
}

std::string page_name(const std::string& command) {
  return command.empty() ? "palpate" : "palpate-" + command;
}

void add_command(const CommandLine& command, std::string& out) {
  const std::string name = "palpate" + (command.path.empty() ? "" : " " + joined(command.path, " "));
  out += ".B " + roff(name, true) + "\n";
  if (!command.options.empty()) out += "[options]";
  for (const OptionLine& positional : command.positionals)
    out += " " + roff(positional.type.empty() ? positional.names.front() : positional.type, true) +
           (positional.again ? " ..." : "");
  if (!command.below.empty()) out += " COMMAND ...";
  out += "\n";
}

}  // namespace

std::string completion_script(const CLI::App& app, const std::string& shell) {
  const std::vector<CommandLine> commands = list_commands(app);
  return shell == "bash"  ? bash_script(commands)
         : shell == "zsh" ? zsh_script(commands)
                          : fish_script(commands);
}

std::string manual_page(const CLI::App& app, const std::string& command, const std::string& version) {
  const std::vector<CommandLine> commands = list_commands(app);
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const CommandLine& line) { return joined(line.path, " ") == command; });
  if (found == commands.end()) return {};
  std::string title = page_name(command);
  std::transform(title.begin(), title.end(), title.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  const std::string about = command.empty() ? "exact contacts and forces between a tool and a large mock-up"
                                            : found->app->get_description();
  std::string out =
      fmt::format(".TH {} 1 \"\" \"palpate {}\" \"palpate\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
                  roff(title, true), version, roff(page_name(command), true), roff(about));
  add_command(*found, out);
  if (command.empty()) out += ".SH DESCRIPTION\n" + roff(found->app->get_description()) + "\n";
  if (!found->below.empty()) {
    out += ".SH COMMANDS\n";
    for (const CLI::App* below : found->below)
      out += ".TP\n.B " + roff(below->get_name(), true) + "\n" + roff(below->get_description()) + "\n";
  }
  if (!found->positionals.empty()) out += ".SH ARGUMENTS\n" + roff_options(found->positionals);
  out += ".SH OPTIONS\n" + roff_options(found->options);
  if (!found->app->get_footer().empty()) out += ".SH NOTES\n" + roff_block(found->app->get_footer());
  // Commands of a command have no page of their own.
  if (!command.empty())
    for (const CommandLine& below : commands) {
      if (below.path.size() != 2 || below.path.front() != command) continue;
      out += ".SH " + roff("palpate " + joined(below.path, " "), true) + "\n" +
             roff(below.app->get_description()) + "\n.PP\n";
      add_command(below, out);
      if (!below.positionals.empty()) out += roff_options(below.positionals);
      out += roff_options(below.options);
      if (!below.app->get_footer().empty()) out += roff_block(below.app->get_footer());
    }
  out += ".SH SEE ALSO\n";
  std::string others;
  if (!command.empty())
    others = ".BR palpate (1)\n";
  else
    for (const CommandLine& other : commands)
      if (other.path.size() == 1)
        others += (others.empty() ? "" : ",\n") +
                  fmt::format(".BR {} (1)", roff(page_name(other.path.front()), true));
  return out + others + (command.empty() ? "\n" : "");
}

namespace {

/// Letters to add, drop or change, and neighbours to exchange.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::move(last);
    last = std::move(row);
    row.assign(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  const auto nearest = std::min_element(words.begin(), words.end(), [&](const auto& a, const auto& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  constexpr std::size_t kMostChanges = 2;  // chosen: a slip of the finger, or two letters exchanged
  return nearest != words.end() && edit_distance(word, *nearest) <= kMostChanges ? *nearest : std::string();
}

std::string unexpected_words(const CLI::App& command, const std::string& name,
                             const std::vector<std::string>& words) {
  const auto option =
      std::find_if(words.begin(), words.end(), [](const std::string& word) { return word.starts_with('-'); });
  if (option == words.end())
    return fmt::format("{} takes no further argument '{}'", name,
                       words.empty() ? std::string() : words.front());
  const std::string flag = option->substr(0, option->find('='));
  std::vector<std::string> known;
  for (const CLI::Option* one : command.get_options())
    for (const std::string& long_name : one->get_lnames()) known.push_back("--" + long_name);
  std::string guess = flag.starts_with("--") ? nearest_word(flag, known) : nearest_word("-" + flag, known);
  // Its beginning alone is near, too: "--dev".
  for (std::size_t i = 0; i < known.size() && guess.empty(); ++i)
    if (flag.size() > 4 && known[i].starts_with(flag)) guess = known[i];
  return fmt::format("'{}' is no option of {}{}", flag, name,
                     guess.empty() ? "" : fmt::format("; did you mean '{}'?", guess));
}

}  // namespace palpate
