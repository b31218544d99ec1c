// A terminal that shows pages and gives keys; ncurses behind it.
#pragma once

#include <optional>

#include "host_sim/ground_station/link/text_canvas.h"

namespace screed {

/// The key that stops a robot at once, the same in every program that has keys: the largest one.
inline constexpr int kEmergencyStopKey = ' ';
inline constexpr const char* kEmergencyStopKeyName = "SPACE";

/// Keys that are no characters.
enum TerminalKey : int {
  kTerminalUp = 0x110000,
  kTerminalDown,
  kTerminalLeft,
  kTerminalRight,
  kTerminalBackspace
};

class TerminalScreen {
 public:
  /// Takes the terminal over until destroyed. Throws InputError when there is none.
  TerminalScreen();
  TerminalScreen(const TerminalScreen&) = delete;
  TerminalScreen& operator=(const TerminalScreen&) = delete;
  ~TerminalScreen();

  /// An empty page of the terminal's present size.
  TextCanvas page() const;
  void show(const TextCanvas& page);
  /// The next key pressed, a character or a TerminalKey; never waits. A terminal says nothing of
  /// keys that are let go: one that is held down comes again and again.
  std::optional<int> key();
};

}  // namespace screed
