// A page of characters.
#include "host_sim/ground_station/link/text_canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

namespace screed {
namespace {

constexpr char32_t kBraille = 0x2800;
constexpr int kDotsX = 2;
constexpr int kDotsY = 4;
// Bit of each dot in the braille block, by row and column.
constexpr std::array<std::array<uint8_t, kDotsX>, kDotsY> kDotBits = {
    {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}}};

}  // namespace

std::vector<std::string> break_lines(std::string_view text, int width) {
  std::vector<std::string> lines(1);
  size_t column = 0;  // characters in the last line
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(' ', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    const size_t length = from_utf8(word).size();
    if (column > 0 && column + 1 + length > static_cast<size_t>(std::max(width, 1))) {
      lines.emplace_back();
      column = 0;
    }
    if (column > 0) lines.back() += ' ';
    lines.back() += word;
    column += length + (column > 0 ? 1 : 0);
    begin = end + 1;
  }
  return lines;
}

std::string utf8(char32_t c) {
  const auto byte = [](char32_t bits) { return static_cast<char>(bits); };
  if (c < 0x80) return {byte(c)};
  if (c < 0x800) return {byte(0xC0 | c >> 6U), byte(0x80 | (c & 0x3F))};
  if (c < 0x10000)
    return {byte(0xE0 | c >> 12U), byte(0x80 | (c >> 6U & 0x3F)), byte(0x80 | (c & 0x3F))};
  return {byte(0xF0 | c >> 18U), byte(0x80 | (c >> 12U & 0x3F)), byte(0x80 | (c >> 6U & 0x3F)),
          byte(0x80 | (c & 0x3F))};
}

std::u32string from_utf8(std::string_view text) {
  std::u32string characters;
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const size_t more = lead < 0x80 ? 0 : (lead >> 5U == 6 ? 1 : (lead >> 4U == 14 ? 2 : 3));
    if ((lead >= 0x80 && lead < 0xC0) || i + more >= text.size()) {
      characters.push_back(U'?');
      ++i;
      continue;
    }
    char32_t c = more == 0 ? lead : lead & (0x3FU >> more);
    for (size_t k = 1; k <= more; ++k)
      c = c << 6U | (static_cast<unsigned char>(text[i + k]) & 0x3FU);
    characters.push_back(c);
    i += more + 1;
  }
  return characters;
}

TextCanvas::TextCanvas(int width, int height)
    : width_(std::max(width, 1)),
      height_(std::max(height, 1)),
      cells_(static_cast<size_t>(width_) * static_cast<size_t>(height_)) {}

void TextCanvas::put(int x, int y, char32_t character, CellStyle style) {
  if (x < 0 || x >= width_ || y < 0 || y >= height_) return;
  cells_[index(x, y)] = {character, style};
}

int TextCanvas::text(int x, int y, std::string_view words, CellStyle style) {
  for (const char32_t character : from_utf8(words)) put(x++, y, character, style);
  return x;
}

int TextCanvas::text_within(int x, int y, int width, std::string_view words, CellStyle style) {
  std::u32string characters = from_utf8(words);
  if (width <= 0) return x;
  if (characters.size() > static_cast<size_t>(width)) {
    characters.resize(static_cast<size_t>(width));
    characters.back() = U'…';
  }
  for (const char32_t character : characters) put(x++, y, character, style);
  return x;
}

void TextCanvas::box(int x, int y, int width, int height, std::string_view title, CellStyle edge) {
  for (int i = 1; i < width - 1; ++i) {
    put(x + i, y, U'─', edge);
    put(x + i, y + height - 1, U'─', edge);
  }
  for (int i = 1; i < height - 1; ++i) {
    put(x, y + i, U'│', edge);
    put(x + width - 1, y + i, U'│', edge);
  }
  put(x, y, U'┌', edge);
  put(x + width - 1, y, U'┐', edge);
  put(x, y + height - 1, U'└', edge);
  put(x + width - 1, y + height - 1, U'┘', edge);
  text_within(x + 2, y, width - 4, " " + std::string(title) + " ",
              edge == CellStyle::kAlarm ? edge : CellStyle::kTitle);
}

void TextCanvas::centred_bar(int x, int y, int width, double value, CellStyle style) {
  const int middle = width / 2;
  for (int i = 0; i < width; ++i) put(x + i, y, U'·', CellStyle::kDim);
  const int reach = static_cast<int>(std::lround(std::clamp(value, -1.0, 1.0) * middle));
  for (int i = std::min(reach, 0); i <= std::max(reach, 0); ++i) {
    if (i != 0) put(x + middle + i, y, U'█', style);
  }
  put(x + middle, y, U'│', CellStyle::kNormal);
}

void TextCanvas::curve(int x, int y, int width, int height, std::span<const CurvePoint> points,
                       const CurveRange& range) {
  if (width <= 0 || height <= 0) return;
  const int dots_x = width * kDotsX;
  const int dots_y = height * kDotsY;
  std::vector<uint8_t> bits(static_cast<size_t>(width) * static_cast<size_t>(height));
  const auto dot = [&](int px, int py) {
    const auto cell = static_cast<size_t>(py / kDotsY) * static_cast<size_t>(width) +
                      static_cast<size_t>(px / kDotsX);
    bits[cell] = static_cast<uint8_t>(
        bits[cell] |
        kDotBits.at(static_cast<size_t>(py % kDotsY)).at(static_cast<size_t>(px % kDotsX)));
  };
  const auto place = [](double value, double low, double high, int dots) {
    const double share = high > low ? (value - low) / (high - low) : 0.5;
    return static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * (dots - 1)));
  };
  bool joined = false;
  int last_x = 0;
  int last_y = 0;
  for (const CurvePoint& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      joined = false;
      continue;
    }
    const int px = place(point.x, range.x_min, range.x_max, dots_x);
    const int py = dots_y - 1 - place(point.y, range.y_min, range.y_max, dots_y);
    const int steps = joined ? std::max({std::abs(px - last_x), std::abs(py - last_y), 1}) : 1;
    if (!joined) {
      last_x = px;
      last_y = py;
    }
    for (int i = 0; i <= steps; ++i)
      dot(last_x + (px - last_x) * i / steps, last_y + (py - last_y) * i / steps);
    last_x = px;
    last_y = py;
    joined = true;
  }
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const uint8_t set =
          bits[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)];
      if (set != 0) put(x + column, y + row, kBraille + set, CellStyle::kCurve);
    }
  }
}

std::string TextCanvas::str() const {
  std::string all;
  for (int y = 0; y < height_; ++y) {
    std::string line;
    size_t end = 0;
    for (int x = 0; x < width_; ++x) {
      line += utf8(at(x, y).character);
      if (at(x, y).character != U' ') end = line.size();
    }
    all += line.substr(0, end) + "\n";
  }
  return all;
}

}  // namespace screed
