// The command line read by CLI11. It is set up anew for each command line, with the options of
// those subcommands that the line names.
#include "tools/command_line/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <utility>

#include "host_sim/core/errors.h"
#include "tools/command_line/help.h"

namespace screed {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> last;
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  std::vector<std::size_t> next(b.size() + 1);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, changed});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) next[j] = std::min(next[j], last[j - 2] + 1);
    }
    last = row;
    row = next;
  }
  return row.back();
}

std::string nearest_word(const std::string& mistyped, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = 0;
  for (const std::string& word : words) {
    const std::size_t distance = edit_distance(mistyped, word);
    if (distance > std::max<std::size_t>(1, word.size() / 3)) continue;
    if (nearest.empty() || distance < least) {
      nearest = word;
      least = distance;
    }
  }
  return nearest;
}

std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(mistyped, words);
  return nearest.empty() ? "" : "; did you mean " + nearest + "?";
}

namespace {

/// An option, not a negative number.
bool is_option(const std::string& word) {
  const bool is_number = word.size() > 1 && (word[1] == '.' || (word[1] >= '0' && word[1] <= '9'));
  return word.size() > 1 && word[0] == '-' && word != "--" && !is_number;
}

std::string no_subcommand(const Command& command, const std::string& word) {
  std::vector<std::string> known;
  for (const auto& below : command.subcommands()) known.push_back(below->name());
  return "'" + word + "' is no subcommand" + did_you_mean(word, known);
}

std::string no_option(const Command& command, const std::string& word) {
  std::vector<std::string> known;
  for (const auto& option : command.options()) {
    for (const std::string& name : option->spec().names)
      if (name.rfind("--", 0) == 0) known.push_back(name);
  }
  const std::string name = word.substr(0, word.find('='));
  return "'" + name + "' is no option" + did_you_mean(name, known);
}

/// Refuses the first words where they are to lead to a subcommand and lead to none. The parser
/// looks at --help first.
void check_first_words(const Command& program, const std::vector<std::string>& words) {
  const Command* at = &program;
  for (const std::string& word : words) {
    if (is_option(word) || at->subcommands().empty()) return;
    const Command* below = at->subcommand(word);
    if (below == nullptr) throw UsageError(no_subcommand(*at, word), at->path());
    at = below;
  }
}

/// Adds an option with its target.
struct AddOption {
  CLI::App& app;
  const Option& option;

  template <class Value>
  CLI::Option* operator()(Value* value) const {
    return app.add_option(option.spec().written, *value);
  }
  CLI::Option* operator()(bool* value) const { return app.add_flag(option.spec().written, *value); }
  CLI::Option* operator()(const Option::Reader& read) const {
    return app.add_option(option.spec().written,
                          [this_option = &option, &read](const CLI::results_t& texts) {
                            read(*this_option, texts);
                            return true;
                          });
  }
  CLI::Option* operator()(const Option::ShowHelp&) const { return app.get_help_ptr(); }
  CLI::Option* operator()(const Option::ShowVersion& version) const {
    return app.set_version_flag(option.spec().written, version.text);
  }
};

CLI::Validator check_of(const Option::Range& range) {
  if (!range.whole) return CLI::Range(range.low, range.high);
  return CLI::Range(static_cast<int>(range.low), static_cast<int>(range.high));
}

CLI::Option* add_option(CLI::App& app, const Option& added) {
  const Option::Spec& spec = added.spec();
  CLI::Option* option = std::visit(AddOption{app, added}, spec.target);
  if (spec.type.has_value()) option->type_name(*spec.type);
  if (spec.values.has_value()) option->expected(spec.values->first, spec.values->second);
  if (spec.one_each) option->allow_extra_args(false);
  if (spec.delimiter != '\0') option->delimiter(spec.delimiter);
  if (spec.required) option->required();
  if (spec.range.has_value()) option->check(check_of(*spec.range));
  if (spec.positive) option->check(CLI::PositiveNumber);
  if (!spec.choices.empty() && !spec.takes_others) option->check(CLI::IsMember(spec.choices));
  return option;
}

class Parser {
 public:
  Parser(Command& program, const std::vector<std::string>& words)
      : program_(program), words_(words), app_("", program.name()) {
    add(app_, program);
  }

  std::string parse() {
    try {
      app_.parse(std::vector<std::string>(words_.rbegin(), words_.rend()));
      for (const auto& [option, read] : options_) option->set_given(read->count() > 0);
      for (const Command* at = &chosen(); at != nullptr; at = at->parent())
        if (at->callback()) at->callback()();
      return "";
    } catch (const CLI::CallForHelp&) {
      return help_page(chosen());
    } catch (const CLI::CallForVersion& version) {
      return std::string(version.what()) + "\n";
    } catch (const CLI::ParseError& error) {
      throw UsageError(what_is_wrong(error), chosen().path());
    } catch (const UsageError& error) {
      throw UsageError(error.what(), chosen().path());
    }
  }

 private:
  void add(CLI::App& app, Command& command) {
    const std::size_t first = options_.size();
    for (const auto& option : command.options())
      options_.emplace_back(option.get(), add_option(app, *option));
    for (std::size_t i = first; i < options_.size(); ++i) {
      const Option::Spec& spec = options_[i].first->spec();
      for (const Option* other : spec.needs) options_[i].second->needs(read_as(other));
      for (const Option* other : spec.excludes) options_[i].second->excludes(read_as(other));
    }
    if (command.subcommands().empty()) return;
    app.require_subcommand(1);
    for (const auto& below : command.subcommands()) {
      if (std::find(words_.begin(), words_.end(), below->name()) == words_.end()) continue;
      CLI::App* named = app.add_subcommand(below->name());
      named->fallthrough(below->falls_through());
      add(*named, *below);
    }
  }

  CLI::Option* read_as(const Option* option) const {
    return std::find_if(options_.begin(), options_.end(),
                        [&](const auto& it) { return it.first == option; })
        ->second;
  }

  /// The subcommand that the command line has come to.
  const Command& chosen() const {
    const Command* command = &program_;
    for (const CLI::App* at = &app_; !at->get_subcommands().empty();) {
      at = at->get_subcommands().back();
      command = command->subcommand(at->get_name());
    }
    return *command;
  }

  /// CLI11's words; or the word that is no subcommand or no option, and which was probably meant.
  std::string what_is_wrong(const CLI::ParseError& error) const {
    // Others name a value. One that misses a word may have come to it by a word that is too many.
    const bool of_a_word = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                           dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    const std::vector<std::string> unknown = app_.remaining(true);
    if (!of_a_word || unknown.empty()) return error.what();
    const Command& at = chosen();
    const std::string& word = unknown.front();
    if (is_option(word)) return no_option(at, word);
    return at.subcommands().empty() ? error.what() : no_subcommand(at, word);
  }

  Command& program_;
  const std::vector<std::string>& words_;
  CLI::App app_;
  std::vector<std::pair<Option*, CLI::Option*>> options_;
};

}  // namespace

std::string parse(Command& program, const std::vector<std::string>& words) {
  check_first_words(program, words);
  return Parser(program, words).parse();
}

int run_program(Command& program, int argc, char** argv, const std::function<int()>& body) {
  constexpr int kFailed = 1;
  constexpr int kWrongInput = 2;
  const auto fail = [&](int code, const std::string& what) {
    std::cerr << program.name() << ": " << what << "\n";
    return code;
  };
  std::signal(SIGXFSZ, SIG_IGN);  // past a limit of file sizes a write fails, as on a full disk
  try {
    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") {
      words.erase(words.begin());
      words.emplace_back("--help");
    }
    const std::string page = parse(program, words);
    if (page.empty()) return body();
    std::cout << page;
    return 0;
  } catch (const UsageError& error) {
    return fail(kWrongInput, error.what() + (" (see " + error.command()) + " --help)");
  } catch (const InputError& error) {
    return fail(kWrongInput, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, "out of memory");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace screed
