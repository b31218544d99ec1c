// What an agent of the grid world sees and answers (thesis 4.2). It must not know the grid: neither
// its size nor its own place, nor that there are other agents.
//
// A cycle is one tick() of every agent: it receives the height of its cell and whether it has just
// come there, and answers with at most one operation on that cell and at most one step to a
// neighbour. The world carries out the operation first; a step to an occupied cell or out of the
// grid fails, and the next tick says so.
#pragma once

#include <stdint.h>

namespace screed {

/// The highest stack of a cell, units.
constexpr uint16_t kMaxStackHeight = 32767;

enum class GridOperation : uint8_t {
  kNone = 0,
  kPickUp = 1,   ///< take one unit off the cell
  kDeposit = 2,  ///< put the carried unit onto the cell
};

/// Directions are 0..7, counter-clockwise from +x (east) in steps of 45 degrees.
constexpr uint8_t kGridDirections = 8;
constexpr uint8_t kGridStay = 8;

struct GridInput {
  uint16_t height;  ///< of the cell under the agent, 0..kMaxStackHeight
  bool arrived;     ///< the last tick's step succeeded, or this is the first tick
};

struct GridAction {
  GridOperation operation;
  uint8_t direction;  ///< 0..7, or kGridStay
};

/// A probability as Q16: 0 never, 65536 always.
using Probability = uint32_t;
constexpr Probability kAlways = 65536;

}  // namespace screed
