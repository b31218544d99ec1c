// ANSI text of a frame.
#include "host_sim/grid/grid_text_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "host_sim/render/picture/color_map.h"

namespace screed {
namespace {

constexpr int kWordLines = 4;

/// Cells a side of the block that shares a place.
int block_size(const GridFrame& frame, const TextViewOptions& options) {
  const int across = std::max(1, options.columns / 2);
  const int down = std::max(1, options.rows - kWordLines - 1);
  const int by_width = (frame.terrain.width + across - 1) / across;
  const int by_height = (frame.terrain.height + down - 1) / down;
  return std::max({1, by_width, by_height});
}

std::string background(const Color& color, bool true_color) {
  char text[40];
  if (true_color) {
    const uint32_t rgb = pixel_of(color);
    std::snprintf(text, sizeof text, "\033[48;2;%u;%u;%um", rgb >> 16U, rgb >> 8U & 0xFFU,
                  rgb & 0xFFU);
  } else {
    const auto level = [](double part) { return static_cast<int>(std::lround(part * 5.0)); };
    std::snprintf(text, sizeof text, "\033[48;5;%dm",
                  16 + 36 * level(color.red) + 6 * level(color.green) + level(color.blue));
  }
  return text;
}

std::string bar(double share) {
  constexpr int kWidth = 30;
  const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * kWidth);
  std::string text;
  for (int i = 0; i < kWidth; ++i) text += i < full ? "\u2588" : "\u2591";
  return text;
}

/// What stands in a block of cells.
struct Block {
  uint64_t sum = 0;
  int cells = 0;
  int empty_agents = 0;
  int loaded_agents = 0;
};

}  // namespace

int text_view_lines(const GridFrame& frame, const TextViewOptions& options) {
  const int size = block_size(frame, options);
  return (frame.terrain.height + size - 1) / size + kWordLines;
}

std::string text_view(const GridFrame& frame, const TextViewOptions& options) {
  const GridTerrain& terrain = frame.terrain;
  const int size = block_size(frame, options);
  const int across = (terrain.width + size - 1) / size;
  const int down = (terrain.height + size - 1) / size;
  std::vector<Block> blocks(static_cast<size_t>(across) * static_cast<size_t>(down));
  const auto block = [&](int x, int y) -> Block& {
    return blocks[static_cast<size_t>(y / size) * static_cast<size_t>(across) +
                  static_cast<size_t>(x / size)];
  };
  auto stack = terrain.heights.begin();
  for (int y = 0; y < terrain.height; ++y) {
    for (int x = 0; x < terrain.width; ++x, ++stack) {
      block(x, y).sum += *stack;
      ++block(x, y).cells;
    }
  }
  for (const FrameAgent& agent : frame.agents) {
    ++(agent.carries ? block(agent.x, agent.y).loaded_agents
                     : block(agent.x, agent.y).empty_agents);
  }

  const std::string end = "\033[0m\033[K\n";
  std::string text = "\033[1m" + options.title + end;
  const double range = std::max(1, options.highest - options.lowest);
  for (int row = down - 1; row >= 0; --row) {
    for (int column = 0; column < across; ++column) {
      const Block& here = blocks[static_cast<size_t>(row) * static_cast<size_t>(across) +
                                 static_cast<size_t>(column)];
      const double height = static_cast<double>(here.sum) / here.cells;
      text += background(height_color((height - options.lowest) / range), options.true_color);
      // Black and white stand out from every height colour.
      if (here.loaded_agents > 0) {
        text += "\033[38;5;16m\u2588\u2588";
      } else if (here.empty_agents > 0) {
        text += "\033[38;5;16m\u2590\u258c";
      } else {
        text += "  ";
      }
    }
    text += end;
  }
  const auto [least, greatest] =
      std::minmax_element(terrain.heights.begin(), terrain.heights.end());
  char words[200];
  std::snprintf(words, sizeof words, "cycle %8llu   units moved %7llu   heights %u to %u",
                static_cast<unsigned long long>(frame.cycle),
                static_cast<unsigned long long>(frame.units), *least, *greatest);
  text += words + end;
  std::snprintf(words, sizeof words, " %3.0f %% leveled", 100.0 * options.progress);
  text += bar(options.progress) + words + end;
  text += "\u2588\u2588 loaded (" + std::to_string(frame.carried()) + ")   \u2590\u258c empty (" +
          std::to_string(frame.agents.size() - frame.carried()) + ")" + end;
  return text;
}

}  // namespace screed
