// A page of characters to draw on: text, boxes, bars, curves of braille dots. The terminal
// dashboard, its plain output and its tests all show the same page.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

enum class CellStyle : unsigned char { kNormal, kDim, kTitle, kGood, kWarning, kAlarm, kCurve };

struct TextCell {
  char32_t character = U' ';
  CellStyle style = CellStyle::kNormal;
};

struct CurvePoint {
  double x;
  double y;
};

struct CurveRange {
  double x_min;
  double x_max;
  double y_min;
  double y_max;
};

class TextCanvas {
 public:
  TextCanvas(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  const TextCell& at(int x, int y) const { return cells_[index(x, y)]; }

  /// Writes UTF-8; what lies outside of the page is cut. Returns the column behind the text.
  int text(int x, int y, std::string_view words, CellStyle style = CellStyle::kNormal);
  /// The same within `width` characters: what is longer ends with an ellipsis.
  int text_within(int x, int y, int width, std::string_view words,
                  CellStyle style = CellStyle::kNormal);
  /// A frame round width x height cells, its title in the upper edge. edge: kAlarm: in the title's
  /// style as well.
  void box(int x, int y, int width, int height, std::string_view title,
           CellStyle edge = CellStyle::kDim);
  /// A bar from the middle of `width` cells towards value, -1..1 (beyond: full).
  void centred_bar(int x, int y, int width, double value, CellStyle style);
  /// A curve in width x height cells, 2 x 4 dots each; neighbouring points are joined. A point
  /// outside of the range lies on its edge; a NaN is a gap.
  void curve(int x, int y, int width, int height, std::span<const CurvePoint> points,
             const CurveRange& range);

  /// The page as UTF-8 lines, without blanks at their ends.
  std::string str() const;

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  void put(int x, int y, char32_t character, CellStyle style);

  int width_;
  int height_;
  std::vector<TextCell> cells_;
};

/// Lines of at most `width` characters, broken between words; only a longer word exceeds it. At
/// least one line.
std::vector<std::string> break_lines(std::string_view text, int width);

/// UTF-8 of one character.
std::string utf8(char32_t character);
/// The characters of valid UTF-8; a byte that is none becomes '?'.
std::u32string from_utf8(std::string_view text);

}  // namespace screed
