// Texts that are filled with figures.
#include "host_sim/core/figures.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace screed {
namespace {

TEST(Figures, StandInPlaceOfTheirNames) {
  const Json json = {
      {"name", "rover"}, {"ticks", 12}, {"end", {{"x_m", 0.1234}, {"at_m", {1, 2.5}}}}};
  EXPECT_EQ(filled("{name}: {ticks} ticks", json), "rover: 12 ticks");
  EXPECT_EQ(filled("x {end.x_m:.2f} m, {end.at_m.1} m", json), "x 0.12 m, 2.5 m");
  EXPECT_EQ(filled("{end.x_m*1000:8.1f} mm, {end.x_m*100:+.3g} %", json), "   123.4 mm, +12.3 %");
  EXPECT_EQ(filled("[{name:8s}] [{name:-8s}] [{ticks:5s}]", json), "[   rover] [rover   ] [   12]");
  EXPECT_EQ(filled("{ticks:.1f} and 5 %", json), "12.0 and 5 %");
}

TEST(Figures, ComeOneByOneWithoutNames) {
  EXPECT_EQ(filled("{}: {} of {:.1f} s", std::filesystem::path("out/a"), true, 2.0),
            "out/a: true of 2.0 s");
  EXPECT_EQ(filled("{} {}", std::uint64_t{18446744073709551615U}, -1), "18446744073709551615 -1");
  EXPECT_EQ(filled("{1}, {0}", "a", "b"), "b, a");
  EXPECT_EQ(filled("{:.2f}", Json(0.5)), "0.50");
  EXPECT_EQ(filled("no figure\n", Json()), "no figure\n");
}

TEST(Figures, ThatAreNotThereAreRefused) {
  EXPECT_THROW(filled("{nothing}", Json{{"name", "rover"}}), JsonError);
  EXPECT_THROW(filled("{} {}", 1), JsonError);
  EXPECT_THROW(filled("{name:.1f}", Json{{"name", "rover"}}), JsonError);
}

TEST(Figures, AreWrittenWhereAPathIsNoText) {
  ::testing::internal::CaptureStdout();
  print_json({{"file", "a\xff"}}, -1);
  print("{file}\n", Json{{"file", "a\xff"}});
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "{\"file\":\"a\xEF\xBF\xBD\"}\na\xff\n");
}

}  // namespace
}  // namespace screed
