#include "tools/screed/cli/key_table.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace screed {
namespace {

constexpr std::size_t kColumns = 5;
constexpr std::size_t kGap = 2;
using Cells = std::array<std::string, kColumns>;

/// Words in lines of at most so many letters; a longer word has a line of its own.
std::vector<std::string> lines_of(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > width)
      lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

std::vector<Cells> cells_of(const std::string& rows) {
  std::vector<Cells> all = {{"key", "unit", "default", "range", "meaning"}};
  std::istringstream stream(rows);
  for (std::string line; std::getline(stream, line);) {
    Cells& cells = all.emplace_back();
    std::size_t at = 2;  // behind "| "
    for (std::string& cell : cells) {
      const std::size_t end = line.find(" | ", at);
      cell = line.substr(at, std::min(end, line.size() - 2) - at);
      at = std::min(end, line.size() - 3) + 3;
    }
  }
  return all;
}

}  // namespace

std::string aligned_key_table(const std::string& rows, std::size_t width) {
  constexpr Cells::size_type kRange = 3;
  constexpr std::size_t kWidestRange = 34;
  constexpr std::size_t kNarrowestMeaning = 24;
  const std::vector<Cells> table = cells_of(rows);
  std::array<std::size_t, kColumns> widths{};
  std::size_t others = 0;
  for (std::size_t i = 0; i + 1 < kColumns; ++i) {
    for (const Cells& cells : table) widths[i] = std::max(widths[i], cells[i].size());
    if (i == kRange) widths[i] = std::min(widths[i], kWidestRange);
    others += widths[i] + kGap;
  }
  widths.back() = std::max(kNarrowestMeaning, width > others ? width - others : 0);

  std::string text;
  for (const Cells& cells : table) {
    std::array<std::vector<std::string>, kColumns> lines;
    std::size_t height = 1;
    for (std::size_t i = 0; i < kColumns; ++i) {
      lines[i] = lines_of(cells[i], widths[i]);
      height = std::max(height, lines[i].size());
    }
    for (std::size_t row = 0; row < height; ++row) {
      std::string line;
      std::size_t column = 0;
      for (std::size_t i = 0; i < kColumns; ++i) {
        line.resize(std::max(line.size(), column), ' ');
        if (row < lines[i].size()) line += lines[i][row];
        column += widths[i] + kGap;
      }
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
  }
  return text;
}

void print_key_table(const std::string& rows) {
  if (isatty(STDOUT_FILENO) == 0) {
    std::cout << "| key | unit | default | allowed | meaning |\n| --- | --- | --- | --- | --- |\n"
              << rows;
    return;
  }
  constexpr std::size_t kUsualWidth = 100;
  winsize size{};
  const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  std::cout << aligned_key_table(rows, known ? size.ws_col : kUsualWidth);
}

}  // namespace screed
