// Two recorded runs side by side: equal, or where and how far they part.
#include "host_sim/run/comparison/session_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/comparison/comparison_picture.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

/// Of the heights below: 1/1024 m.
constexpr int kUnits = 1 << 14;
constexpr double kMm = 1.0 / 1024.0;

/// A straight drive east at 0.1 m/s on a bed of 4 x 3 heights of 0.25 m.
Recording straight(std::size_t ticks) {
  Recording run;
  run.info.program_version = "1.2.3";
  run.info.experiment_name = "straight";
  run.info.experiment_text = "[map]\nmodel = scm\n[experiment]\nname = straight\nseed = 7\n";
  run.info.seed = 7;
  run.info.board_name = "a_star_32u4";
  for (std::size_t i = 0; i < ticks; ++i) {
    SimFrame frame;
    frame.time = 0.01 * static_cast<double>(i + 1);
    frame.x = 0.001 * static_cast<double>(i);
    frame.delta_x = i == 0 ? 0.0 : 0.001;
    frame.battery = 9.0;
    frame.energy = static_cast<double>(i);
    frame.state = 2;
    frame.leveling_state = 1;
    run.frames.push_back(frame);
    run.samples.emplace_back();
    run.outputs.emplace_back();
  }
  run.before.geometry = {4, 3, kHeightUnit_m, 0.25, -0.375, -0.25, false};
  run.before.heights.assign(12, 100 * kUnits);
  run.after = run.before;
  run.after.heights[5] = 90 * kUnits;   // about 10 mm lower
  run.after.heights[6] = 104 * kUnits;  // and 4 mm higher
  return run;
}

class Comparison : public ::testing::Test {
 protected:
  SessionComparison compare(const Recording& a, const Recording& b) {
    write_run(folder_.path() / "a.h5", a);
    write_run(folder_.path() / "b.h5", b);
    SessionComparison result = compare_sessions(SessionReader(folder_.path() / "a.h5"),
                                                SessionReader(folder_.path() / "b.h5"));
    std::filesystem::remove(folder_.path() / "a.h5");
    std::filesystem::remove(folder_.path() / "b.h5");
    return result;
  }

  TempFolder folder_;
};

TEST_F(Comparison, ARunIsIdenticalToItself) {
  Recording other = straight(250);
  other.info.program_version = "1.3.0";
  const SessionComparison result = compare(straight(250), other);
  EXPECT_TRUE(result.identical());
  EXPECT_TRUE(result.configuration.empty());
  EXPECT_FALSE(result.first.has_value());
  EXPECT_EQ(result.common_ticks, 250U);
  ASSERT_TRUE(result.summary.has_value());
  EXPECT_EQ(result.summary->largest_position.position_m, 0.0);
  EXPECT_EQ(result.terrain.rms_m, 0.0);
  const FinalState& end = result.runs[0].end;
  EXPECT_DOUBLE_EQ(end.time_s, 2.5);
  EXPECT_NEAR(end.distance_m, 0.249, 1e-12);
  EXPECT_EQ(end.state, "running");
  EXPECT_EQ(end.leveling_state, "walk");
  EXPECT_EQ(end.faults, "none");
  EXPECT_DOUBLE_EQ(end.energy_j, 249.0);
  ASSERT_TRUE(end.change.has_value());
  EXPECT_NEAR(end.change->cut_m3, 10.0 * kMm * 0.0625, 1e-12);
  EXPECT_NEAR(end.change->fill_m3, 4.0 * kMm * 0.0625, 1e-12);
  // Ten a second, and the last.
  EXPECT_EQ(result.runs[0].trace.size(), 26U);
  EXPECT_EQ(result.deviation.size(), 26U);
}

TEST_F(Comparison, TheFirstDifferenceIsTheFirstTickAndItsCause) {
  Recording other = straight(2000);
  other.samples[1300].imu.gyro()[2] = 5;
  other.outputs[1300].duty_left = -3;
  other.frames[1300].velocity_x = 0.25;
  other.frames[1400].y = 0.5;
  const SessionComparison result = compare(straight(2000), other);
  EXPECT_FALSE(result.identical());
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->tick, 1300U);
  EXPECT_DOUBLE_EQ(result.first->time_s, 13.0);
  EXPECT_EQ(result.first->column, "samples.gyro[2]");
  EXPECT_EQ(result.first->a, "0");
  EXPECT_EQ(result.first->b, "5");
  EXPECT_EQ(
      result.first->all_columns,
      (std::vector<std::string>{"samples.gyro[2]", "outputs.duty_left", "frames.velocity_x"}));
}

TEST_F(Comparison, FindsADifferenceInAnyTableAtAnyTick) {
  for (const std::size_t tick :
       {std::size_t{0}, std::size_t{1023}, std::size_t{1024}, std::size_t{1199}}) {
    const std::function<void(Recording&)> changes[] = {
        [tick](Recording& run) { run.samples[tick].radio_errors ^= 1; },
        [tick](Recording& run) { run.outputs[tick].leds ^= 1; },
        [tick](Recording& run) { run.frames[tick].faults = 1; },
        [tick](Recording& run) { run.frames[tick].x = std::nextafter(run.frames[tick].x, 9.0); }};
    for (const auto& change : changes) {
      Recording other = straight(1200);
      change(other);
      const SessionComparison result = compare(straight(1200), other);
      ASSERT_TRUE(result.first.has_value());
      EXPECT_EQ(result.first->tick, tick);
      EXPECT_EQ(result.first->all_columns.size(), 1U);
    }
  }
}

TEST_F(Comparison, AShorterRunIsEqualAsFarAsItGoes) {
  const SessionComparison result = compare(straight(500), straight(200));
  EXPECT_FALSE(result.identical());
  EXPECT_FALSE(result.first.has_value());
  EXPECT_EQ(result.common_ticks, 200U);
  EXPECT_DOUBLE_EQ(result.summary->last.time_s, 2.0);
  EXPECT_EQ(result.runs[0].frames, 500U);
  EXPECT_EQ(result.runs[1].frames, 200U);
}

TEST_F(Comparison, ConfigurationIsComparedKeyByKey) {
  Recording other = straight(10);
  other.info.experiment_text =
      "[map]\nmodel = scm\n[experiment]\nname = straight\nseed = 8\n[soil]\npreset = clay\n";
  other.info.board_name = "mega";
  const SessionComparison result = compare(straight(10), other);
  EXPECT_FALSE(result.identical()) << "though no tick differs";
  EXPECT_FALSE(result.first.has_value());
  ASSERT_EQ(result.configuration.size(), 3U);
  EXPECT_EQ(result.configuration[0].key, "board");
  EXPECT_EQ(result.configuration[1].key, "experiment.seed");
  EXPECT_EQ(result.configuration[1].a, "7");
  EXPECT_EQ(result.configuration[1].b, "8");
  EXPECT_EQ(result.configuration[2].key, "soil.preset");
  EXPECT_EQ(result.configuration[2].a, std::nullopt);
  EXPECT_EQ(result.configuration[2].b, "clay");
}

TEST(Configuration, ACommandKeyIsNotShown) {
  const auto keys = configuration_difference("[radio]\nkey = 0123\n", "[radio]\nkey = 4567\n");
  ASSERT_EQ(keys.size(), 1U);
  EXPECT_EQ(keys[0].key, "radio.key");
  EXPECT_EQ(keys[0].a->find("0123"), std::string::npos);
  EXPECT_EQ(keys[0].b->find("4567"), std::string::npos);
}

TEST_F(Comparison, DeviationIsThatOfTheSameTick) {
  Recording other = straight(300);
  for (std::size_t i = 100; i < 300; ++i) {
    other.frames[i].y = i < 200 ? 0.3 : 0.1;
    other.frames[i].yaw = -3.0;
  }
  Recording first = straight(300);
  for (SimFrame& frame : first.frames) frame.yaw = 3.0;
  const DeviationSummary summary = *compare(first, other).summary;
  EXPECT_NEAR(summary.largest_position.position_m, 0.3, 1e-12);
  EXPECT_NEAR(summary.largest_position.time_s, 1.01, 1e-12);
  EXPECT_NEAR(summary.last.position_m, 0.1, 1e-12);
  // From 3 to -3 rad it is shorter on the other side, and counter-clockwise.
  EXPECT_NEAR(summary.last.heading_rad, 2.0 * std::numbers::pi - 6.0, 1e-12);
  EXPECT_NEAR(summary.largest_heading.heading_rad, -3.0, 1e-12);
}

TEST_F(Comparison, OnAWrappedBedPlacesAreThoseTravelled) {
  Recording other = straight(100);
  Recording first = straight(100);
  first.before.geometry.wrap = first.after.geometry.wrap = true;
  other.before.geometry.wrap = other.after.geometry.wrap = true;
  // 4 heights of 0.25 m: the bed is 1 m wide. 20 mm apart, on both sides of its edge.
  first.frames[99].x = 0.49;
  other.frames[99].x = -0.49;
  other.frames[99].beds_x = 1;
  EXPECT_NEAR(compare(first, other).summary->last.position_m, 0.02, 1e-12);
}

TEST_F(Comparison, TerrainsAreComparedWhereTheGridsMatch) {
  Recording other = straight(10);
  other.after.heights[5] = 92 * kUnits;
  other.after.heights[0] = 97 * kUnits;
  const SessionComparison result = compare(straight(10), other);
  const TerrainDifference& terrain = result.terrain;
  EXPECT_EQ(terrain.not_comparable, "");
  EXPECT_FALSE(result.same_terrain);
  EXPECT_FALSE(result.identical());
  EXPECT_NEAR(terrain.change.deepest_fill_m, 2.0 * kMm, 1e-12);
  EXPECT_NEAR(terrain.change.deepest_cut_m, 3.0 * kMm, 1e-12);
  EXPECT_NEAR(terrain.rms_m, kMm * std::sqrt((4.0 + 9.0) / 12.0), 1e-12);
  EXPECT_NEAR(terrain.change.fill_m3, 2.0 * kMm * 0.0625, 1e-12);
  EXPECT_NEAR(terrain.change.cut_m3, 3.0 * kMm * 0.0625, 1e-12);
  ASSERT_EQ(terrain.height_m.size(), 12U);
  EXPECT_NEAR(terrain.height_m[5], 2.0 * kMm, 1e-12);
}

TEST_F(Comparison, OnParticlesSingleStonesDoNotCount) {
  const auto deepest_m = [this](const std::string& radius) {
    Recording run = straight(10);
    run.info.experiment_text = "[map]\nmodel = particles\nparticle_radius = " + radius + "\n";
    return compare(run, run).runs[0].end.change->deepest_cut_m;
  };
  // A low-pass with the radius of the run's particles: heights lie 0.25 m apart.
  EXPECT_NEAR(deepest_m("0.001"), 10.0 * kMm, 1e-6);
  EXPECT_LT(deepest_m("0.2"), 7.0 * kMm);
  EXPECT_LT(deepest_m("0.4"), deepest_m("0.2"));
}

TEST_F(Comparison, OtherGridsAreNotCompared) {
  Recording other = straight(10);
  other.before.geometry.spacing_m = other.after.geometry.spacing_m = 0.5;
  const SessionComparison result = compare(straight(10), other);
  EXPECT_NE(result.terrain.not_comparable.find("0.25"), std::string::npos);
  EXPECT_NE(result.terrain.not_comparable.find("0.5"), std::string::npos);
  EXPECT_FALSE(result.identical());
  EXPECT_TRUE(result.terrain.height_m.empty());
  const std::string svg = comparison_svg(result, {"out/a", "out/b"});
  EXPECT_NE(svg.find("not compared"), std::string::npos);
}

TEST_F(Comparison, RefusesAnotherTickRate) {
  Recording other = straight(10);
  other.info.tick_rate_hz = 50;
  EXPECT_THROW(compare(straight(10), other), InputError);
}

TEST_F(Comparison, ThePictureSaysWhatIsCompared) {
  Recording other = straight(500);
  other.info.experiment_text += "duration = 5\n";
  for (std::size_t i = 200; i < 500; ++i) {
    other.frames[i].y = 0.001 * static_cast<double>(i - 199);
    other.frames[i].leveling_state = 3;
  }
  other.after.heights[5] = 92 * kUnits;
  const SessionComparison result = compare(straight(500), other);
  const std::string svg = comparison_svg(result, {"out/a", "out/b"});
  for (const char* words : {"first difference in tick 200 (2.00 s): frames.y", ">A: out/a<",
                            ">B: out/b<", ">position apart [mm]<", ">heading, B from A [deg]<",
                            ">spin<", ">walk<", ">B higher than A [mm]<", ">states of A<",
                            ">states of B<", ">experiment.duration<", ">not set<"}) {
    EXPECT_NE(svg.find(words), std::string::npos) << words;
  }
  EXPECT_EQ(comparison_svg(result, {"out/a", "out/b"}), svg);
  const std::string same =
      comparison_svg(compare(straight(500), straight(500)), {"out/a", "out/a"});
  EXPECT_NE(same.find(">identical<"), std::string::npos);
  EXPECT_THROW(comparison_svg(compare(straight(0), straight(0)), {"a", "b"}), InputError);
}

/// The points of all dashed and all whole lines.
std::size_t lines_in(const std::string& svg, const std::string& color, bool dashed) {
  std::size_t count = 0;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    const std::string head = svg.substr(at, svg.find(" points=", at) - at);
    if (head.find(color) == std::string::npos) continue;
    count += (head.find("dasharray") != std::string::npos) == dashed ? 1 : 0;
  }
  return count;
}

TEST_F(Comparison, TheLinesOfIdenticalRunsAllShow) {
  const std::string svg = comparison_svg(compare(straight(500), straight(500)), {"a", "a"});
  // B, dashed over A: on the map and as its battery.
  EXPECT_EQ(lines_in(svg, "#8f0d33", false), 2U);
  EXPECT_EQ(lines_in(svg, "#0d949e", true), 2U);
  EXPECT_EQ(lines_in(svg, "#0d949e", false), 0U);
  // Position and heading apart, in the ink of neither.
  EXPECT_EQ(lines_in(svg, "#22262b", false), 2U);
}

TEST_F(Comparison, TheHeadingApartBreaksWhereItWraps) {
  Recording other = straight(500);
  for (std::size_t i = 0; i < 500; ++i) {
    other.frames[i].yaw = std::remainder(0.02 * static_cast<double>(i), 2.0 * std::numbers::pi);
  }
  const std::string svg = comparison_svg(compare(straight(500), other), {"a", "b"});
  EXPECT_EQ(lines_in(svg, "#22262b", false), 4U) << "10 rad: past half a turn at 3.1 and 9.4";
}

TEST_F(Comparison, ThePathBreaksWhereTheRobotLeavesTheBed) {
  Recording wrapped = straight(100);
  wrapped.before.geometry.wrap = wrapped.after.geometry.wrap = true;
  // Ten times a second a point; a fast robot goes on by 0.3 m, and over the edge at 0.5 s.
  for (std::size_t i = 0; i < 100; ++i) {
    wrapped.frames[i].x = -0.5 + std::fmod(0.03 * static_cast<double>(i), 1.0);
    wrapped.frames[i].beds_x = static_cast<int>(0.03 * static_cast<double>(i));
  }
  const SessionComparison result = compare(wrapped, wrapped);
  EXPECT_EQ(lines_in(comparison_svg(result, {"a", "a"}), "#8f0d33", false), 4U)
      << "three pieces of the path, and the battery";
}

TEST_F(Comparison, PathsLieOnTheTerrainOfTheStart) {
  Recording other = straight(100);
  const std::string same = comparison_svg(compare(straight(100), other), {"a", "b"});
  EXPECT_NE(same.find(">paths over the terrain at the start (ring: start, square: end)<"),
            std::string::npos);
  other.after.heights[5] = 50 * kUnits;
  const auto first_image = [](const std::string& svg) {
    const std::size_t at = svg.find("<image");
    return svg.substr(at, svg.find("/>", at) - at);
  };
  const std::string dug = comparison_svg(compare(other, other), {"a", "b"});
  EXPECT_EQ(first_image(dug), first_image(same)) << "whatever the run left";
  other.before.heights[0] += kUnits;
  EXPECT_NE(comparison_svg(compare(straight(100), other), {"a", "b"})
                .find(">paths over A's terrain at the start ("),
            std::string::npos);
}

TEST_F(Comparison, StatesEndWithTheRun) {
  const std::string svg = comparison_svg(compare(straight(500), straight(500)), {"a", "a"});
  // The band of the only state and the line of the battery end at the same time.
  const std::size_t band = svg.rfind("<rect", svg.rfind(">walk<"));
  double left = 0.0;
  double width = 0.0;
  double top = 0.0;
  ASSERT_EQ(std::sscanf(svg.c_str() + band, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\"", &left, &top,
                        &width),
            3);
  const std::size_t line = svg.rfind("<polyline", band);
  const std::string points = svg.substr(line, svg.find("\"/>", line) - line);
  double end = 0.0;
  ASSERT_EQ(std::sscanf(points.c_str() + points.rfind(' '), " %lf,", &end), 1);
  EXPECT_NEAR(left + width, end, 0.02);
}

TEST_F(Comparison, ASessionWithANumberThatIsNoneIsRefused) {
  Recording run = straight(10);
  run.info.experiment_text = "[map]\nmodel = particles\nparticle_radius = wide\n";
  try {
    compare(run, run);
    FAIL() << "was compared";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "the session's experiment, line 3: map.particle_radius = 'wide' is no number");
  }
}

TEST(DifferenceLimit, IsRoundAndLeavesOutSingleHeights) {
  EXPECT_DOUBLE_EQ(difference_limit_m({}), 1e-3);
  EXPECT_DOUBLE_EQ(difference_limit_m({0.0, 0.0}), 1e-3);
  EXPECT_DOUBLE_EQ(difference_limit_m({0.0, -0.0034}), 5e-3);
  EXPECT_DOUBLE_EQ(difference_limit_m({0.01, -0.01}), 1e-2);
  EXPECT_DOUBLE_EQ(difference_limit_m({1e-7}), 1e-4);
  std::vector<double> many(1000, 0.0018);
  many[500] = 0.4;
  EXPECT_DOUBLE_EQ(difference_limit_m(many), 2e-3);
}

}  // namespace
}  // namespace screed
