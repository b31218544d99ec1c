// The command line of a program as data: a command, its options and, below it, its subcommands.
//
// A program registers what it takes. Help, completion and manual are made from that
// (help.h), and program.h reads what a user typed. Nothing here knows by what library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace screed {

/// A command line that is wrong: what() says why in a line, command() whose --help says more.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& what, std::string command = "")
      : std::runtime_error(what), command_(std::move(command)) {}
  const std::string& command() const { return command_; }

 private:
  std::string command_;  ///< "screed sim"; empty: thrown by a callback or a reader
};

/// An option, a flag, or an argument that has a place. What sets one up returns it, so that several
/// can stand in one expression.
class Option {
 public:
  /// Takes the texts that were given for the option; throws UsageError.
  using Reader = std::function<void(const Option& option, const std::vector<std::string>& texts)>;
  struct ShowHelp {};
  struct ShowVersion {
    std::string text;
  };
  /// Where the value goes, which says what kind it is of.
  using Target =
      std::variant<std::string*, std::optional<std::string>*, std::vector<std::string>*,
                   std::filesystem::path*, bool*, int*, unsigned*, std::uint64_t*, double*,
                   std::optional<unsigned>*, std::vector<int>*, Reader, ShowHelp, ShowVersion>;
  /// Of a number that the parser reads itself.
  struct Range {
    double low;
    double high;
    bool whole;
  };
  struct Spec {
    std::string written;             ///< as it was registered: "-n,--count", "--on,!--off", "FILE"
    std::vector<std::string> names;  ///< short ones before long ones; of an argument "FILE"
    std::string help;
    Target target;
    std::optional<std::string> type;  ///< "FILE", "NUMBER:0 to 1"; none: that of the target
    std::string group = "Options";    ///< the heading that it stands below
    std::string fallback;             ///< the default as the help shows it; empty: not shown
    std::vector<std::string> choices;
    bool takes_others = false;  ///< the choices are but suggestions
    std::optional<Range> range;
    bool positive = false;
    std::optional<std::pair<int, int>> values;  ///< how many, at least and at most
    bool one_each = false;
    char delimiter = '\0';
    bool required = false;
    std::vector<const Option*> needs;
    std::vector<const Option*> excludes;
  };

  Option(const std::string& names, Target target, const std::string& help);
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

  Option* required();
  /// The word for its value in the help, "FILE", and behind a colon what it may be. FILE, FOLDER
  /// and DIR also say what a shell completes.
  Option* type_name(const std::string& word);
  Option* help_text(const std::string& text);
  /// Shows a default in the help: the value that the target has now, or this text.
  Option* show_default();
  Option* show_default(const std::string& text);
  /// The heading of the help that it stands below.
  Option* group(const std::string& heading);
  Option* one_of(const std::vector<std::string>& choices);
  /// As one_of(), for completion and help alone: any text is taken.
  Option* suggest(const std::vector<std::string>& words);
  /// Of a number that is not added by add_number().
  Option* range(int low, int high);
  Option* range(double low, double high);
  Option* positive();
  /// How many values; at most -1: any number. 0 to 1: the value may be left out.
  Option* expected(int least, int most);
  /// Of several values: one behind each time that the option is named, so that an argument may
  /// follow.
  Option* one_value_each();
  /// Of several values: they may stand in one text with this between them.
  Option* delimiter(char between);
  Option* needs(const Option* other);
  Option* excludes(Option* other);

  const Spec& spec() const { return spec_; }
  /// "--count"; "-n" where that is all; "FILE".
  std::string name() const;
  bool is_argument() const;
  bool is_flag() const;
  /// Whether it takes more than one value.
  bool is_repeated() const;
  /// Whether the command line that was parsed last has it.
  bool given() const { return given_; }
  void set_given(bool given) { given_ = given; }

 private:
  Spec spec_;
  bool given_ = false;
};

/// A program, or a subcommand. One that has subcommands needs one of them.
class Command {
 public:
  /// Has --help, whose help text subcommands take over when they are added.
  explicit Command(const std::string& help = "", const std::string& name = "");
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  template <class Value>
  Option* add_option(const std::string& names, Value& value, const std::string& help = "") {
    return add(names, &value, help);
  }
  /// True where it is given; of names behind an exclamation mark false.
  Option* add_flag(const std::string& names, bool& value, const std::string& help = "") {
    return add(names, &value, help);
  }
  Option* add_option(const std::string& names, const Option::Reader& read,
                     const std::string& help) {
    return add(names, read, help);
  }
  Command* add_subcommand(const std::string& name, const std::string& help);
  /// Called once the command line has been read, where it names this command.
  Command* callback(std::function<void()> function);
  /// Options that this subcommand does not know are those of the command above. What is added below
  /// it afterwards does the same.
  Command* fallthrough();
  void set_version_flag(const std::string& names, const std::string& text, const std::string& help);

  const std::string& name() const { return name_; }
  /// "screed session export"
  std::string path() const;
  const std::string& help() const { return help_; }
  const Command* parent() const { return parent_; }
  const std::vector<std::unique_ptr<Option>>& options() const { return options_; }
  const std::vector<std::unique_ptr<Command>>& subcommands() const { return subcommands_; }
  bool falls_through() const { return falls_through_; }
  const std::function<void()>& callback() const { return callback_; }
  /// The option of this name, "--count"; there must be one.
  Option* option(const std::string& name) const;
  /// Null: none of this name.
  Command* subcommand(const std::string& name) const;

 private:
  Option* add(const std::string& names, Option::Target target, const std::string& help);

  std::string name_;
  std::string help_;
  Command* parent_ = nullptr;
  std::vector<std::unique_ptr<Option>> options_;  ///< the first is --help
  std::vector<std::unique_ptr<Command>> subcommands_;
  std::function<void()> callback_;
  bool falls_through_ = false;
};

}  // namespace screed
