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

// What a bed costs, said of a really large one only.

Experiment bed_of(const char* model, double size_m) {
  Experiment experiment;
  experiment.map.model = model;
  experiment.map.size_m = size_m;
  return experiment;
}

TEST(LargeBed, OfManyCellsSaysItsCost) {
  Experiment bed = bed_of("scm", 40.0);  // 8000 x 8000 of 5 mm
  EXPECT_EQ(large_bed_note(bed),
            "a large bed, 8000 x 8000 = 64 million cells: about 4.2 GB of memory, 45 s to lay and "
            "measure it, 0.26 s for a simulated second");
  bed.soil.cell_m = 0.02;
  EXPECT_EQ(large_bed_note(bed), std::nullopt);
  bed.soil.cell_m = 0.005;
  EXPECT_EQ(large_bed_note(bed, 0.02), std::nullopt) << "the stand-in has wider cells";
}

TEST(LargeBed, OfManyParticlesSaysItsCost) {
  // 400 x 400 stacks of 4: 640000.
  EXPECT_EQ(large_bed_note(bed_of("particles", 10.0)),
            "a large bed, at least 0.6 million particles: about 0.6 GB of memory, 2 min to lay "
            "them; a simulated second takes as long as particles move in it");
  EXPECT_EQ(large_bed_note(bed_of("particles", 3.0)), std::nullopt);
}

TEST(LargeBed, OfUsualSizeSaysNothing) {
  EXPECT_EQ(large_bed_note(bed_of("scm", 6.0)), std::nullopt);
  EXPECT_EQ(large_bed_note(bed_of("rigid", 1000.0)), std::nullopt);
  EXPECT_EQ(large_bed_note(bed_of("scm", 100.0)), std::nullopt) << "which is refused: too many";
}

}  // namespace

}  // namespace screed
