// Seeds and keys of the robots in a world.
#include "host_sim/run/world/robot_number.h"

#include <string>

#include "host_sim/core/random.h"

namespace screed {

uint64_t seed_of_robot(uint64_t seed, size_t number) {
  if (number == 0) return seed;
  WorldRandom random(seed, "robot " + std::to_string(number));
  const uint64_t high = random.next();
  return high << 32U | random.next();
}

Parameters parameters_of_robot(const Parameters& parameters, size_t number) {
  // Far from the seeds that a user counts up; no two robots of a world get the same.
  constexpr uint64_t kStride = 1009;
  constexpr uint64_t kSeeds = 32768;
  Parameters own = parameters;
  own.random_seed() = static_cast<int16_t>(
      (static_cast<uint64_t>(parameters.random_seed()) + kStride * number) % kSeeds);
  return own;
}

CommandKey key_of_robot(const CommandKey& key, size_t number) {
  CommandKey own = key;
  own.robot_id = static_cast<uint8_t>(key.robot_id + number);
  return own;
}

Credentials credentials_of_robot(const Credentials& credentials, size_t number) {
  Credentials own = credentials;
  own.robot_id = static_cast<uint8_t>(credentials.robot_id + number);
  return own;
}

}  // namespace screed
