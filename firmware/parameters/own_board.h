// The board of this robot: on the microcontroller constants of the image.
#pragma once

#include "firmware/parameters/board_constants.h"
#ifdef __AVR__
#include "board.h"
#endif

namespace screed {

#ifdef __AVR__
/// As a base it takes no byte; numbers in RAM would be copied there from flash, and read by a
/// reference.
class OwnBoard {
 public:
  explicit OwnBoard(const BoardConstants& /*board*/) {}

 protected:
  static constexpr const BoardConstants& board() { return kBoard; }
};
#else
/// Here robots of many boards are in one program.
class OwnBoard {
 public:
  explicit OwnBoard(const BoardConstants& board) : board_(board) {}

 protected:
  const BoardConstants& board() const { return board_; }

 private:
  BoardConstants board_;
};
#endif

}  // namespace screed
