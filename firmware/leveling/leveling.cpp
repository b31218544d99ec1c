// Which algorithm drives.
#include "firmware/leveling/leveling.h"

namespace screed {
namespace {

bool keeps_to_site(LevelingAlgorithm algorithm) {
#define SCREED_KEEPS_TO_SITE(number, name, Name) \
  if (algorithm == LevelingAlgorithm::k##Name) return Name::kKeepsToSite;
  SCREED_LEVELING_ALGORITHM(SCREED_KEEPS_TO_SITE)
#undef SCREED_KEEPS_TO_SITE
  return false;
}

}  // namespace

Leveling::Leveling(const Parameters& parameters)
    : algorithm_(static_cast<LevelingAlgorithm>(parameters.algorithm())),
      behaviour_(parameters),
      escape_(parameters),
      search_(parameters)
#define SCREED_CONSTRUCT(number, name, Name) , name##_(parameters)
          SCREED_LEVELING_ALGORITHM(SCREED_CONSTRUCT)
#undef SCREED_CONSTRUCT
{
}

void Leveling::take(const Parameters& parameters) {
  behaviour_.take(parameters);
  search_.take(parameters);
#define SCREED_TAKE(number, name, Name) name##_.take(parameters);
  SCREED_LEVELING_ALGORITHM(SCREED_TAKE)
#undef SCREED_TAKE
}

MotionCommand Leveling::tick(const LevelingInput& input) {
  if (keeps_to_site(algorithm_)) {
    if (escape_.tick(input.stuck, input.backwards, behaviour_.outside())) {
      return behaviour_.enter_or_stay(LevelingState::kEscape, escape_.motion());
    }
    if (search_.update(input.place)) {
      return behaviour_.enter_or_stay(
          LevelingState::kSeekWall,
          behaviour_.steer(search_.east(), search_.north(), input.heading));
    }
    MotionCommand motion;
    if (behaviour_.return_to_site(input, motion)) return motion;
  }
  switch (algorithm_) {
#define SCREED_TICK(number, name, Name) \
  case LevelingAlgorithm::k##Name:      \
    return name##_.tick(input, behaviour_);
    SCREED_LEVELING_ALGORITHM(SCREED_TICK)
#undef SCREED_TICK
  }
  return {0, 0};
}

}  // namespace screed
