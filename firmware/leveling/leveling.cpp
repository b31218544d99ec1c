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

/// So near a wall its tracks or its hull may stand against it.
constexpr int16_t kByWall_mm = 200;

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

bool Leveling::out_is_ahead(const LevelingInput& input) const {
  int16_t place[2] = {input.place.mm[kX], input.place.mm[kY]};
  const int16_t* wall = search_.walls();
  for (const int16_t mm : place) {
    if (*wall != 0 && static_cast<int16_t>(abs_i16(mm)) >= *wall - kByWall_mm) {
      turn_vector_back(place, input.heading);
      return place[0] < 0;
    }
    ++wall;
  }
  return input.backwards;
}

MotionCommand Leveling::tick(const LevelingInput& input) {
  if (keeps_to_site(algorithm_)) {
    if (escape_.tick(input.stuck, out_is_ahead(input), behaviour_.outside())) {
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
