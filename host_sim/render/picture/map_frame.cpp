#include "host_sim/render/picture/map_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace screed {

namespace {

constexpr Color kInk{0.13, 0.15, 0.17};
constexpr Color kFaintInk{0.42, 0.45, 0.48};
constexpr double kTickLength_px = 6.0;
constexpr double kTextSize_px = 15.0;

// Room around the map, in pixels.
constexpr double kLeft_px = 92.0;
constexpr double kRight_px = 232.0;
constexpr double kTop_px = 96.0;
constexpr double kBottom_px = 82.0;
constexpr double kBarGap_px = 34.0;
constexpr double kBarWidth_px = 24.0;
constexpr double kBarLabel_px = 28.0;  // above the bar
constexpr double kLegendGap_px = 46.0;
constexpr double kMargin_px = 20.0;

}  // namespace

Ticks round_ticks(double low, double high, int max_count) {
  Ticks ticks;
  if (!(low < high) || max_count < 2) return ticks;
  // The smallest round step that needs no more than `most` ticks.
  int exponent = static_cast<int>(std::floor(std::log10((high - low) / max_count))) - 1;
  constexpr std::array<double, 3> kMantissas = {1.0, 2.0, 5.0};
  constexpr double kSlack = 1e-9;  // of a step: an end that is a tick but for rounding counts
  for (size_t mantissa = 0;;) {
    const double step = kMantissas[mantissa] * std::pow(10.0, exponent);
    const double first = std::ceil(low / step - kSlack);
    const double last = std::floor(high / step + kSlack);
    if (last - first + 1.0 <= max_count) {
      ticks.step = step;
      ticks.decimals = std::max(0, -exponent);
      const auto count = static_cast<size_t>(last - first + 1.0);
      for (size_t i = 0; i < count; ++i) {
        ticks.values.push_back((first + static_cast<double>(i)) * step);
      }
      return ticks;
    }
    if (++mantissa == kMantissas.size()) {
      mantissa = 0;
      ++exponent;
    }
  }
}

std::string number_text(double value, int decimals) {
  std::array<char, 64> digits{};
  std::snprintf(digits.data(), digits.size(), "%.*f", decimals, std::abs(value));
  const std::string magnitude = digits.data();
  const bool is_zero = magnitude.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !is_zero ? "\u2212" + magnitude : magnitude;
}

MapFrame::MapFrame(Canvas& canvas, const MapRectangle& ground, double legend_height_px)
    : canvas_(canvas), ground_(ground) {
  const double room_x = canvas.width() - kLeft_px - kRight_px;
  const double room_y = canvas.height() - kTop_px - kBottom_px;
  const double size_x = ground.x_max - ground.x_min;
  const double size_y = ground.y_max - ground.y_min;
  pixels_per_metre_ = std::min(room_x / size_x, room_y / size_y);
  map_.width = std::max(1.0, std::round(size_x * pixels_per_metre_));
  map_.height = std::max(1.0, std::round(size_y * pixels_per_metre_));
  map_.left = kLeft_px + std::round(0.5 * (room_x - map_.width));
  map_.top = kTop_px + std::round(0.5 * (room_y - map_.height));

  // The bar begins at the map's top but leaves room for the legend, also beside a low map.
  bar_.left = map_.left + map_.width + kBarGap_px;
  bar_.width = kBarWidth_px;
  const double lowest_top = canvas.height() - kMargin_px - legend_height_px - kLegendGap_px;
  bar_.height = std::round(std::min(0.52 * room_y, lowest_top - kTop_px - kBarLabel_px));
  bar_.top = std::min(map_.top + kBarLabel_px, std::round(lowest_top - bar_.height));
  legend_ = {bar_.left, bar_.top + bar_.height + kLegendGap_px};
}

Pixel MapFrame::to_pixel(double x_m, double y_m) const {
  return {map_.left + (x_m - ground_.x_min) * pixels_per_metre_,
          map_.top + (ground_.y_max - y_m) * pixels_per_metre_};
}

double MapFrame::x_at(double pixel_x) const {
  return ground_.x_min + (pixel_x - map_.left) / pixels_per_metre_;
}

double MapFrame::y_at(double pixel_y) const {
  return ground_.y_max - (pixel_y - map_.top) / pixels_per_metre_;
}

void MapFrame::draw_fitted(Pixel anchor, const std::string& words, TextStyle style) {
  // A long legend lifts the bar beside the title, which then has to end before it.
  const bool lifted = bar_.top - kBarLabel_px < map_.top;
  const double room = (lifted ? bar_.left : canvas_.width()) - kMargin_px - anchor.x;
  const double width = canvas_.text_width(words, style);
  if (width > room) style.size_px *= room / width;
  canvas_.text(anchor, words, style);
}

void MapFrame::draw_title(const std::string& title, const std::string& subtitle) {
  draw_fitted({map_.left, map_.top - 46.0}, title, {.size_px = 25.0, .color = kInk, .bold = true});
  draw_fitted({map_.left, map_.top - 19.0}, subtitle, {.color = kFaintInk});
}

void MapFrame::draw_walls() {
  constexpr double kBoard_px = 5.0;
  canvas_.rectangle_outline({map_.left - 0.5 * kBoard_px, map_.top - 0.5 * kBoard_px,
                             map_.width + kBoard_px, map_.height + kBoard_px},
                            kBoard_px, kBoards);
}

void MapFrame::draw_axes() {
  canvas_.rectangle_outline({map_.left - 0.5, map_.top - 0.5, map_.width + 1.0, map_.height + 1.0},
                            1.0, kInk);
  const TextStyle along_x{.size_px = kTextSize_px, .color = kInk, .align = TextAlign::kCenter};
  const TextStyle along_y{.size_px = kTextSize_px, .color = kInk, .align = TextAlign::kRight};
  constexpr double kPixelsPerTick = 90.0;
  const auto max_count = [](double pixels) {
    return std::max(2, static_cast<int>(pixels / kPixelsPerTick));
  };

  const double bottom = map_.top + map_.height;
  const Ticks x_ticks = round_ticks(ground_.x_min, ground_.x_max, max_count(map_.width));
  for (const double x : x_ticks.values) {
    const double place = std::floor(to_pixel(x, ground_.y_min).x) + 0.5;
    canvas_.line(std::array<Pixel, 2>{{{place, bottom}, {place, bottom + kTickLength_px}}}, 1.0,
                 kInk);
    canvas_.text({place, bottom + 23.0}, number_text(x, x_ticks.decimals), along_x);
  }
  canvas_.text({map_.left + 0.5 * map_.width, bottom + 50.0}, "x, east [m]", along_x);

  const Ticks y_ticks = round_ticks(ground_.y_min, ground_.y_max, max_count(map_.height));
  double widest = 0.0;
  for (const double y : y_ticks.values) {
    const double place = std::floor(to_pixel(ground_.x_min, y).y) + 0.5;
    canvas_.line(std::array<Pixel, 2>{{{map_.left - kTickLength_px, place}, {map_.left, place}}},
                 1.0, kInk);
    const std::string label = number_text(y, y_ticks.decimals);
    canvas_.text({map_.left - 11.0, place + 5.0}, label, along_y);
    widest = std::max(widest, canvas_.text_width(label, along_y));
  }
  canvas_.text(
      {map_.left - 28.0 - widest, map_.top + 0.5 * map_.height}, "y, north [m]",
      {.size_px = kTextSize_px, .color = kInk, .align = TextAlign::kCenter, .upwards = true});
}

void MapFrame::draw_color_bar(const ColorScale& scale) {
  canvas_.text({bar_.left, bar_.top - 14.0}, scale.label, {.size_px = kTextSize_px, .color = kInk});
  const int rows = static_cast<int>(bar_.height);
  for (int row = 0; row < rows; ++row) {
    const double value = scale.high - (row + 0.5) / rows * (scale.high - scale.low);
    canvas_.rectangle({bar_.left, bar_.top + row, bar_.width, 1.0}, scale.color(value));
  }
  canvas_.rectangle_outline({bar_.left - 0.5, bar_.top - 0.5, bar_.width + 1.0, bar_.height + 1.0},
                            1.0, kInk);
  const Ticks ticks =
      round_ticks(scale.low, scale.high, std::max(2, static_cast<int>(bar_.height / 40.0)));
  const double right = bar_.left + bar_.width;
  for (const double value : ticks.values) {
    const double part = (scale.high - value) / (scale.high - scale.low);
    const double place = std::floor(bar_.top + part * bar_.height) + 0.5;
    canvas_.line(std::array<Pixel, 2>{{{right, place}, {right + kTickLength_px, place}}}, 1.0,
                 kInk);
    canvas_.text({right + 12.0, place + 5.0}, number_text(value, ticks.decimals),
                 {.size_px = kTextSize_px, .color = kInk});
  }
}

void MapFrame::draw_scale_bar() {
  // A round length of about a sixth of the map, under its right end.
  const double longest_m = map_.width / pixels_per_metre_ / 6.0;
  const Ticks lengths = round_ticks(0.0, longest_m, 2);
  const double length_m = lengths.values.size() > 1 ? lengths.values[1] : longest_m;
  const double length_px = length_m * pixels_per_metre_;
  const double right = map_.left + map_.width;
  const double base = map_.top + map_.height + 46.0;
  const std::array<Pixel, 4> bracket = {{{right - length_px, base - 5.0},
                                         {right - length_px, base},
                                         {right, base},
                                         {right, base - 5.0}}};
  canvas_.line(bracket, 1.6, kInk);
  canvas_.text({right - 0.5 * length_px, base + 18.0},
               number_text(length_m, lengths.decimals) + " m",
               {.size_px = kTextSize_px, .color = kInk, .align = TextAlign::kCenter});
}

}  // namespace screed
