// The numeric primitives give the same bytes on the MCU and on the host.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host_sim/devices/mcu/mcu.h"
#include "tests/mcu/golden_vectors.h"
#include "tests/mcu/images.h"

namespace screed::mcu {
namespace {

struct HostLink {
  std::vector<std::uint8_t> bytes;
  void put(std::uint8_t byte) { bytes.push_back(byte); }
};

constexpr const char* kNames[kGoldenSections] = {"shifts",   "scale_q16", "sine",       "atan2",
                                                 "sqrt",     "units",     "kinematics", "control",
                                                 "position", "attitude",  "leveling",   "messages"};

TEST(GoldenVectors, McuAgreesWithHost) {
  HostLink host;
  std::vector<std::size_t> begin;
  for (std::uint8_t section = 0; section < kGoldenSections; ++section) {
    begin.push_back(host.bytes.size());
    golden_section(section, host);
  }

  Mcu mcu(kGoldenImage);
  mcu.run_until_sent(host.bytes.size() + 1, 60'000);
  EXPECT_FALSE(mcu.alive()) << "the image sent more bytes than the host";
  EXPECT_EQ(mcu.sent().size(), host.bytes.size());

  const auto difference =
      std::mismatch(host.bytes.begin(), host.bytes.end(), mcu.sent().begin(), mcu.sent().end());
  const auto at = static_cast<std::size_t>(difference.first - host.bytes.begin());
  if (at == host.bytes.size()) return;
  const auto section = static_cast<std::size_t>(std::upper_bound(begin.begin(), begin.end(), at) -
                                                begin.begin() - 1);
  ADD_FAILURE() << "first difference: " << kNames[section] << ", byte " << at - begin[section];
}

}  // namespace
}  // namespace screed::mcu
