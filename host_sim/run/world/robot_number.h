// What tells the robots of a world apart: each one's seeds and key. Number 0 is what the experiment
// says, so that a robot is the same alone as in company.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/parameters/parameters.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

/// Of its sensors, radio and ground station.
uint64_t seed_of_robot(uint64_t seed, size_t number);
/// Its random walk is another one.
Parameters parameters_of_robot(const Parameters& parameters, size_t number);
/// The same key under another id: no robot takes a command for another one.
CommandKey key_of_robot(const CommandKey& key, size_t number);
Credentials credentials_of_robot(const Credentials& credentials, size_t number);

}  // namespace screed
