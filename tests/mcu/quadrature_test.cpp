// The quadrature decoder alone, for both wirings a board may have.
#include "hal/avr/quadrature.h"

#include <gtest/gtest.h>

namespace screed::avr {
namespace {

// A leads B: the track drives forward.
constexpr QuadratureLevels kForward[4] = {
    {false, false}, {true, false}, {true, true}, {false, true}};

TEST(Quadrature, CountsEveryStateChangeInBothDirections) {
  Quadrature decoder{};
  decoder.start(kForward[0]);
  for (int i = 1; i <= 10; ++i) decoder.update(kForward[i % 4]);
  EXPECT_EQ(decoder.count, 10);
  for (int i = 9; i >= -3; --i) decoder.update(kForward[(i + 4) % 4]);
  EXPECT_EQ(decoder.count, 0xFFFD) << "modulo 2^16";
  EXPECT_EQ(decoder.errors, 0);
}

TEST(Quadrature, IgnoresInterruptsWithoutChange) {
  Quadrature decoder{};
  for (const QuadratureLevels levels : kForward) {
    decoder.start(levels);
    decoder.update(levels);
  }
  EXPECT_EQ(decoder.count, 0);
  EXPECT_EQ(decoder.errors, 0);
}

TEST(Quadrature, CountsAMissedEdgeAsErrorAndNotAsTravel) {
  Quadrature decoder{};
  for (int i = 0; i < 4; ++i) {
    decoder.start(kForward[i]);
    decoder.update(kForward[(i + 2) % 4]);
  }
  EXPECT_EQ(decoder.count, 0);
  EXPECT_EQ(decoder.errors, 4);
}

TEST(Quadrature, DecodesXoredWiringTheSame) {
  for (const QuadratureLevels levels : kForward) {
    const QuadratureLevels decoded = levels_from_xor(levels.a != levels.b, levels.b);
    EXPECT_EQ(decoded.a, levels.a);
    EXPECT_EQ(decoded.b, levels.b);
  }
}

}  // namespace
}  // namespace screed::avr
