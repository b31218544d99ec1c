// Heads of states: what is damaged or foreign is refused.
#include "host_sim/core/state_bytes.h"

#include <gtest/gtest.h>

#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr StateName kName = {"bed", 3};

std::string refusal(const std::string& state) {
  try {
    without_head(kName, state);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StateBytes, ComeBackAsTheyWere) {
  for (const std::string& bytes : {std::string(), std::string("a\0b", 3), std::string(1000, 'x')})
    EXPECT_EQ(without_head(kName, with_head(kName, bytes)), bytes);
}

TEST(StateBytes, AnyDamageIsRefused) {
  const std::string state = with_head(kName, "ground");
  for (size_t size = 0; size < state.size(); ++size) EXPECT_NE(refusal(state.substr(0, size)), "");
  for (size_t at = 0; at < state.size(); ++at) {
    std::string damaged = state;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    EXPECT_NE(refusal(damaged), "") << at;
  }
  EXPECT_EQ(refusal(state + "x"), "state of a bed: damaged, or of something else");
}

TEST(StateBytes, OtherVersionsAndOtherThingsAreRefused) {
  EXPECT_EQ(refusal(with_head({"bed", 2}, "ground")), "state of a bed of version 2; allowed: 3");
  EXPECT_EQ(refusal(with_head({"world", 3}, "ground")),
            "state of a bed: damaged, or of something else");
}

}  // namespace
}  // namespace screed
