// What a page shows of a run: curves, and the terrain over time.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include "host_sim/run/report/page_curves.h"
#include "host_sim/run/report/page_terrain.h"

namespace screed {

namespace {

// Curves of the page: all ticks of a short run, the extremes of a long one.

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(CurveSampler, KeepsEachTickOfAShortRun) {
  const CurveSampling sampling(CurveSampling::kMaxSamples);
  EXPECT_EQ(sampling.bucket_ticks, 1U);
  CurveSampler sampler(sampling);
  for (std::uint64_t i = 0; i < sampling.ticks; ++i) sampler.add(0.5 * static_cast<double>(i));
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), sampling.rows().size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(sampling.rows()[i], i);
    EXPECT_EQ(samples[i], 0.5F * static_cast<float>(i));
  }
}

TEST(CurveSampler, KeepsThePeaksOfALongRunInTheirOrder) {
  const CurveSampling sampling(10 * CurveSampling::kMaxSamples + 1);
  const std::uint64_t bucket = sampling.bucket_ticks;
  ASSERT_GT(bucket, 10U);
  CurveSampler sampler(sampling);
  for (std::uint64_t i = 0; i < sampling.ticks; ++i) {
    // One spike up, later one down in the first bucket; the other way round in the second.
    const double spike = i == 3 || i == bucket + 7 ? 5.0 : i == 8 || i == bucket + 2 ? -5.0 : 1.0;
    sampler.add(spike);
  }
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), sampling.rows().size());
  EXPECT_LE(samples.size(), CurveSampling::kMaxSamples);
  EXPECT_EQ(samples[0], 5.0F);
  EXPECT_EQ(samples[1], -5.0F);
  EXPECT_EQ(samples[2], -5.0F);
  EXPECT_EQ(samples[3], 5.0F);
  EXPECT_EQ(samples.back(), 1.0F);
  EXPECT_EQ(sampling.rows()[2], bucket);
  EXPECT_LT(sampling.rows().back(), sampling.ticks);
}

TEST(CurveSampler, PassesOverWhatIsNoNumber) {
  CurveSampler sampler(CurveSampling(2 * CurveSampling::kMaxSamples));  // buckets of four
  for (const double value : {kNan, 2.0, kNan, 1.0, kNan, kNan, kNan, kNan}) sampler.add(value);
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), 4U);
  EXPECT_EQ(samples[0], 2.0F);
  EXPECT_EQ(samples[1], 1.0F);
  EXPECT_TRUE(std::isnan(samples[2]));
  EXPECT_TRUE(std::isnan(samples[3]));
}

// The terrain over time as the page gets it: read back as the page reads it.

HeightMapGeometry grid_of(std::uint32_t nx, std::uint32_t ny) {
  return {nx, ny, kHeightUnit_m, 0.01, -1.0, -2.0, false, false};
}

Height height_of(double m) {
  return static_cast<Height>(std::lround(m / kHeightUnit_m));
}

HeightField field_with(int nx, int ny, double (*height_m)(int ix, int iy)) {
  HeightField field(nx, ny, 0.01, false);
  for (int iy = 0; iy < ny; ++iy) {
    for (int ix = 0; ix < nx; ++ix) field.set_node(ix, iy, height_of(height_m(ix, iy)));
  }
  return field;
}

double hills(int ix, int iy) {
  return 0.05 * std::sin(0.7 * ix) + 0.002 * iy;
}

/// What tools/report/src/data.js does.
class Reader {
 public:
  Reader(const HeightSteps& steps, std::size_t columns)
      : scale_(steps.scale()), bytes_(steps.packed_steps()) {
    const std::vector<std::uint8_t> start = steps.packed_start();
    for (std::size_t i = 0; i < start.size() / 2; ++i) {
      const unsigned left = i % columns == 0 ? 0U : units_[i - 1];
      units_.push_back((left + start[2 * i] + 256U * start[2 * i + 1]) & 0xFFFFU);
    }
  }
  void step() {
    const std::uint32_t count = next();
    std::size_t node = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      node += next();
      const std::uint32_t code = next();
      units_[node++] += code % 2 == 1 ? 0U - (code + 1) / 2 : code / 2;
    }
  }
  bool at_end() const { return at_ == bytes_.size(); }
  double height_m(std::size_t node) const { return scale_.low_m + scale_.unit_m * units_[node]; }

 private:
  std::uint32_t next() {
    std::uint32_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const std::uint8_t byte = bytes_.at(at_++);
      value |= (byte & 127U) << shift;
      if (byte < 128) return value;
    }
  }
  HeightScaleOfPage scale_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint32_t> units_;
  std::size_t at_ = 0;
};

void expect_like(const Reader& reader, const CoarseGrid& grid, const HeightField& field) {
  const std::vector<double> heights = grid.heights_m(field);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    ASSERT_NEAR(reader.height_m(i), heights[i], 0.51e-4) << "node " << i;
  }
}

TEST(CoarseGrid, KeepsASmallGridAsItIs) {
  const CoarseGrid grid(grid_of(30, 20));
  EXPECT_EQ(grid.merged, 1);
  ASSERT_EQ(grid.nodes(), 600U);
  EXPECT_DOUBLE_EQ(grid.x_m[29], -1.0 + 0.29);
  EXPECT_DOUBLE_EQ(grid.y_m[0], -2.0);
  const std::vector<double> heights = grid.heights_m(field_with(30, 20, hills));
  EXPECT_NEAR(heights[5 * 30 + 7], hills(7, 5), kHeightUnit_m);
}

TEST(CoarseGrid, TakesTheMeanOfSquaresAndOfWhatIsLeftAtTheEdge) {
  constexpr int kNodes = 2 * CoarseGrid::kMaxSide + 1;  // squares of three; the last has one left
  const CoarseGrid grid(grid_of(kNodes, 4));
  EXPECT_EQ(grid.merged, 3);
  ASSERT_EQ(grid.y_m.size(), 2U);
  EXPECT_LE(grid.x_m.size(), static_cast<std::size_t>(CoarseGrid::kMaxSide));
  EXPECT_DOUBLE_EQ(grid.x_m[0], -1.0 + 0.01);
  EXPECT_DOUBLE_EQ(grid.y_m[1], -2.0 + 0.03);
  const HeightField field =
      field_with(kNodes, 4, [](int ix, int iy) { return 0.01 * ix + 0.1 * iy; });
  const std::vector<double> heights = grid.heights_m(field);
  EXPECT_NEAR(heights[0], 0.01 + 0.1, 1e-6);
  EXPECT_NEAR(heights[grid.x_m.size()], 0.01 + 0.3, 1e-6);
}

TEST(HeightSteps, ComeBackStepByStep) {
  const CoarseGrid grid(grid_of(30, 20));
  HeightField field = field_with(30, 20, hills);
  HeightSteps steps(grid, field, -0.1, 0.2);
  std::vector<HeightField> moments;
  for (int moment = 0; moment < 5; ++moment) {
    // Both ways, neighbours, and nothing in one of the moments.
    if (moment != 2) {
      field.set_node(3 * moment, moment, height_of(0.2 - 0.05 * moment));
      field.set_node(3 * moment + 1, moment, height_of(-0.1));
      field.set_node(29, 19, height_of(0.01 * moment));
    }
    steps.add(field);
    moments.push_back(field);
  }
  Reader reader(steps, 30);
  expect_like(reader, grid, field_with(30, 20, hills));
  for (const HeightField& moment : moments) {
    reader.step();
    expect_like(reader, grid, moment);
  }
  EXPECT_TRUE(reader.at_end());
}

TEST(HeightSteps, JoinedMomentsEndWhereSingleOnesDo) {
  const CoarseGrid grid(grid_of(30, 20));
  HeightField field = field_with(30, 20, hills);
  HeightSteps steps(grid, field, -0.1, 0.2);
  for (int moment = 0; moment < 101; ++moment) {
    field.set_node(7 * moment % 30, moment % 20, height_of(0.001 * (moment % 13)));
    steps.add(field);
  }
  const std::size_t whole = steps.packed_steps().size();
  EXPECT_EQ(steps.fit(whole), 1U) << "small enough as it is";
  EXPECT_EQ(steps.steps(), 101U);
  EXPECT_EQ(steps.fit(150), 128U) << "up to the last one";
  EXPECT_EQ(steps.steps(), 1U);
  Reader reader(steps, 30);
  reader.step();
  expect_like(reader, grid, field);
}

TEST(HeightSteps, WidensItsUnitForADeepBed) {
  const CoarseGrid grid(grid_of(2, 2));
  const HeightSteps steps(grid, HeightField(2, 2, 0.01, false), 0.0, 13.107);
  EXPECT_DOUBLE_EQ(steps.scale().unit_m, 13.107 / 65535);
}

}  // namespace

}  // namespace screed
