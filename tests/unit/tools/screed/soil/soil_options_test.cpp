// Options and JSON of `screed soil` against the table of soil parameters.
#include <gtest/gtest.h>

#include "tools/command_line/help.h"
#include "tools/command_line/program.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

SoilArguments parsed(const std::vector<std::string>& words) {
  Command command;
  SoilArguments soil;
  add_soil_options(command, soil);
  parse(command, words);
  return soil;
}

TEST(SoilOptions, EachSetsItsParameterAndShowsInTheJson) {
  for (const SoilParameterInfo& changed : kSoilParameters) {
    SCOPED_TRACE(changed.option);
    const SoilArguments arguments =
        parsed({"--soil", "clay", changed.option, std::to_string(changed.max)});
    const SoilParameters soil = arguments.soil();
    EXPECT_EQ(soil.name, "clay, changed");
    const Json json = soil_json(arguments);
    for (const SoilParameterInfo& parameter : kSoilParameters) {
      const double expected =
          &parameter == &changed ? changed.max : soil_preset("clay").*parameter.member;
      EXPECT_EQ(soil.*parameter.member, expected) << parameter.key;
      EXPECT_EQ(json.at(parameter.member_name), expected) << parameter.member_name;
    }
  }
}

TEST(SoilOptions, WithoutThemTheSoilIsThePreset) {
  const SoilArguments arguments = parsed({});
  EXPECT_EQ(arguments.soil().name, "viper");
  EXPECT_TRUE(arguments.as_peer());
  EXPECT_FALSE(parsed({"--repose", "31"}).as_peer());
  EXPECT_FALSE(parsed({"--soil", "clay"}).as_peer());
}

TEST(SoilOptions, HelpSaysSymbolUnitAndRange) {
  Command command;
  SoilArguments soil;
  add_soil_options(command, soil);
  const auto words = [&](const char* name) { return words_of(*command.option(name)); };
  EXPECT_EQ(words("--repose").value, "NUMBER");
  EXPECT_EQ(words("--repose").range, "1 to 60");
  EXPECT_EQ(words("--elastic").value, "NUMBER");
  EXPECT_EQ(words("--elastic").range, "100000 to 1e+12");
  EXPECT_EQ(words("--repose").help, "Angle of repose [deg]");
  EXPECT_EQ(words("--elastic").help, "Stiffness of unloading E [Pa/m]");
  EXPECT_EQ(words("--k-phi").help,
            "Bekker's frictional modulus [N/m^(n+2)]; left out: the preset's");
  EXPECT_EQ(words("--slip-bearing").help,
            "Share of its bearing that soil keeps below a surface that slides over it; 1: all");
}

}  // namespace
}  // namespace screed
