// The network's layers give the same bits on the MCU as on the host, and cost what they may.
#include <gtest/gtest.h>

#include <vector>

#include "host_sim/devices/mcu/mcu.h"
#include "tests/mcu/images.h"
#include "tests/mcu/network_parameters.h"
#include "tests/mcu/network_vectors.h"

namespace screed::mcu {
namespace {

constexpr std::size_t kTanhBlocks = 256;

struct NetworkImage : ::testing::Test {
  Mcu mcu{kNetworkImage};
};

TEST_F(NetworkImage, TwentyThousandVectorsEveryArgumentOfTanhAndRecurrentLayersAgreeWithTheHost) {
  mcu.run_until_sent(4 * (kNetworkBlocks + kTanhBlocks + kGatedBlocks), 120'000);
  ASSERT_EQ(mcu.sent().size(), 4U * (kNetworkBlocks + kTanhBlocks + kGatedBlocks));
  const auto sent = [&](std::size_t block) {
    std::uint32_t hash = 0;
    for (std::size_t byte = 0; byte < 4; ++byte) {
      hash |= static_cast<std::uint32_t>(mcu.sent()[4 * block + byte]) << (8 * byte);
    }
    return hash;
  };
  for (std::uint16_t block = 0; block < kNetworkBlocks; ++block) {
    ASSERT_EQ(sent(block), network_vectors_hash(block + 1U, kVectorsPerBlock)) << "block " << block;
  }
  for (std::uint16_t block = 0; block < kTanhBlocks; ++block) {
    ASSERT_EQ(sent(std::size_t{kNetworkBlocks} + block),
              tanh_hash(static_cast<std::uint16_t>(block << 8)))
        << "tanh, block " << block;
  }
  for (std::uint16_t block = 0; block < kGatedBlocks; ++block) {
    ASSERT_EQ(sent(kNetworkBlocks + kTanhBlocks + block), gated_hash(block + 1U))
        << "recurrent layer, block " << block;
  }
}

TEST_F(NetworkImage, NetworksOfTheThesisStayWithinTheirCycles) {
  std::vector<std::uint64_t> edges;
  mcu.watch_pin({'D', 4}, [&](bool) { edges.push_back(mcu.cycle()); });
  mcu.run_until_sent(1, 100);
  ASSERT_EQ(edges.size(), 4U);
  const std::uint64_t small = edges[1] - edges[0];
  const std::uint64_t deep = edges[3] - edges[2];
  RecordProperty("cycles_4_20_1", static_cast<int>(small));
  RecordProperty("cycles_13_of_7", static_cast<int>(deep));
  EXPECT_LE(small, 5'100U);
  EXPECT_LE(deep, 26'500U);
}

TEST(ModelImage, GoldenVectorsOfAnExportedModelComeOut) {
  Mcu mcu(kModelImage);
  mcu.run_until_sent(5, 1'000);
  EXPECT_FALSE(mcu.alive());
  // Two networks: vectors, and how many were wrong.
  EXPECT_EQ(mcu.sent(), (std::vector<std::uint8_t>{12, 0, 12, 0}));
}

}  // namespace
}  // namespace screed::mcu
