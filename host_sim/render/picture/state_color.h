// Colours of the leveling algorithm's states, the same in every picture, window and legend. A state
// is a number here: its name and its meaning are the schema's (leveling.state).
#pragma once

#include <array>
#include <cstddef>

#include "host_sim/render/picture/color_map.h"

namespace screed {

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
