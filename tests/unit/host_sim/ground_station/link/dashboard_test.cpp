// The pages of the monitor: what is said, what is old, a lost link, small terminals.
#include "host_sim/ground_station/link/dashboard.h"

#include <gtest/gtest.h>

#include "tests/unit/host_sim/ground_station/said_frames.h"

namespace screed {
namespace {

using State = message::HeartbeatState;

struct Size {
  int width;
  int height;
};

class DashboardTest : public ::testing::Test {
 protected:
  DashboardTest() {
    say(heartbeat(State::kFault, message::HeartbeatFaults::kTilt), 3'900'000);
    for (int i = 0; i < 100; ++i)
      say(attitude(static_cast<int16_t>(i * 10), -700), static_cast<uint64_t>(i) * 40'000);
    say(message::Power{7100, 30}, 3'900'000);
    say(message::Odometry{-1200, 500, 0}, 3'900'000);
    say(message::Leveling{0, 1, 2, 100, 0}, 3'900'000);
    input_.now_us = kStart_us + 4'000'000;
    input_.link_name = "vcan0";
    input_.link.up = true;
    input_.link.text = "up";
    input_.fleet = &fleet_;
    input_.curves = {"attitude.roll"};
    input_.battery_cells = 6;
    input_.footer = {"SPACE emergency stop", "a arm", "q quit", "log: something.log"};
  }

  template <class Message>
  void say(const Message& message, uint64_t after_us) {
    LinkFrame frame = frame_with(message, counter_++ & 0xFU, kStart_us + after_us);
    fleet_.add_frame(frame);
  }
  TextCanvas page(int width, int height) const {
    TextCanvas canvas(width, height);
    draw_dashboard(canvas, input_);
    return canvas;
  }
  std::string draw(int width, int height) const { return page(width, height).str(); }
  /// Styles of a page's cells that show something.
  static size_t count(const TextCanvas& page, CellStyle style) {
    size_t cells = 0;
    for (int y = 0; y < page.height(); ++y) {
      for (int x = 0; x < page.width(); ++x) {
        const TextCell& cell = page.at(x, y);
        if (cell.character != U' ' && cell.style == style) ++cells;
      }
    }
    return cells;
  }
  /// The style of the first character of `words`.
  static CellStyle style_of(const TextCanvas& page, const std::string& words) {
    const std::u32string wanted = from_utf8(words);
    for (int y = 0; y < page.height(); ++y) {
      std::u32string line;
      for (int x = 0; x < page.width(); ++x) line += page.at(x, y).character;
      const size_t at = line.find(wanted);
      if (at != std::u32string::npos) return page.at(static_cast<int>(at), y).style;
    }
    ADD_FAILURE() << words << " is not on the page\n" << page.str();
    return CellStyle::kNormal;
  }
  static void expect_words(const std::string& page, const std::vector<std::string>& all) {
    for (const std::string& words : all)
      EXPECT_NE(page.find(words), std::string::npos) << words << "\n" << page;
  }

  FleetView fleet_;
  DashboardInput input_;
  uint8_t counter_ = 0;
};

TEST_F(DashboardTest, ShowsLinkStateValuesAndFaultsInWords) {
  expect_words(draw(120, 40), {"robot 1 fault", "vcan0 up", "9.90 deg", "-7.00 deg", "7.10 V, 15 %",
                               "tilted beyond tilt_limit, 12 degrees", "attitude.roll deg", "a arm",
                               "log: something.log"});
}

TEST_F(DashboardTest, SaysWhatPreventsArming) {
  message::Heartbeat it = heartbeat(State::kDisarmed, 0);
  it.link_alive = 1;
  say(it, 3'950'000);
  expect_words(draw(80, 24), {"robot 1 disarmed", "none; can be armed"});
  it.faults = message::HeartbeatFaults::kBattery;
  it.link_alive = 0;
  say(it, 3'960'000);
  expect_words(draw(80, 24), {" cannot be armed ", "battery below battery_low, 7.10 V",
                              "the robot hears no ground station"});
  expect_words(plain_report(input_), {"  cannot be armed: the robot hears no ground station\n"});
}

TEST_F(DashboardTest, ALongListOfFaultsSaysThatThereIsMore) {
  say(heartbeat(State::kFault, 0x3FFF), 3'950'000);
  expect_words(draw(120, 40), {"lines more"});
}

TEST_F(DashboardTest, OldValuesArePaleAndHaveTheirAge) {
  TextCanvas now = page(120, 40);
  EXPECT_EQ(style_of(now, "9.90 deg"), CellStyle::kNormal);
  EXPECT_EQ(now.str().find(" s)"), std::string::npos) << now.str();
  // The robot goes on, but its attitude does not come any more.
  for (int i = 1; i <= 40; ++i)
    say(message::Power{7100, 30}, 4'000'000U + static_cast<uint64_t>(i) * 100'000U);
  input_.now_us = kStart_us + 8'000'000;
  now = page(120, 40);
  EXPECT_EQ(style_of(now, "9.90 deg (4 s)"), CellStyle::kDim);
  EXPECT_EQ(style_of(now, "-12"), CellStyle::kDim) << "odometry, not attitude alone";
  EXPECT_EQ(style_of(now, "7.10 V, 15 %"), CellStyle::kWarning) << "is not old";
  EXPECT_EQ(style_of(now, "robot 1"), CellStyle::kTitle);
  expect_words(plain_report(input_), {"attitude (4 s old): roll 9.90", "  power: battery 7100"});
}

TEST_F(DashboardTest, AMessageOfOneASecondIsNotOldBetweenTwo) {
  say(message::Link{0, 0, 0, 0, 100}, 4'000'000);
  say(heartbeat(State::kRunning, 0), 5'300'000);
  const RobotHistory& robot = fleet_.robots().begin()->second;
  EXPECT_FALSE(is_old(robot, *find_message("LINK"), kStart_us + 5'400'000));
  EXPECT_TRUE(is_old(robot, *find_message("LINK"), kStart_us + 5'600'000));
  EXPECT_FALSE(is_old(robot, *find_message("POWER"), kStart_us + 4'900'000));
  EXPECT_TRUE(is_old(robot, *find_message("POWER"), kStart_us + 4'901'000));
  EXPECT_FALSE(is_old(robot, *find_message("BARO"), kStart_us + 9'000'000)) << "never came";
}

TEST_F(DashboardTest, AgesAreSaidInTheirUnit) {
  EXPECT_EQ(age_text(1.96), "1 s");
  EXPECT_EQ(age_text(59.9), "59 s");
  EXPECT_EQ(age_text(61.0), "1 min");
  EXPECT_EQ(age_text(7300.0), "2 h");
}

TEST_F(DashboardTest, ALostLinkIsRedEverywhere) {
  const TextCanvas well = page(120, 40);
  EXPECT_EQ(style_of(well, "┌"), CellStyle::kDim);
  EXPECT_EQ(well.str().find("LOST"), std::string::npos);
  input_.now_us += 5'000'000;
  for (const bool pulled : {false, true}) {
    if (pulled) {
      input_.now_us -= 5'000'000;
      input_.link.up = false;
      input_.link.text = "gone";
    }
    const TextCanvas lost = page(120, 40);
    expect_words(lost.str(), {"robot 1 was fault, SILENT for ", "LINK LOST"});
    for (const char* words :
         {"robot 1 was", "LINK LOST", "┌", " attitude ", " link ", " attitude.roll"})
      EXPECT_EQ(style_of(lost, words), CellStyle::kAlarm) << words;
    EXPECT_EQ(count(lost, CellStyle::kGood), 0U) << lost.str();
    // Without frames the labels are.
    EXPECT_EQ(style_of(page(60, 15), "battery"), CellStyle::kAlarm);
    EXPECT_NE(plain_report(input_).find(", SILENT for "), std::string::npos);
  }
}

TEST_F(DashboardTest, ARobotThatHearsNobodyIsAnAlarm) {
  EXPECT_EQ(style_of(page(120, 40), "no ground station"), CellStyle::kAlarm);
}

TEST_F(DashboardTest, BeforeARobotIsHeardThePageSaysSo) {
  const FleetView nobody;
  input_.fleet = &nobody;
  expect_words(draw(120, 40), {"no robot heard yet", "vcan0 up"});
  input_.link.up = false;
  EXPECT_EQ(style_of(page(120, 40), "no robot heard"), CellStyle::kAlarm);
}

TEST_F(DashboardTest, TheBatteryWarnsBeforeTheRobotDoes) {
  for (const auto& [mv, style] :
       {std::pair{8000, CellStyle::kNormal}, {7100, CellStyle::kWarning}}) {
    say(message::Power{static_cast<uint16_t>(mv), 0}, 3'950'000);
    EXPECT_EQ(style_of(page(120, 40), mv == 8000 ? "8.00 V" : "7.10 V"), style);
  }
  say(heartbeat(State::kFault, message::HeartbeatFaults::kBattery), 3'960'000);
  EXPECT_EQ(style_of(page(120, 40), "7.10 V, 15 %  TOO LOW"), CellStyle::kAlarm);
}

// ---- sizes

TEST_F(DashboardTest, FitsEveryTerminal) {
  for (const int width : {1, 20, 40, 60, 80, 300}) {
    for (const int height : {1, 2, 3, 10, 15, 21, 24, 100}) {
      const std::string text = draw(width, height);
      EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), height);
    }
  }
}

TEST_F(DashboardTest, SmallTerminalsKeepWhatMattersAndSayThatTheyAreCut) {
  for (const Size size : {Size{60, 15}, Size{40, 10}}) {
    const std::string text = draw(size.width, size.height);
    expect_words(
        text, {"robot 1 fault", "vcan0 up", "tilted beyond tilt_limit", "7.10 V, 15 %  LOW",
               "no ground station heard", "lines cut: 80 x 21 shows all", "SPACE emergency stop"});
    EXPECT_EQ(text.find("┌"), std::string::npos) << text;
  }
  // As many lines as there are are shown: nothing is cut.
  const std::string tall = draw(60, 40);
  EXPECT_EQ(tall.find("cut"), std::string::npos) << tall;
  expect_words(tall, {"peaks", "strength"});
}

TEST_F(DashboardTest, BoxesAreWholeOrNotThere) {
  for (int width = 1; width <= 200; width += 13) {
    for (int height = 1; height <= 60; ++height) {
      const std::string text = draw(width, height);
      const auto corners = [&text](const char* corner) {
        size_t found = 0;
        for (size_t at = text.find(corner); at != std::string::npos; at = text.find(corner, at + 1))
          ++found;
        return found;
      };
      EXPECT_EQ(corners("┌"), corners("┘")) << width << " x " << height << "\n" << text;
      EXPECT_EQ(corners("┐"), corners("└")) << width << " x " << height << "\n" << text;
    }
  }
}

TEST_F(DashboardTest, CurvesWithoutRoomAreNamed) {
  input_.curves = {"attitude.roll", "attitude.pitch", "power.battery"};
  expect_words(draw(80, 24), {"3 of 3 curves have no room: they need 41 lines"});
  expect_words(draw(80, 30), {"2 of 3 curves have no room", "attitude.roll deg"});
  EXPECT_EQ(draw(80, 41).find("no room"), std::string::npos);
  expect_words(draw(80, 41), {"power.battery mV"});
}

TEST_F(DashboardTest, TheValueOfACurveThatIsOldIsPale) {
  // In the curve's upper edge, 14 cells from its right end.
  const auto style_of_value = [this] {
    const TextCanvas canvas = page(80, 41);
    for (int y = 0; y < canvas.height(); ++y) {
      std::u32string row;
      for (int x = 0; x < canvas.width(); ++x) row += canvas.at(x, y).character;
      if (row.find(U"attitude.roll deg") != std::u32string::npos) {
        return canvas.at(static_cast<int>(row.find_first_of(U"0123456789", 66)), y).style;
      }
    }
    return CellStyle::kAlarm;
  };
  EXPECT_EQ(style_of_value(), CellStyle::kTitle);
  input_.now_us += 3'000'000;
  EXPECT_EQ(style_of_value(), CellStyle::kDim);
}

TEST_F(DashboardTest, ALinkOfALongNameHidesNothing) {
  input_.link_name = "/dev/serial/by-id/usb-FTDI_FT231X_USB_UART_DN00ABCD-if00-port0-of-a-hub";
  const std::string text = draw(80, 24);
  expect_words(text, {"robot 1 fault", "/dev/serial/by-id", "…"});
}

TEST_F(DashboardTest, ShowsHowSureThePlaceIsAndTheSlipOfBothTracks) {
  constexpr BoardConstants kHalfMillimetre = {8000, 1831, 200, 7200, 250, 145};
  for (uint16_t i = 0; i <= 20; ++i) {
    const uint64_t after_us = 2'900'000 + i * 50'000U;
    // 0.2 m/s on the left, 0.1 m/s on the right, the heading that of a robot that rolls.
    say(message::Encoders{static_cast<uint16_t>(i * 20), static_cast<uint16_t>(i * 10), 0},
        after_us);
    say(message::Odometry{0, 0, 9000}, after_us);
  }
  say(message::Position{12, 30, 7, 255}, 3'900'000);
  EXPECT_NE(plain_report(input_).find("slip l, r: -\n"), std::string::npos) << "of which board?";
  input_.board = &kHalfMillimetre;
  const std::string slip = "25 %, -50 %";  // straight on at 0.15 m/s
  expect_words(plain_report(input_), {"  slip l, r: " + slip});
  expect_words(draw(120, 40), {slip, "48, 120 mm, 3.5 deg"});
}

TEST_F(DashboardTest, APlainReportHasEveryValueOnce) {
  expect_words(plain_report(input_),
               {"link vcan0: up", "robot 1: fault, 104 frames, ", "  faults: tilted beyond",
                "  battery: 7.10 V, 15 %  LOW\n", "  attitude: roll 9.90 deg pitch -7.00 "});
}

}  // namespace
}  // namespace screed
