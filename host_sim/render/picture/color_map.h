// Colours for pictures: perceptually even ramps for numbers, a fixed set for categories.
// Knows nothing of drawing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace screed {

/// sRGB (gamma-encoded) components and opacity, each 0..1.
struct Color {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

/// 0x00RRGGBB, each component rounded to 8 bits, without the opacity.
uint32_t pixel_of(Color color);
/// Red, green and blue of each pixel.
std::vector<uint8_t> rgb_bytes(std::span<const uint32_t> pixels);

/// Of the walls of a bed.
inline constexpr Color kBoards{0.66, 0.50, 0.32};

/// Heights: dark slate over green and sand to near white as t goes from 0 to 1 (clamped). Lightness
/// rises evenly, so equal steps of height look equal, also in grey print.
Color height_color(double t);

/// Slopes: level ground pale and cool, over sand and orange to dark wine as t goes from 0 to 1
/// (clamped). Lightness falls evenly.
Color slope_color(double t);

/// Differences: t = -1 blue (cut), 0 near white, +1 red-brown (fill), clamped; both sides equally
/// light at equal distance from 0.
Color difference_color(double t);

/// Categories: colours that stay apart on height_color(); the first eight also for colour-blind
/// eyes (after M. Okabe and K. Ito, 2002). The index counts modulo kCategoryColors.
inline constexpr size_t kCategoryColors = 10;
Color category_color(size_t index);

/// The same colours for lines on white ground, without those that are too light for it.
Color line_color(size_t index);

/// Black or white, whichever reads better on this colour.
Color ink_on(Color ground);

// Colours of the leveling algorithm's states, the same in every picture, window and legend. A state
// is a number here: its name and its meaning are the schema's (leveling.state).

/// How many states have a colour; a test holds this against the schema.
inline constexpr size_t kStateColors = 12;

/// Of the path in a state and of all that names the state; grey for a state without a colour.
inline Color state_color(size_t state) {
  // Idle is grey: nothing happens. The rest are categories that stay apart on terrain.
  static const std::array<Color, kStateColors> kColors = {{
      {0.55, 0.58, 0.60},  // idle
      category_color(0),   // walk
      category_color(1),   // climb
      category_color(2),   // spin
      category_color(3),   // return
      category_color(4),   // drive
      category_color(5),   // training_drive
      category_color(7),   // done
      category_color(6),   // cover
      category_color(8),   // escape
      {0.15, 0.35, 0.15},  // seek_wall
      {0.85, 0.10, 0.45},  // stroke
  }};
  return state < kColors.size() ? kColors[state] : Color{0.55, 0.58, 0.60};
}

}  // namespace screed
