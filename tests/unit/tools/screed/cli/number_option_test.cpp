// Numbers on the command line and in texts.
#include <gtest/gtest.h>

#include "tools/command_line/help.h"
#include "tools/command_line/program.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

// Options that are numbers: what is taken, what is refused and how, what the help shows.

/// What the parser says about these arguments; "" when it takes them.
std::string refusal(Command& app, const std::vector<std::string>& arguments) {
  try {
    parse(app, arguments);
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

template <class Value>
std::string refusal(const std::string& text, const NumberRange& range) {
  Command app;
  Value value{};
  add_number(app, "--x", value, "", range);
  return refusal(app, {"--x", text});
}

template <class Value>
Value taken(const std::string& text, const NumberRange& range) {
  Command app;
  Value value{};
  add_number(app, "--x", value, "", range);
  EXPECT_EQ(refusal(app, {"--x", text}), "") << text;
  return value;
}

/// The option in the help: value and details.
std::string shown(const Command& app) {
  const OptionWords words = words_of(*app.option("--x"));
  return words.value + " " + details(words);
}

TEST(NumberOption, TakesBothEndsOfItsRange) {
  EXPECT_EQ(taken<double>("0.01", {0.01, 1000.0}), 0.01);
  EXPECT_EQ(taken<double>("1e3", {0.01, 1000.0}), 1000.0);
  EXPECT_EQ(taken<float>("-2.5", {-2.5, 0.0}), -2.5F);
  EXPECT_EQ(taken<int>("-3", {-3, 3}), -3);
  EXPECT_EQ(taken<int>("+3", {-3, 3}), 3);
  EXPECT_EQ(taken<int>("010", {0, 10}), 10);  // not octal
  EXPECT_EQ(taken<std::uint64_t>("18446744073709551615", kSeedRange), UINT64_MAX);
  EXPECT_EQ(taken<std::optional<double>>("0.5", kShareRange), 0.5);
}

TEST(NumberOption, RefusesWhatIsNoNumberOfItsRange) {
  for (const char* text :
       {"nan", "-nan", "NAN", "inf", "-inf", "infinity", "1e999", "",  " ",      "1 ",
        " 1",  "1x",   "0x1", "1,2", "one",  "--1",      "+-1",   "+", "1000.1", "0.009"}) {
    EXPECT_NE(refusal<double>(text, {0.01, 1000.0}), "") << text;
    EXPECT_NE(refusal<std::optional<double>>(text, {0.01, 1000.0}), "") << text;
  }
  for (const char* text :
       {"nan", "inf", "1.5", "1e2", "", "1x", "0", "1001", "99999999999999999999", "4294967297"}) {
    EXPECT_NE(refusal<int>(text, {1, 1000}), "") << text;
    EXPECT_NE(refusal<std::size_t>(text, {1, 1000}), "") << text;
  }
  EXPECT_NE(refusal<std::uint64_t>("-1", kSeedRange), "");
  EXPECT_NE(refusal<std::uint64_t>("18446744073709551616", kSeedRange), "");
}

TEST(NumberOption, SaysInOneLineWhatIsAllowed) {
  EXPECT_EQ(refusal<double>("nan", {0.01, 10000.0}), "--x nan: allowed are 0.01 to 10000");
  EXPECT_EQ(refusal<int>("-3", {1, 1000000000}),
            "--x -3: allowed are whole numbers 1 to 1000000000");
  EXPECT_EQ(refusal<double>("", {1e-5, 1e12}), "--x '': allowed are 0.00001 to 1e+12");
  EXPECT_EQ(refusal<std::uint64_t>("-1", kSeedRange),
            "--x -1: allowed are whole numbers 0 to 18446744073709551615");
  EXPECT_EQ(refusal<int>("1\n2 3", {0, 1}), "--x '1?2 3': allowed are whole numbers 0 to 1");
  EXPECT_EQ(refusal<int>(std::string(500, '9'), {0, 1}),
            "--x " + std::string(40, '9') + "...: allowed are whole numbers 0 to 1");
}

TEST(NumberOption, ZeroCanStandForNone) {
  const NumberRange range = {.low = 0.5, .high = 2.0, .or_zero = true};
  EXPECT_EQ(taken<double>("0", range), 0.0);
  EXPECT_EQ(refusal<double>("0.1", range), "--x 0.1: allowed are 0.5 to 2, and 0");
}

TEST(NumberOption, WholeNumbersCanGoInSteps) {
  const NumberRange range = {.low = 8, .high = 80, .multiple_of = 8};
  EXPECT_EQ(taken<int>("16", range), 16);
  EXPECT_EQ(refusal<int>("12", range),
            "--x 12: allowed are whole numbers 8 to 80, each a multiple of 8");
}

TEST(NumberOption, SeveralReplaceTheDefaults) {
  Command app;
  std::vector<double> values = {7.0, 8.0};
  add_number(app, "--x", values, "", {-1.0, 10.0});
  EXPECT_EQ(shown(app), "NUMBER (-1 to 10; may be repeated; default: 7,8)");
  EXPECT_EQ(refusal(app, {"--x", "1,-0.5", "--x", "3"}), "");
  EXPECT_EQ(values, (std::vector<double>{1.0, -0.5, 3.0}));
  EXPECT_EQ(refusal(app, {"--x", "1,,3"}), "--x '': allowed are -1 to 10");
  EXPECT_EQ(refusal(app, {"--x", "1,nan"}), "--x nan: allowed are -1 to 10");
  EXPECT_NE(refusal(app, {"--x", "[]"}), "");
}

TEST(NumberOption, HelpShowsRangeAndDefault) {
  Command app;
  double value = 0.25;
  add_number(app, "--x", value, "", {0.0001, 1e6});
  EXPECT_EQ(shown(app), "NUMBER (0.0001 to 1000000; default: 0.25)");

  Command other;
  std::optional<int> count;
  add_number(other, "--x", count, "", {.low = 1, .high = 9, .or_zero = true});
  EXPECT_EQ(shown(other), "INTEGER (0 or 1 to 9)");
}

TEST(NumberOption, NamesPositionalsAndShortOptions) {
  Command app;
  int value = 0;
  double other = 0.0;
  add_number(app, "COUNT", value, "", {1, 2});
  add_number(app, "-k", other, "", {1, 2});
  EXPECT_EQ(refusal(app, {"7"}), "COUNT 7: allowed are whole numbers 1 to 2");
  EXPECT_EQ(refusal(app, {"-k", "7"}), "-k 7: allowed are 1 to 2");
}

TEST(NumberText, ReadsAPairOfSides) {
  EXPECT_EQ(whole_pair("40x30"), std::pair(40, 30));
  for (const char* text :
       {"", "x", "40", "40x", "x30", "40x30x", "40x30 ", "4.5x3", "nanxnan", "99999999999x30"}) {
    EXPECT_FALSE(whole_pair(text).has_value()) << text;
  }
}

// Numbers as messages show them.

TEST(FactorText, HasTwoDigitsBelowTen) {
  EXPECT_EQ(factor_text(0.0), "0");
  EXPECT_EQ(factor_text(0.0343), "0.034");
  EXPECT_EQ(factor_text(0.4), "0.40");
  EXPECT_EQ(factor_text(0.0996), "0.10");
  EXPECT_EQ(factor_text(1.04), "1.0");
  EXPECT_EQ(factor_text(9.94), "9.9");
  EXPECT_EQ(factor_text(9.96), "10");
  EXPECT_EQ(factor_text(12.6), "13");
  EXPECT_EQ(factor_text(1234.4), "1234");
}

TEST(ChangeText, SaysWhetherItIsBetter) {
  EXPECT_EQ(change_text(20.0, 13.0), "-35.0 % better");
  EXPECT_EQ(change_text(20.0, 21.0), "+5.0 % worse");
  EXPECT_EQ(change_text(20.0, 20.001), "");
  EXPECT_EQ(change_text(0.0, 0.0), "");
  EXPECT_EQ(change_text(0.0, 1.0), "worse");
  EXPECT_EQ(share_change_text(0.25, 0.5), "+25.0 points better");
  EXPECT_EQ(share_change_text(0.5, 0.498), "-0.2 points worse");
  EXPECT_EQ(share_change_text(0.5, 0.5), "");
}

}  // namespace
}  // namespace screed
