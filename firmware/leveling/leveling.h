// The leveling algorithms of a robot: one object of each, of which the parameter `algorithm` says
// which one drives.
//
// Which ones there are stands in screed.dbc, LEVELING.algorithm; what makes a class one of them in
// behaviour.h. Nothing here names one.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "firmware/leveling/behaviour.h"
#include "firmware/leveling/escape.h"
#include "firmware/leveling/wall_search.h"
#include "firmware/parameters/algorithms_in_build.h"
#include "schema/classes.h"

namespace screed {

/// An algorithm, or what stands for one that this build leaves out.
template <class Algorithm, bool kInBuild>
class Slot : public Algorithm {
  using Algorithm::Algorithm;
};
template <class Algorithm>
class Slot<Algorithm, false> {
 public:
  explicit Slot(const Parameters& /*parameters*/) {}
  MotionCommand tick(const LevelingInput& /*input*/, Behaviour& /*behaviour*/) { return {0, 0}; }
  void take(const Parameters& /*parameters*/) {}
};

class Leveling {
 public:
  explicit Leveling(const Parameters& parameters);

  /// Builds one anew in its place. Assigned, it would be built in the main loop's stack frame
  /// first, and what lies there beyond 63 bytes costs flash wherever it is used.
  static void* operator new(size_t /*size*/, void* place) noexcept { return place; }

  /// Starts a run: the state begins anew. What an algorithm holds, the random sequence and the
  /// fence go on.
  void start() {
    behaviour_.start();
    escape_.start();
  }

  /// Live parameters (parameters.h), at any time.
  void take(const Parameters& parameters);

  /// One tick of the selected algorithm.
  MotionCommand tick(const LevelingInput& input);

  /// What it is stuck at is a wall: no failed escape.
  void met_wall() { escape_.start(); }

  LevelingAlgorithm algorithm() const { return algorithm_; }
  LevelingState state() const { return behaviour_.state(); }
  /// Climbs that ended in another motion than the return to the site or the escape. Starts at 0
  /// again after a parameter change; a climb cut off by a stop does not count.
  uint16_t peaks() const { return behaviour_.peaks(); }
  /// In this tick the robot is stuck and the escape has no attempt left.
  bool gave_up() const { return escape_.gave_up(); }
  /// In this tick it does not know where it is, and is to stop then.
  bool lost() const { return search_.gave_up(); }

 private:
  /// The way out of where it is stuck lies ahead: where it came from, if it drove backwards; beside
  /// a wall the middle of the site, for strokes carry it there whichever way it drove last.
  bool out_is_ahead(const LevelingInput& input) const;

  LevelingAlgorithm algorithm_;
  Behaviour behaviour_;
  Escape escape_;
  WallSearch search_;
#define SCREED_OBJECT(number, name, Name) Slot<Name, algorithm_in_build(number)> name##_;
  SCREED_LEVELING_ALGORITHM(SCREED_OBJECT)
#undef SCREED_OBJECT
};

}  // namespace screed
