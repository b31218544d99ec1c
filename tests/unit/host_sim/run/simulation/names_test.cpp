// Names of states and faults as summaries, pictures and the viewer show them.
#include "host_sim/run/simulation/outcome.h"

#include <gtest/gtest.h>

#include "tools/schema/dbc.h"

namespace screed {
namespace {

TEST(Names, StatesAndFaultsAreCalledWhatTheSchemaCallsThem) {
  size_t states = 0;
  for (const schema::DbcMessage& message :
       schema::read_dbc("firmware/protocol/screed.dbc").messages) {
    for (const schema::DbcSignal& signal : message.signals) {
      for (const schema::ValueName& value : signal.values) {
        const std::string path = message.name + "." + signal.name;
        if (path == "HEARTBEAT.state") {
          EXPECT_EQ(state_name(static_cast<RobotState>(value.value)), value.name);
        } else if (path == "LEVELING.state") {
          EXPECT_EQ(leveling_state_name(static_cast<message::LevelingState>(value.value)),
                    value.name);
          EXPECT_LT(static_cast<size_t>(value.value), kLevelingStates);
          ++states;
        }
      }
    }
  }
  EXPECT_EQ(states, kLevelingStates);
}

TEST(Names, WhatHasNoNameIsUnknown) {
  EXPECT_STREQ(state_name(static_cast<RobotState>(7)), "unknown");
  EXPECT_STREQ(leveling_state_name(static_cast<message::LevelingState>(15)), "unknown");
}

TEST(Names, FaultsAreListedInTheirOrder) {
  EXPECT_EQ(fault_names(0), "none");
  EXPECT_EQ(fault_names(Fault::kStallRight), "stall_right");
  EXPECT_EQ(fault_names(Fault::kStuck | Fault::kTilt), "tilt, stuck");
}

}  // namespace
}  // namespace screed
