// From an experiment to a world: soil, and threads of particles.
#include <gtest/gtest.h>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/temp_folder.h"
#include "tests/unit/environment_variable.h"

namespace screed {

namespace {

// Soil keys of an experiment file on their way into the world.

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

// How many threads compute a bed of particles: what the environment says, no key of an experiment.

int threads_for(const char* variable) {
  const EnvironmentVariable threads("SCREED_THREADS", variable);
  Experiment experiment;
  experiment.map.model = "particles";
  return make_particles(experiment).threads;
}

TEST(ParticlesOfAnExperiment, HaveTheThreadsOfTheEnvironment) {
  EXPECT_EQ(threads_for(nullptr), 1);
  EXPECT_EQ(threads_for("1"), 1);
  EXPECT_EQ(threads_for("2"), 2);
  EXPECT_EQ(threads_for("64"), 64);
}

TEST(ParticlesOfAnExperiment, RefuseWhatIsNoNumberOfThreads) {
  for (const std::string wrong : {"", "0", "-1", "65", "two", "2 ", "1.5", "99999999999"}) {
    try {
      threads_for(wrong.c_str());
      FAIL() << wrong;
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), "SCREED_THREADS = \"" + wrong + "\"; allowed: 1 to 64");
    }
  }
}

}  // namespace

}  // namespace screed
