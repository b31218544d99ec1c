// `screed key`: what is said to the robot's console, and what is not.
#include "tools/screed/link/key_command.h"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

/// A console that answers as it is told, and keeps what it heard.
struct Console {
  std::map<char, std::vector<std::string>> answers;
  std::vector<std::string> heard;

  std::string operator()(const std::string& line) {
    heard.push_back(line);
    if (line.empty()) return "";
    std::vector<std::string>& left = answers[line[0]];
    if (left.empty()) return "";
    std::string answer = left.front();
    if (left.size() > 1) left.erase(left.begin());
    return answer;
  }
};

CommandKey some_key() {
  CommandKey key = test_key();
  key.robot_id = 171;
  return key;
}

TEST(GiveKey, GoesToARobotsConsoleAndRestartsIt) {
  Console console{{{'v', {"screed v1 a_star_32u4 0 0 900 0 0"}}, {'k', {"ok"}}, {'r', {"?", ""}}},
                  {}};
  EXPECT_TRUE(provision_key(std::ref(console), "port", some_key));
  const std::vector<std::string> expected = {"",  "C", "v", "k000102030405060708090A0B0C0D0E0FAB",
                                             "r", "r"};
  EXPECT_EQ(console.heard, expected);
}

TEST(GiveKey, IsNotSentToWhatIsNoConsole) {
  for (const char* answer : {"", "?", "t0108AC0100000000000"}) {
    Console console{{{'v', {answer}}, {'k', {"ok"}}}, {}};
    const auto not_asked = []() -> CommandKey { throw std::logic_error("a key is made"); };
    EXPECT_THROW(provision_key(std::ref(console), "port", not_asked), RunError);
    EXPECT_EQ(console.heard.size(), 3U) << "no key after " << answer;
  }
}

TEST(GiveKey, SaysWhenTheRobotRefusesOrCannotRestart) {
  Console refusing{{{'v', {"screed v1"}}, {'k', {"?"}}}, {}};
  EXPECT_THROW(provision_key(std::ref(refusing), "port", some_key), RunError);
  Console driving{{{'v', {"screed v1"}}, {'k', {"ok"}}, {'r', {"?"}}}, {}};
  EXPECT_FALSE(provision_key(std::ref(driving), "port", some_key));
}

TEST(GiveKey, APortThatIsNoneIsWrongInput) {
  EXPECT_THROW(provision_key("/dev/no-such-port", some_key), InputError);
  EXPECT_THROW(provision_key("/dev/null", some_key), InputError);
}

TEST(RandomKey, IsAnotherEveryTime) {
  const CommandKey key = random_key(9);
  EXPECT_EQ(key.robot_id, 9);
  EXPECT_NE(key.bytes, random_key(9).bytes);
}

}  // namespace
}  // namespace screed
