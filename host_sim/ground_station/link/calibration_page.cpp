// The page that `screed calibrate` shows.
#include "host_sim/ground_station/link/calibration_page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace screed {
namespace {

constexpr double kSilent_s = 1.0;
constexpr int kMagnetCurveHeight = 9;
constexpr double kCurve_s = 60.0;

bool lost(const CalibrationPageInput& input) {
  return !input.link.up || input.silent_s > kSilent_s;
}

void draw_head(TextCanvas& page, const CalibrationPageInput& input) {
  std::string text = input.link_name + " " + input.link.text;
  if (lost(input)) {
    char silent[48];
    std::snprintf(silent, sizeof silent, "LINK LOST: silent for %.0f s  ",
                  std::floor(input.silent_s));
    text.insert(0, silent);
  } else {
    text.insert(0, "screed calibrate  ");
  }
  page.text_within(0, 0, page.width(), text, lost(input) ? CellStyle::kAlarm : CellStyle::kTitle);
}

void draw_position(TextCanvas& page, int x, int y, Position position, const ImuCollector& collector,
                   bool old) {
  const bool done = collector.position_done(position);
  const CellStyle pale = old ? CellStyle::kDim : CellStyle::kNormal;
  page.text(x, y, done ? "[x]" : "[ ]", done && !old ? CellStyle::kGood : pale);
  const int end = page.text(x + 4, y, position_name(position), pale);
  if (collector.position() == position && !old)
    page.text(end + 2, y, collector.at_rest() ? "<- still" : "<- moving", CellStyle::kWarning);
}

/// Length of the field as read: a straight line once it is calibrated.
void draw_field(TextCanvas& page, int y, int height, const CalibrationPageInput& input) {
  page.box(0, y, page.width(), height + 2, "length of the magnetic field as read, mG, 0 to 1000",
           lost(input) ? CellStyle::kAlarm : CellStyle::kDim);
  if (input.field.empty()) return;
  const double end_s = input.field.back().x;
  page.curve(2, y + 1, page.width() - 4, height, input.field,
             {end_s - kCurve_s, end_s, 0.0, 1000.0});
}

}  // namespace

void draw_calibration(TextCanvas& page, const CalibrationPageInput& input) {
  const ImuCollector& collector = *input.collector;
  const bool old = lost(input);
  const auto positions = static_cast<int>(kPositions);
  const int footer = page.height() - 1;
  draw_head(page, input);
  // Head, advice, positions, magnetometer, footer; with blank lines between where there is room.
  const int gap = page.height() >= positions + 7 ? 1 : 0;
  int y = 1 + gap;
  if (y < footer) {
    page.text_within(0, y++, page.width(), old ? "wait for the robot" : collector.advice(),
                     old ? CellStyle::kAlarm : CellStyle::kGood);
  }
  y += gap;
  const int room = footer - y - 1;  // with the line of the magnetometer
  for (int i = 0; i < positions && room >= positions; ++i)
    draw_position(page, 2, y++, static_cast<Position>(i), collector, old);
  y += gap;
  if (y < footer) {
    char text[96];
    std::snprintf(text, sizeof text, "magnetometer: %.0f %% of all directions, %zu samples",
                  std::floor(collector.mag_coverage() * 100.0), collector.mag_samples().size());
    page.text_within(2, y++, page.width() - 2, text, old ? CellStyle::kDim : CellStyle::kNormal);
  }
  const int height = std::min(kMagnetCurveHeight, footer - y - 2);
  if (height >= 3) draw_field(page, y, height, input);
  if (footer > 0) {
    const bool cut = room < positions || height < 3;
    page.text_within(0, footer, page.width(),
                     cut ? "q give up  (cut: 80 x 24 shows all)" : "q give up", CellStyle::kDim);
  }
}

}  // namespace screed
