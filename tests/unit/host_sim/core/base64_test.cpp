// The test vectors of RFC 4648, section 10.
#include "host_sim/core/base64.h"

#include <gtest/gtest.h>

#include <string_view>
#include <utility>
#include <vector>

namespace screed {
namespace {

TEST(Base64, EncodesAsTheStandardSays) {
  constexpr std::pair<std::string_view, std::string_view> kVectors[] = {{"", ""},
                                                                        {"f", "Zg=="},
                                                                        {"fo", "Zm8="},
                                                                        {"foo", "Zm9v"},
                                                                        {"foob", "Zm9vYg=="},
                                                                        {"fooba", "Zm9vYmE="},
                                                                        {"foobar", "Zm9vYmFy"}};
  for (const auto& [text, encoded] : kVectors) {
    EXPECT_EQ(base64(std::vector<std::uint8_t>(text.begin(), text.end())), encoded);
  }
}

TEST(Base64, UsesTheWholeAlphabet) {
  EXPECT_EQ(base64(std::vector<std::uint8_t>{0xFB, 0xEF, 0xFF}), "++//");
}

}  // namespace
}  // namespace screed
