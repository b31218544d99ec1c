// Parameters: their table, and their store.
#include <gtest/gtest.h>
#include <algorithm>
#include <set>
#include <string>

#include "firmware/parameters/algorithms_in_build.h"
#include "firmware/parameters/parameter_store.h"
#include "firmware/parameters/parameters.h"
#include "firmware/robot/supervisor.h"

namespace screed {

namespace {

// The parameter table: defaults, ranges, and the two faces of it.

TEST(Parameters, DefaultsAreValidAndThoseOfTheTable) {
  const Parameters parameters;
  EXPECT_TRUE(parameters.valid());
  for (const ParameterInfo& info : kParameterTable)
    EXPECT_EQ(parameters.values[info.number], info.default_value) << info.name;
}

TEST(Parameters, EachIsCheckedAtBothEnds) {
  for (const ParameterInfo& info : kParameterTable) {
    Parameters parameters;
    // Pairs that must be ordered get room.
    parameters.walk_speed_min() = 0;
    parameters.walk_speed_max() = 250;
    parameters.walk_leg_min() = 100;
    parameters.walk_leg_max() = 20000;
    const std::string name = info.name;
    for (const int end : {info.min, info.max}) {
      if (name == "walk_speed_max") parameters.walk_speed_min() = 0;
      parameters.values[info.number] = static_cast<int16_t>(end);
      EXPECT_TRUE(parameters.valid()) << name << " = " << end;
    }
    if (info.max < INT16_MAX) {
      parameters.values[info.number] = static_cast<int16_t>(info.max + 1);
      EXPECT_FALSE(parameters.valid()) << name;
    }
    parameters.values[info.number] = static_cast<int16_t>(info.min - 1);
    EXPECT_FALSE(parameters.valid()) << name;
  }
}

TEST(Parameters, EveryAlgorithmOfTheBuildIsAllowedAndNoOther) {
  for (int number = -1; number <= 16; ++number) {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(number);
    const bool there_is = number >= 0 && number <= message::kLevelingAlgorithmMax &&
                          algorithm_in_build(static_cast<int16_t>(number));
    EXPECT_EQ(parameters.valid(), there_is) << number;
  }
}

TEST(Parameters, OrderedPairs) {
  Parameters speeds;
  speeds.walk_speed_min() = static_cast<int16_t>(speeds.walk_speed_max() + 1);
  EXPECT_FALSE(speeds.valid());
  speeds.walk_speed_min() = speeds.walk_speed_max();
  EXPECT_TRUE(speeds.valid()) << "legs of one speed";
  Parameters legs;
  legs.walk_leg_min() = static_cast<int16_t>(legs.walk_leg_max() + 1);
  EXPECT_FALSE(legs.valid());
  legs.walk_leg_min() = legs.walk_leg_max();
  EXPECT_TRUE(legs.valid()) << "legs of one length";
}

TEST(Parameters, TheTableNamesEachOnceInTheirOrder) {
  std::set<std::string> names;
  uint8_t number = 0;
  for (const ParameterInfo& info : kParameterTable) {
    names.insert(info.name);
    EXPECT_EQ(info.number, number++);
    EXPECT_LT(info.min, info.max);
    EXPECT_NE(std::string(info.meaning), "");
  }
  EXPECT_EQ(names.size(), std::size(kParameterTable));
  EXPECT_EQ(number, Parameters::kCount);
}

TEST(Parameters, AsUnsafeOnesAreOffByDefault) {
  const Parameters parameters;
  EXPECT_EQ(parameters.standalone(), 0);
  EXPECT_GT(parameters.battery_low(), 0);
}

// The parameters as bytes of an EEPROM: round trip, every single wrong bit, torn writes, choice
// between the copies.

Parameters unusual() {
  Parameters parameters;
  parameters.climb_speed() = 123;
  parameters.tilt_limit() = 4321;
  parameters.standalone_delay() = 30000;
  return parameters;
}

ParameterCopy encoded(const Parameters& parameters, std::uint16_t sequence) {
  ParameterCopy copy{};
  encode_parameters(parameters, sequence, copy);
  return copy;
}

ParameterCopy blank() {
  ParameterCopy copy{};
  std::fill(std::begin(copy.bytes), std::end(copy.bytes), std::uint8_t{0xFF});
  return copy;
}

StoreChoice choice(const ParameterCopy& copy0, const ParameterCopy& copy1) {
  return choose_copy(check_copy(copy0), copy_sequence(copy0), check_copy(copy1),
                     copy_sequence(copy1));
}

TEST(ParameterStore, ReadsWhatItWrote) {
  const ParameterCopy copy = encoded(unusual(), 0xBEEF);
  ASSERT_EQ(check_copy(copy), CopyState::kGood);
  EXPECT_EQ(copy_sequence(copy), 0xBEEF);
  Parameters read;
  decode_parameters(copy, read);
  for (const ParameterInfo& info : kParameterTable) {
    EXPECT_EQ(read.values[info.number], unusual().values[info.number]) << info.name;
  }
}

TEST(ParameterStore, LiesInTheEepromAsDocumented) {
  const ParameterCopy copy = encoded(unusual(), 0x1234);
  EXPECT_EQ(copy.bytes[0] | copy.bytes[1] << 8, kParameterLayout);
  EXPECT_EQ(copy.bytes[2], 0x34);
  EXPECT_EQ(copy.bytes[3], 0x12);
  std::size_t at = kParameterHeaderSize;
  for (const ParameterInfo& info : kParameterTable) {
    const auto bits = static_cast<std::uint16_t>(unusual().values[info.number]);
    EXPECT_EQ(copy.bytes[at], bits & 0xFF) << info.name;
    EXPECT_EQ(copy.bytes[at + 1], bits >> 8) << info.name;
    at += 2;
  }
  EXPECT_EQ(at + 2, sizeof(copy.bytes));
  EXPECT_LE(parameter_copy_address(0) + kParameterCopySize, parameter_copy_address(1));
  EXPECT_LE(parameter_copy_address(1) + kParameterCopySize, 1024) << "the EEPROM's size";
}

/// CRC-16/CCITT-FALSE by definition: the remainder of the message polynomial, bit by bit.
std::uint16_t crc_by_definition(const std::uint8_t* bytes, std::size_t size) {
  std::uint32_t rest = 0xFFFF;
  for (std::size_t bit = 0; bit < size * 8; ++bit) {
    const bool one = (bytes[bit / 8] >> (7 - bit % 8) & 1) != 0;
    const bool top = (rest & 0x8000) != 0;
    rest = rest << 1 & 0xFFFF;
    if (one != top) rest ^= 0x1021;
  }
  return static_cast<std::uint16_t>(rest);
}

TEST(ParameterStore, CarriesTheCrcOfItsCatalogueEntry) {
  const std::string check = "123456789";  // the catalogue's check value: 0x29B1
  ASSERT_EQ(crc_by_definition(reinterpret_cast<const std::uint8_t*>(check.data()), check.size()),
            0x29B1);
  const ParameterCopy copy = encoded(unusual(), 7);
  const std::size_t size = sizeof(copy.bytes) - 2;
  EXPECT_EQ(copy.bytes[size] | copy.bytes[size + 1] << 8, crc_by_definition(copy.bytes, size));
}

TEST(ParameterStore, SeesEverySingleWrongBit) {
  const ParameterCopy good = encoded(unusual(), 41);
  for (std::size_t bit = 0; bit < 8 * sizeof(good.bytes); ++bit) {
    ParameterCopy copy = good;
    copy.bytes[bit / 8] = static_cast<std::uint8_t>(copy.bytes[bit / 8] ^ 1 << bit % 8);
    EXPECT_EQ(check_copy(copy), CopyState::kBad) << "bit " << bit;
  }
}

TEST(ParameterStore, SeesEveryTwoWrongBits) {
  const ParameterCopy good = encoded(unusual(), 41);
  constexpr std::size_t kBits = 8 * sizeof(good.bytes);
  for (std::size_t first = 0; first < kBits; ++first) {
    for (std::size_t second = first + 1; second < kBits; ++second) {
      ParameterCopy copy = good;
      copy.bytes[first / 8] = static_cast<std::uint8_t>(copy.bytes[first / 8] ^ 1 << first % 8);
      copy.bytes[second / 8] = static_cast<std::uint8_t>(copy.bytes[second / 8] ^ 1 << second % 8);
      ASSERT_EQ(check_copy(copy), CopyState::kBad) << "bits " << first << ", " << second;
    }
  }
}

TEST(ParameterStore, ATornWriteLeavesTheOtherCopy) {
  // Copy 1 held old numbers and is being replaced; power fails after each byte. An erased byte of
  // the EEPROM that did not get its number yet is 0xFF.
  const ParameterCopy kept = encoded(Parameters(), 10);
  const ParameterCopy old = encoded(unusual(), 9);
  Parameters changed = unusual();
  changed.site_radius() = 2000;
  const ParameterCopy next = encoded(changed, 11);
  for (std::size_t written = 0; written < sizeof(next.bytes); ++written) {
    for (const bool erased : {false, true}) {
      ParameterCopy torn = old;
      std::copy_n(next.bytes, written, torn.bytes);
      if (erased) torn.bytes[written] = 0xFF;
      const StoreChoice found = choice(kept, torn);
      ASSERT_EQ(found.state, StoreState::kStored) << written;
      const bool same_as_old = std::equal(std::begin(torn.bytes), std::end(torn.bytes), old.bytes);
      EXPECT_EQ(found.copy, 0) << written << (same_as_old ? " old" : " torn");
    }
  }
  EXPECT_EQ(choice(kept, next).copy, 1);
}

TEST(ParameterStore, TheNewerCopyCountsAlsoAcrossTheWrap) {
  const struct {
    std::uint16_t sequence0;
    std::uint16_t sequence1;
    std::uint8_t newer;
    std::uint16_t next;
  } cases[] = {{5, 6, 1, 7}, {6, 5, 0, 7}, {0xFFFF, 0, 1, 1}, {0, 0xFFFF, 0, 1}};
  for (const auto& it : cases) {
    const StoreChoice found =
        choice(encoded(unusual(), it.sequence0), encoded(Parameters(), it.sequence1));
    EXPECT_EQ(found.state, StoreState::kStored);
    EXPECT_EQ(found.copy, it.newer);
    EXPECT_EQ(found.next_copy, 1 - it.newer) << "the good one would be overwritten";
    EXPECT_EQ(found.next_sequence, it.next);
  }
}

TEST(ParameterStore, OneGoodCopyIsEnough) {
  ParameterCopy bad = encoded(unusual(), 100);
  bad.bytes[7] ^= 0x10;
  for (const ParameterCopy& other : {bad, blank()}) {
    EXPECT_EQ(choice(encoded(unusual(), 3), other).copy, 0);
    EXPECT_EQ(choice(encoded(unusual(), 3), other).next_copy, 1);
    EXPECT_EQ(choice(other, encoded(unusual(), 3)).copy, 1);
    EXPECT_EQ(choice(other, encoded(unusual(), 3)).next_copy, 0);
    EXPECT_EQ(choice(other, encoded(unusual(), 3)).next_sequence, 4);
  }
}

TEST(ParameterStore, WithoutAGoodCopyItSaysWhether) {
  ParameterCopy bad = encoded(unusual(), 100);
  bad.bytes[0] ^= 1;
  EXPECT_EQ(choice(blank(), blank()).state, StoreState::kBlank);
  EXPECT_EQ(choice(bad, blank()).state, StoreState::kCorrupt);
  EXPECT_EQ(choice(blank(), bad).state, StoreState::kCorrupt);
  EXPECT_EQ(choice(bad, bad).state, StoreState::kCorrupt);
  const ParameterCopy zeros{};
  EXPECT_EQ(choice(zeros, zeros).state, StoreState::kCorrupt);
}

TEST(ParameterStore, ARobotWhoseParametersAreLostCannotBeArmed) {
  for (const bool intact : {true, false}) {
    Supervisor supervisor(intact);
    const std::int16_t gyro[3] = {1, 2, 3};
    const std::int16_t accel[3] = {0, 0, 4096};
    SupervisorInput input{};
    input.fresh = kFreshGyro | kFreshAccel;
    input.gyro = gyro;
    input.accel = accel;
    input.cos_tilt_q14 = 16384;
    input.estimator_ready = true;
    input.attitude_known = true;
    input.battery_mv = 7200;
    supervisor.heartbeat();
    supervisor.tick(Parameters(), input);
    EXPECT_EQ(supervisor.request(Request::kArm),
              intact ? RequestResult::kDone : RequestResult::kFaultPresent);
  }
}

}  // namespace

}  // namespace screed
