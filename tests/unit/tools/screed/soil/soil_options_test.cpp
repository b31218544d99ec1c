// Options and JSON of `screed soil` against the table of soil parameters.
#include <gtest/gtest.h>

#include "tools/screed/soil/soil_common.h"

namespace screed {
namespace {

SoilArguments parsed(const std::string& arguments) {
  CLI::App command;
  SoilArguments soil;
  add_soil_options(command, soil);
  command.parse(arguments);
  return soil;
}

TEST(SoilOptions, EachSetsItsParameterAndShowsInTheJson) {
  for (const SoilParameterInfo& changed : kSoilParameters) {
    SCOPED_TRACE(changed.option);
    const SoilArguments arguments =
        parsed(std::string("--soil clay ") + changed.option + " " + std::to_string(changed.max));
    const SoilParameters soil = arguments.soil();
    EXPECT_EQ(soil.name, "clay, changed");
    const nlohmann::json json = soil_json(arguments);
    for (const SoilParameterInfo& parameter : kSoilParameters) {
      const double expected =
          &parameter == &changed ? changed.max : soil_preset("clay").*parameter.member;
      EXPECT_EQ(soil.*parameter.member, expected) << parameter.key;
      EXPECT_EQ(json.at(parameter.member_name), expected) << parameter.member_name;
    }
  }
}

TEST(SoilOptions, WithoutThemTheSoilIsThePreset) {
  const SoilArguments arguments = parsed("");
  EXPECT_EQ(arguments.soil().name, "viper");
  EXPECT_TRUE(arguments.as_peer());
  EXPECT_FALSE(parsed("--repose 31").as_peer());
  EXPECT_FALSE(parsed("--soil clay").as_peer());
}

TEST(SoilOptions, HelpSaysSymbolUnitAndRange) {
  CLI::App command;
  SoilArguments soil;
  add_soil_options(command, soil);
  EXPECT_EQ(command.get_option("--repose")->get_type_name(), "NUMBER:1 to 60");
  EXPECT_EQ(command.get_option("--elastic")->get_type_name(), "NUMBER:10000 to 1e+12");
  EXPECT_EQ(command.get_option("--repose")->get_description(), "Angle of repose [deg]");
  EXPECT_EQ(command.get_option("--elastic")->get_description(), "Stiffness of unloading E [Pa/m]");
  EXPECT_EQ(command.get_option("--k-phi")->get_description(),
            "Bekker's frictional modulus [N/m^(n+2)]; left out: the preset's");
  EXPECT_EQ(command.get_option("--slip-sinkage")->get_description(), "Growth of n with slip");
}

}  // namespace
}  // namespace screed
