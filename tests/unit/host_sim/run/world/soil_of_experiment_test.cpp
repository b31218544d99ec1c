// Soil keys of an experiment file on their way into the world.
#include <gtest/gtest.h>

#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

SoilParameters soil_of(const std::string& keys) {
  const TempFolder folder;
  write_text(folder.path() / "e.ini", "[map]\nmodel = scm\n[soil]\n" + keys);
  return make_soil(read_experiment(folder.path() / "e.ini"));
}

TEST(SoilOfAnExperiment, EachKeyChangesItsParameterAlone) {
  const SoilParameters clay = soil_preset("clay");
  for (const SoilParameterInfo& changed : kSoilParameters) {
    SCOPED_TRACE(changed.key);
    const double value = changed.max / 2.0;
    const SoilParameters soil = soil_of(std::string("preset = clay\n") + changed.key + " = " +
                                        std::to_string(value) + "\n");
    for (const SoilParameterInfo& parameter : kSoilParameters) {
      EXPECT_DOUBLE_EQ(soil.*parameter.member,
                       &parameter == &changed ? value : clay.*parameter.member)
          << parameter.key;
    }
  }
}

TEST(SoilOfAnExperiment, EveryNamedSoilIsAPreset) {
  for (const std::string& name : soil_preset_names())
    EXPECT_EQ(soil_of("preset = " + name + "\n").name, name);
  try {
    soil_of("preset = custard\n");
    FAIL();
  } catch (const InputError& error) {
    for (const std::string& name : soil_preset_names())
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace screed
