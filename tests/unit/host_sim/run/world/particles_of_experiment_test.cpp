// How many threads compute a bed of particles: what the environment says, no key of an experiment.
#include <gtest/gtest.h>

#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/unit/environment_variable.h"

namespace screed {
namespace {

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
