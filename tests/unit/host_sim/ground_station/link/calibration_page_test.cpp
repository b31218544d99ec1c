// The page of the calibration at all sizes, and with a lost link.
#include "host_sim/ground_station/link/calibration_page.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

class CalibrationPage : public ::testing::Test {
 protected:
  CalibrationPage() {
    input_.link_name = "/dev/ttyUSB0";
    input_.link.up = true;
    input_.link.text = "up";
    input_.collector = &collector_;
    input_.field = field_;
  }
  TextCanvas page(int width, int height) const {
    TextCanvas canvas(width, height);
    draw_calibration(canvas, input_);
    return canvas;
  }

  ImuCollector collector_;
  const std::vector<CurvePoint> field_ = {{0.0, 480.0}, {1.0, 520.0}};
  CalibrationPageInput input_;
};

TEST_F(CalibrationPage, KeepsWhatMattersInSmallTerminals) {
  struct Case {
    int width;
    int height;
    bool positions;
    bool curve;
  };
  for (const Case& it : {Case{80, 24, true, true}, Case{60, 15, true, false},
                         Case{40, 10, true, false}, Case{40, 8, false, false}}) {
    const std::string text = page(it.width, it.height).str();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), it.height);
    EXPECT_NE(text.find("/dev/ttyUSB0 up"), std::string::npos) << text;
    EXPECT_NE(text.find("turn the robot level"), std::string::npos) << text;
    EXPECT_NE(text.find("magnetometer: 0 %"), std::string::npos) << text;
    EXPECT_NE(text.find("q give up"), std::string::npos) << text;
    EXPECT_EQ(
        text.find("[ ] " + std::string(position_name(Position::kRightUp))) != std::string::npos,
        it.positions)
        << text;
    EXPECT_EQ(text.find("┌") != std::string::npos, it.curve) << text;
    EXPECT_EQ(text.find("└") != std::string::npos, it.curve) << text;
    EXPECT_EQ(text.find("cut: 80 x 24 shows all") == std::string::npos, it.curve) << text;
  }
  for (const int height : {1, 2, 3, 5}) {
    const std::string text = page(20, height).str();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), height);
  }
}

TEST_F(CalibrationPage, ALostLinkIsRed) {
  EXPECT_EQ(page(80, 24).at(0, 0).style, CellStyle::kTitle);
  for (const bool pulled : {false, true}) {
    input_.silent_s = pulled ? 0.0 : 4.2;
    input_.link.up = !pulled;
    const TextCanvas lost = page(80, 24);
    EXPECT_NE(lost.str().find("LINK LOST: silent for "), std::string::npos);
    EXPECT_NE(lost.str().find("wait for the robot"), std::string::npos);
    EXPECT_EQ(lost.at(0, 0).style, CellStyle::kAlarm);
    EXPECT_EQ(lost.at(0, 2).style, CellStyle::kAlarm) << "what to do";
    EXPECT_EQ(lost.at(0, 13).style, CellStyle::kAlarm) << lost.str();
  }
}

}  // namespace
}  // namespace screed
