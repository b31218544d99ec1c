// A terminal with ncurses.
#include "tools/screed/cli/terminal_screen.h"

#include <ncurses.h>
#include <unistd.h>

#include <clocale>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr short kBackground = -1;

/// Colour pairs are numbered as the styles.
attr_t attribute(CellStyle style) {
  const auto pair = static_cast<attr_t>(COLOR_PAIR(static_cast<int>(style)));
  switch (style) {
    case CellStyle::kNormal:
      return A_NORMAL;
    case CellStyle::kDim:
      return A_DIM;
    case CellStyle::kTitle:
      return A_BOLD;
    case CellStyle::kAlarm:
      return pair | A_BOLD;
    default:
      return pair;
  }
}

}  // namespace

TerminalScreen::TerminalScreen() {
  // Numbers keep their point; only characters follow the user's locale, or UTF-8 where it has none.
  std::setlocale(LC_CTYPE, "");
  if (MB_CUR_MAX == 1) std::setlocale(LC_CTYPE, "C.UTF-8");
  if (isatty(STDOUT_FILENO) == 0 || newterm(nullptr, stdout, stdin) == nullptr)
    throw InputError("no terminal to draw on (TERM); use --plain");
  start_color();
  use_default_colors();
  init_pair(static_cast<short>(CellStyle::kGood), COLOR_GREEN, kBackground);
  init_pair(static_cast<short>(CellStyle::kWarning), COLOR_YELLOW, kBackground);
  init_pair(static_cast<short>(CellStyle::kAlarm), COLOR_RED, kBackground);
  init_pair(static_cast<short>(CellStyle::kCurve), COLOR_CYAN, kBackground);
  cbreak();
  noecho();
  curs_set(0);
  keypad(stdscr, TRUE);
  nodelay(stdscr, TRUE);
}

TerminalScreen::~TerminalScreen() {
  endwin();
}

TextCanvas TerminalScreen::page() const {
  return TextCanvas(getmaxx(stdscr), getmaxy(stdscr));
}

void TerminalScreen::show(const TextCanvas& page) {
  erase();
  for (int y = 0; y < page.height(); ++y) {
    for (int x = 0; x < page.width(); ++x) {
      const TextCell& cell = page.at(x, y);
      if (cell.character == U' ') continue;
      attrset(static_cast<int>(attribute(cell.style)));
      mvaddstr(y, x, utf8(cell.character).c_str());
    }
  }
  refresh();
}

std::optional<int> TerminalScreen::key() {
  const int pressed = getch();
  switch (pressed) {
    case ERR:
      return std::nullopt;
    case KEY_UP:
      return kTerminalUp;
    case KEY_DOWN:
      return kTerminalDown;
    case KEY_LEFT:
      return kTerminalLeft;
    case KEY_RIGHT:
      return kTerminalRight;
    case KEY_BACKSPACE:
    case '\b':
    case 127:
      return kTerminalBackspace;
    default:
      return pressed;
  }
}

}  // namespace screed
