// The grid world as coloured text for a terminal (ANSI escape sequences): a coloured cell a stack,
// dots for agents, a few figures below. Makes text only; who prints it, and when, is the caller's.
#pragma once

#include <string>

#include "host_sim/grid/grid_recording.h"

namespace screed {

struct TextViewOptions {
  int columns = 80;  ///< of the terminal
  int rows = 40;
  bool true_color = true;  ///< 24-bit colours; otherwise the 256 of xterm
  int lowest = 0;          ///< stacks of this height and lower get the darkest colour
  int highest = 13;
  std::string title;
  double progress = 0.0;  ///< 0..1, shown as a bar
};

/// Lines of a frame, each ended by "clear to the end of the line" and a newline, row of greatest y
/// first. When the grid does not fit, square blocks of cells share a place: their mean height is
/// shown.
std::string text_view(const GridFrame& frame, const TextViewOptions& options);

/// The number of lines that text_view() makes.
int text_view_lines(const GridFrame& frame, const TextViewOptions& options);

}  // namespace screed
