// Parameters of soils, and the stress below a wheel.
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/name_list.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "tests/temp_folder.h"

namespace screed {

namespace {

// The table of soil parameters and the named soils.

std::string refusal(const SoilParameters& soil) {
  try {
    check_soil(soil);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SoilParameters, EachIsAcceptedUpToItsEndsAndRefusedBeyond) {
  for (const SoilParameterInfo& parameter : kSoilParameters) {
    SCOPED_TRACE(parameter.key);
    const double past = std::max(1e-3, parameter.max * 1e-6);
    SoilParameters soil = soil_preset("lete_sand");
    soil.*parameter.member = parameter.min;
    EXPECT_EQ(refusal(soil), "");
    soil.*parameter.member = parameter.max;
    EXPECT_EQ(refusal(soil), "");
    for (const double bad : {parameter.min - past, parameter.max + past, std::nan("")}) {
      soil.*parameter.member = bad;
      const std::string message = refusal(soil);
      EXPECT_EQ(message.rfind(std::string("[soil] ") + parameter.key + " = ", 0), 0U) << message;
      EXPECT_TRUE(message.ends_with(" to " + shortest(parameter.max))) << message;
    }
  }
}

TEST(SoilParameters, ASoilThatCarriesNothingIsRefused) {
  SoilParameters soil = soil_preset("viper");
  soil.k_phi = 0.0;
  EXPECT_EQ(refusal(soil).rfind("[soil] k_phi + [soil] k_c = ", 0), 0U) << refusal(soil);
  soil.k_c = 1.0;
  EXPECT_EQ(refusal(soil), "");
}

TEST(SoilParameters, OverridesReplaceWhatTheySayAndNothingElse) {
  const SoilParameters preset = soil_preset("clay");
  for (const SoilParameterInfo& changed : kSoilParameters) {
    SCOPED_TRACE(changed.key);
    SoilOverrides overrides;
    EXPECT_TRUE(overrides.empty());
    overrides.*changed.override_member = 0.625;
    EXPECT_FALSE(overrides.empty());
    SoilParameters soil = preset;
    overrides.apply_to(soil);
    EXPECT_EQ(soil.name, "clay");
    for (const SoilParameterInfo& parameter : kSoilParameters) {
      const double expected = &parameter == &changed ? 0.625 : preset.*parameter.member;
      EXPECT_EQ(soil.*parameter.member, expected) << parameter.key;
    }
  }
}

TEST(SoilParameters, NoMemberStandsInTwoRows) {
  SoilParameters soil;
  double number = 1.0;
  for (const SoilParameterInfo& parameter : kSoilParameters) soil.*parameter.member = number++;
  std::set<double> numbers;
  for (const SoilParameterInfo& parameter : kSoilParameters)
    EXPECT_TRUE(numbers.insert(soil.*parameter.member).second) << parameter.key;
}

TEST(SoilPresets, AreSoundAndFoundByTheirNames) {
  std::set<std::string> names;
  for (const SoilPreset& preset : soil_presets()) {
    SCOPED_TRACE(preset.soil.name);
    EXPECT_TRUE(names.insert(preset.soil.name).second) << "stands twice";
    EXPECT_EQ(refusal(preset.soil), "");
    EXPECT_EQ(&soil_preset(preset.soil.name), &preset.soil);
    EXPECT_EQ(&soil_tones(preset.soil.name), &preset.tones);
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_LE(preset.tones.dark.at(i), preset.tones.light.at(i));
      EXPECT_GE(preset.tones.dark.at(i), 0.0);
      EXPECT_LE(preset.tones.light.at(i), 1.0);
    }
  }
}

TEST(SoilPresets, AnUnknownNameIsToldTheKnownOnes) {
  try {
    soil_preset("custard");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "unknown soil 'custard'; known are " + name_list(soil_preset_names()));
  }
  EXPECT_EQ(soil_tones("custard").light, soil_tones("viper").light);
}

// docs/soil.md, Soils: name, k_phi, k_c, n, c, phi, K, E, source.
TEST(SoilPresets, DocsHaveTheirNumbers) {
  const std::string page = read_text("docs/soil.md");
  for (const SoilPreset& preset : soil_presets()) {
    SCOPED_TRACE(preset.soil.name);
    const size_t begin = page.find("\n| " + preset.soil.name + " | ");
    ASSERT_NE(begin, std::string::npos) << "no row in the table of soils";
    std::istringstream row(page.substr(begin + 3, page.find('\n', begin + 1) - begin - 3));
    std::string cell;
    std::getline(row, cell, '|');
    for (const char* key : {"k_phi", "k_c", "n", "c", "phi", "K", "E"}) {
      std::getline(row, cell, '|');
      for (const SoilParameterInfo& parameter : kSoilParameters) {
        if (std::string_view(parameter.key) != key) continue;
        EXPECT_DOUBLE_EQ(std::strtod(cell.c_str(), nullptr), preset.soil.*parameter.member) << key;
      }
    }
  }
}

TEST(NameList, IsReadByPeople) {
  EXPECT_EQ(name_list({}), "");
  EXPECT_EQ(name_list({"a"}, " or "), "a");
  EXPECT_EQ(name_list({"a", "b"}, " or "), "a or b");
  EXPECT_EQ(name_list({"a", "b", "c"}, " or "), "a, b or c");
  EXPECT_EQ(name_list({"a", "b", "c"}), "a, b, c");
}

// The stress below a wheel as a lift of its points, against Wong and Reece's formulas written out.

TEST(WheelStressTest, PointsBehindTheGreatestStressBearAsThoseAhead) {
  SoilParameters soil;
  soil.front_angle = 0.3;
  soil.front_angle_braked = 0.4;
  soil.exit_angle = 0.5;
  constexpr double kRadius = 0.05;
  for (const double slip : {-0.5, 0.0, 0.6}) {
    for (const double entry : {0.3, 0.9, 1.4}) {
      const WheelStress stress(soil, kRadius, entry, slip, 1.0);
      const double middle = (0.3 + 0.4 * std::max(0.0, -slip)) * entry;
      const double exit = -0.5 * entry;
      ASSERT_TRUE(stress.shaped());
      EXPECT_DOUBLE_EQ(stress.exit_rad(), exit);
      for (double theta = exit; theta <= std::min(entry, 1.5); theta += 0.02) {
        const double lift = stress.lift(std::sin(theta));
        const double ahead = entry - (theta - exit) * (entry - middle) / (middle - exit);
        const double wanted =
            theta >= middle ? 0.0 : kRadius * (std::cos(std::max(theta, 0.0)) - std::cos(ahead));
        EXPECT_NEAR(lift, wanted, 3e-5 * kRadius) << slip << " " << entry << " " << theta;
      }
      // Where it leaves the soil it bears as at its entry: nothing.
      EXPECT_NEAR(stress.lift(std::sin(exit)), kRadius * (1.0 - std::cos(entry)), 3e-5 * kRadius);
    }
  }
}

TEST(WheelStressTest, AWheelThatIsSetDownBearsEvenly) {
  SoilParameters soil;
  soil.front_angle = 0.3;
  EXPECT_FALSE(WheelStress(soil, 0.05, 0.5, 0.0, 0.0).shaped());
  const double sine = 0.05;
  EXPECT_NEAR(WheelStress(soil, 0.05, 0.5, 0.0, 0.5).lift(sine),
              0.5 * WheelStress(soil, 0.05, 0.5, 0.0, 1.0).lift(sine), 1e-12);
}

// At 30 degrees X = 30, cot X = tan(X + phi) = sqrt(3): D1 = D2 = 2 sqrt(3).
TEST(SlipBearingTest, FallsFromAllToItsShareWithTheRatioOfBothSpeeds) {
  EXPECT_DOUBLE_EQ(bearing_under_slip(0.2, 0.01, 0.0), 1.0) << "nothing slides";
  EXPECT_DOUBLE_EQ(bearing_under_slip(0.2, 0.0, 0.01), 0.2) << "nothing goes in";
  EXPECT_DOUBLE_EQ(bearing_under_slip(0.2, 0.005, 0.01), 0.6);
  EXPECT_DOUBLE_EQ(bearing_under_slip(0.2, -0.005, 0.01), 0.6) << "nor out";
  EXPECT_DOUBLE_EQ(bearing_under_slip(0.2, 0.02, 0.01), 1.0);
  EXPECT_DOUBLE_EQ(slip_flow(0.25, 0.1), 1.45 * 0.25 * 0.0999);
  EXPECT_EQ(slip_flow(1.0, 5e-5), 0.0) << "what trembles does not flow";
}

TEST(SlipEvidence, EverySoilLiesInItsRange) {
  for (const SoilPreset& preset : soil_presets()) {
    const SlipEvidence& known = *slip_evidence(preset.soil.name);
    EXPECT_GE(preset.soil.slip_bearing, known.bearing_range[0]) << preset.soil.name;
    EXPECT_LE(preset.soil.slip_bearing, known.bearing_range[1]) << preset.soil.name;
    EXPECT_GE(preset.soil.slip_carry, known.carry_range[0]) << preset.soil.name;
    EXPECT_LE(preset.soil.slip_carry, known.carry_range[1]) << preset.soil.name;
    EXPECT_FALSE(known.bearing.empty() || known.carry.empty()) << preset.soil.name;
  }
  EXPECT_EQ(slip_evidence("viper, changed"), nullptr);
}

TEST(PassivePressureTest, AtThirtyDegreesIsTwelveHalvesOfTheWeight) {
  SoilParameters soil;
  soil.friction_deg = 30.0;
  EXPECT_TRUE(PassivePressure(soil).none());
  soil.density_kg_per_m3 = 1000.0;
  const PassivePressure passive(soil);
  EXPECT_FALSE(passive.none());
  EXPECT_NEAR(passive.resistance(0.1), 0.5 * 12.0 * 1000.0 * 9.80665 * 0.01, 1e-9);
  EXPECT_NEAR(passive.pressure(0.1), 12.0 * 1000.0 * 9.80665 * 0.1, 1e-9);
  soil.cohesion_pa = 100.0;
  EXPECT_NEAR(PassivePressure(soil).resistance(0.1) - passive.resistance(0.1),
              2.0 * std::sqrt(3.0) * 100.0 * 0.1, 1e-9);
}

}  // namespace

}  // namespace screed
