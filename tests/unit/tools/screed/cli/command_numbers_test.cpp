// Every numeric option of every subcommand, against texts that are no number of its range. A new
// option that is a number, but was not added by add_number(), fails here as well.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/temp_folder.h"
#include "tools/command_line/help.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

struct OptionPlace {
  std::vector<std::string> path;  ///< of subcommands
  const Option* option;

  std::string text() const {
    std::string all = "screed";
    for (const std::string& name : path) all += " " + name;
    return all + " " + option->name();
  }
};

/// In the order of their registration.
std::vector<OptionPlace> every_option(Command& app) {
  std::vector<OptionPlace> places;
  const std::function<void(Command*, const std::vector<std::string>&)> walk =
      [&](Command* at, const std::vector<std::string>& path) {
        for (const auto& option : at->options()) places.push_back({path, option.get()});
        for (const auto& below : at->subcommands()) {
          std::vector<std::string> longer = path;
          longer.push_back(below->name());
          walk(below.get(), longer);
        }
      };
  walk(&app, {});
  return places;
}

struct Limits {
  bool whole;
  double low;
  double high;
};

/// From the words of the help, "0.01 to 1000" or "0 or 1 to 10" or "1 or more": what a user sees is
/// what is tested.
std::optional<Limits> limits_of(const Option& option) {
  static const std::regex form("(?:0 or )?([^ ]+) to ([^ ]+)");
  static const std::regex open_form("([^ ]+) or more");
  const OptionWords words = words_of(option);
  if (!std::holds_alternative<Option::Reader>(option.spec().target)) return std::nullopt;
  const bool whole = words.value == "INTEGER";
  if (!whole && words.value != "NUMBER") return std::nullopt;
  std::smatch match;
  if (std::regex_match(words.range, match, open_form))
    return Limits{whole, finite_number<double>(match.str(1)).value(), kSeedRange.high};
  if (!std::regex_match(words.range, match, form)) return std::nullopt;
  return Limits{whole, finite_number<double>(match.str(1)).value(),
                finite_number<double>(match.str(2)).value()};
}

/// How the program ends on a command line, and what it says. Nothing is run.
struct Ending {
  int exit_code;
  bool ran;
  std::string err;
};

Ending ending_of(CommandLine& line, const std::vector<std::string>& arguments) {
  std::vector<std::string> texts = arguments;
  texts.insert(texts.begin(), "screed");
  std::vector<char*> pointers;
  pointers.reserve(texts.size());
  for (std::string& text : texts) pointers.push_back(text.data());
  bool ran = false;
  ::testing::internal::CaptureStderr();
  const int code =
      run_program(line.app, static_cast<int>(pointers.size()), pointers.data(), [&ran] {
        ran = true;
        return 0;
      });
  return {code, ran, ::testing::internal::GetCapturedStderr()};
}

std::vector<std::string> with_value(const OptionPlace& place, const std::string& value) {
  std::vector<std::string> arguments = place.path;
  arguments.push_back(place.option->is_argument() ? "--" : place.option->name());
  // A positional of numbers alone may stand behind others.
  const std::string first = "0";
  if (place.option->name() == "YAW_RATE") arguments.push_back(first);
  arguments.push_back(value);
  return arguments;
}

std::vector<std::string> wrong_values(const Limits& limits) {
  std::vector<std::string> values = {"nan", "-nan",  "inf", "-inf", "1e999", "-1e999",
                                     "",    "12abc", "abc", " ",    "0x10",  "1;2"};
  if (limits.whole) values.insert(values.end(), {"1.5", "1e2", "99999999999999999999"});
  if (limits.low >= 0.0) values.insert(values.end(), {"-1", "-1e-9"});
  if (limits.high < 1e18) values.push_back(plain_text(limits.high * 1.01 + 1.0));
  return values;
}

TEST(CommandNumbers, EveryOneRefusesWhatIsNoNumberOfItsRange) {
  const TempFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  CommandLine line("1.2.3", "screed 1.2.3");
  int numbers = 0;
  for (const OptionPlace& place : every_option(line.app)) {
    const std::optional<Limits> limits = limits_of(*place.option);
    if (!limits) continue;
    ++numbers;
    EXPECT_LT(limits->low, limits->high) << place.text();
    for (const std::string& value : wrong_values(*limits)) {
      SCOPED_TRACE(place.text() + " '" + value + "'");
      const Ending ending = ending_of(line, with_value(place, value));
      EXPECT_EQ(ending.exit_code, 2);
      EXPECT_FALSE(ending.ran);
      EXPECT_EQ(std::count(ending.err.begin(), ending.err.end(), '\n'), 1) << ending.err;
      EXPECT_LT(ending.err.size(), 200U) << ending.err;
      EXPECT_EQ(ending.err.rfind("screed: " + place.option->name() + " ", 0), 0U) << ending.err;
      EXPECT_NE(ending.err.find(": allowed are "), std::string::npos) << ending.err;
    }
  }
  EXPECT_GT(numbers, 130);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::filesystem::current_path(before);
}

TEST(CommandNumbers, EveryOneTakesTheEndsOfItsRange) {
  CommandLine line("1.2.3", "screed 1.2.3");
  for (const OptionPlace& place : every_option(line.app)) {
    const std::optional<Limits> limits = limits_of(*place.option);
    if (!limits || limits->high > 1e18) continue;
    for (const double end : {limits->low, limits->high}) {
      const std::string value = plain_text(end);
      const Ending ending = ending_of(line, with_value(place, value));
      EXPECT_EQ(ending.err.find(": allowed are "), std::string::npos)
          << place.text() << " " << value << ": " << ending.err;
    }
  }
}

/// Whether the parser reads it as a number by itself, with any check or none.
bool is_unchecked_number(const Option& option) {
  static const std::regex numeric("INTEGER|NUMBER");
  return !option.is_flag() && !limits_of(option) &&
         std::regex_search(words_of(option).value, numeric);
}

TEST(CommandNumbers, AnOptionWithoutARangeIsNoticed) {
  Command app;
  double real = 0.0;
  std::optional<unsigned> count;
  std::vector<int> several;
  std::string text;
  bool flag = false;
  EXPECT_TRUE(is_unchecked_number(*app.add_option("--a", real)));
  EXPECT_TRUE(is_unchecked_number(*app.add_option("--b", real)->range(0.0, 1.0)));
  EXPECT_TRUE(is_unchecked_number(*app.add_option("--c", count)->positive()));
  EXPECT_TRUE(is_unchecked_number(*app.add_option("--d", several)->delimiter(',')));
  EXPECT_FALSE(is_unchecked_number(*app.add_option("--e", text)));
  EXPECT_FALSE(is_unchecked_number(*app.add_flag("--f", flag)));
  EXPECT_FALSE(is_unchecked_number(*add_number(app, "--g", several, "", {1, 2})));
  EXPECT_FALSE(is_unchecked_number(*add_number(app, "--h", real, "", {.low = 1.0, .high = 2.0})));
}

TEST(CommandNumbers, NoneIsWithoutARange) {
  CommandLine line("1.2.3", "screed 1.2.3");
  for (const OptionPlace& place : every_option(line.app)) {
    EXPECT_FALSE(is_unchecked_number(*place.option))
        << place.text() << " is a " << words_of(*place.option).value
        << ": use add_number() of tools/screed/cli/number_option.h";
  }
}

TEST(CommandNumbers, NoneIsHiddenInAText) {
  // Texts of a form of their own; their commands' tests refuse what is wrong with them.
  const std::set<std::string> own_form = {"screed sim --size",        "screed view --size",
                                          "screed grid --size",       "screed sim --key-script",
                                          "screed view --key-script", "screed render --camera"};
  static const std::regex sounds_numeric("\\[[^\\]]+\\]|[Nn]umber of|^Seed|^Time|^Duration",
                                         std::regex::ECMAScript);
  // Names in brackets that are no units: "[map]", "[experiment]".
  static const std::regex section("\\[(map|experiment|parameters|soil)\\]");
  CommandLine line("1.2.3", "screed 1.2.3");
  for (const OptionPlace& place : every_option(line.app)) {
    if (place.option->is_flag() || limits_of(*place.option)) continue;
    if (own_form.count(place.text()) > 0) continue;
    const std::string help = std::regex_replace(place.option->spec().help, section, "");
    EXPECT_FALSE(std::regex_search(help, sounds_numeric))
        << place.text() << ": \"" << place.option->spec().help
        << "\": is it a number? then add_number(), else say so here";
  }
}

}  // namespace
}  // namespace screed
