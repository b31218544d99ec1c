// What the seeded drives of the slip watch draw from.
#include "nn/slip/stuck_scenario.h"

#include <gtest/gtest.h>

#include <set>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/experiment/trap.h"

namespace screed::nn {
namespace {

TEST(StuckScenario, DrawsEverySoilAndEveryTrap) {
  std::set<std::string> grounds;
  std::set<std::string> traps;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const StuckScenario scenario = stuck_scenario(seed, true, 10.0);
    grounds.insert(scenario.ground);
    traps.insert(scenario.experiment.trap.kind);
    EXPECT_EQ(scenario.experiment.map.model, scenario.ground == "rigid" ? "rigid" : "scm");
    if (scenario.ground != "rigid") {
      EXPECT_EQ(scenario.experiment.soil.preset, scenario.ground);
    }
  }
  std::set<std::string> soils = {"rigid"};
  for (const std::string& name : soil_preset_names()) soils.insert(name);
  EXPECT_EQ(grounds, soils);
  const std::vector<std::string> kinds = trap_kinds();
  EXPECT_EQ(traps, std::set<std::string>(kinds.begin() + 1, kinds.end()));
}

}  // namespace
}  // namespace screed::nn
