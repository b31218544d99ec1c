// What tells the robots of a world apart: each one's seeds and key. Number 0 is what the experiment
// says, so that a robot is the same alone as in company.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/vehicle_sections.h"

namespace screed {

/// Of its sensors, radio and ground station.
uint64_t seed_of_robot(uint64_t seed, size_t number);
/// Its random walk is another one.
Parameters parameters_of_robot(const Parameters& parameters, size_t number);
/// The same key under another id: no robot takes a command for another one.
CommandKey key_of_robot(const CommandKey& key, size_t number);
Credentials credentials_of_robot(const Credentials& credentials, size_t number);

// Where the robots of an experiment start.

/// A place for each robot, in their order; of a single robot that of [vehicle]. Of a grid the
/// first row is the southern one; on a ring the robots look outwards, turned by [vehicle] h.
/// Throws InputError when random places do not fit on the bed.
std::vector<RobotPlace> robot_places(const Experiment& experiment, const HeightField& terrain);

// Places that robots do not get out of, cut into the terrain of an experiment ([trap]).

/// Changes the terrain as the experiment's trap asks. Widths are the Rover 5's. A wall, slope or
/// trench lies all round the start, so that a robot that turns or walks at random meets it too.
/// Heights that pass the field's range are cut.
void set_trap(const Experiment& experiment, HeightField& field);

}  // namespace screed
