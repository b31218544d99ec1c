// Every number a user may tune, in one table: name, unit, range, default, meaning.
//
// The table is a macro so that numbers, accessors, defaults, range check and the host's listing
// (names, documentation, experiment files) are made from the same lines and cannot drift apart.
// Text stays out of the MCU image: parameters.cpp has the table of parameters.h on hosts
// alone.
#pragma once

#include <stdint.h>

/// Default of the parameter standalone, for robots that run without a ground station: make firmware
/// STANDALONE=yes.
#ifndef SCREED_STANDALONE
#define SCREED_STANDALONE 0
#endif

// clang-format off
//  name                    unit         min    max  default  meaning
#define SCREED_PARAMETERS(X) \
  X(algorithm,              "",            0, kMaxAlgorithm, kDefaultAlgorithm, \
    "leveling algorithm" SCREED_LEVELING_ALGORITHM(SCREED_ALGORITHM_TEXT)) \
  X(random_seed,            "",            0, 32767,      1, "seed of the random walk and of the training drive") \
  X(training_block,         "tick",        1, 32767,   2000, \
    "training drive: length of each of the eight blocks of Algorithm 5") \
  X(climb_threshold,        "0.01 deg",  100,  4500,    500, \
    "pitch above which a hill is being climbed (epsilon of Algorithm 6)") \
  X(climb_hysteresis,       "0.01 deg",    0,  1000,    100, \
    "pitch must fall this far below the threshold before the climb counts as over") \
  X(climb_speed,            "mm/s",       20,   250,    200, "speed while climbing (v_climb of Algorithm 6)") \
  X(walk_speed_min,         "mm/s",        0,   250,     60, "random walk, slowest leg") \
  X(walk_speed_max,         "mm/s",        0,   250,    160, "random walk, fastest leg") \
  X(walk_yaw_rate_max,      "deg/s",       0,   120,     40, "random walk, greatest turn rate either way") \
  X(walk_leg_min,           "ms",        100, 20000,   1000, "random walk, shortest leg") \
  X(walk_leg_max,           "ms",        100, 20000,   4000, "random walk, longest leg") \
  X(spin_rate,              "deg/s",      10,   120,     90, "turn rate on the peak") \
  X(spin_time,              "ms",        100, 30000,   4000, "how long to spin on a peak") \
  X(site_radius,            "mm",          0, 30000,      0, \
    "leave the random walk and turn back outside this circle around the start; 0: no limit") \
  X(site_x,                 "mm",          0, 15000,      0, \
    "walls of the site: as far east and west of the origin; 0: none") \
  X(site_y,                 "mm",          0, 15000,      0, \
    "walls of the site: as far north and south of the origin; 0: none") \
  X(position_noise,         "125 mm^2/m",    0,  1000,    152, \
    "variance of the position that a metre of travel makes which is lost by slip; a 32nd of the travel always is") \
  X(site_heading,           "0.01 deg", -17999, 17999,   0, \
    "the site's x axis, counter-clockwise from magnetic east: all headings count from it") \
  X(lost_sigma,             "mm",          0,   700,      0, \
    "the robot is lost when the standard deviation of its position exceeds this; 0: never") \
  X(lost_action,            "",            0,     1,      0, \
    "what a lost robot does: 0 stop with the fault lost, 1 seek a wall of the site") \
  X(fix_sigma,              "mm",          8,  1000,     30, \
    "standard deviation of position fixes from the ground station") \
  X(speed_kp,               "1/16 duty per mm/s",  0, 320,  24, "wheel speed: proportional gain") \
  X(speed_ki,               "1/16 duty per mm",    0, 3200, 160, "wheel speed: integral gain") \
  X(accel_limit,            "mm/s^2",     50,  5000,    600, "greatest change of a track's commanded speed") \
  X(yaw_kp,                 "1/256",       0,  1024,      0, "yaw rate: proportional gain") \
  X(yaw_ki,                 "1/256 per s", 0,  4096,    768, "yaw: gain on the heading lost, the rate's integral") \
  X(tilt_limit,             "0.01 deg",  100,  9000,   5000, \
    "inclination at which the robot stops and latches a fault") \
  X(battery_low,            "mV",          0, 12000,   6000, "stop below this voltage; 0: never") \
  X(stall_time,             "ms",         50,  5000,    150, \
    "a track at high duty that does not move for this long is stalled") \
  X(gyro_offset_x,          "0.07 deg/s", -1000,  1000,      0, "what the gyro says at rest (screed calibrate)") \
  X(gyro_offset_y,          "0.07 deg/s", -1000,  1000,      0, "likewise") \
  X(gyro_offset_z,          "0.07 deg/s", -1000,  1000,      0, "likewise") \
  X(accel_offset_x,         "0.244 mg", -1000,  1000,      0, "offset of the accelerometer (screed calibrate)") \
  X(accel_offset_y,         "0.244 mg", -1000,  1000,      0, "likewise") \
  X(accel_offset_z,         "0.244 mg", -1000,  1000,      0, "likewise") \
  X(mag_offset_x,           "0.16 mG",  -8000,  8000,      0, "hard iron round the magnetometer (screed calibrate)") \
  X(mag_offset_y,           "0.16 mG",  -8000,  8000,      0, "likewise") \
  X(mag_offset_z,           "0.16 mG",  -8000,  8000,      0, "likewise") \
  X(standalone,             "",            0,     1, SCREED_STANDALONE, \
    "1: arm and run after power-up without a ground station") \
  X(standalone_delay,       "ms",          0, 30000,   3000, \
    "stand-alone: time between power-up and the start of the run") \
  X(stuck_time,             "ms",          0, 30000,      0, \
    "stop with a fault when dug in or hung up for this long; 0: no limit") \
  X(climb_turn,             "1/s",         0,     4,      0, \
    "while climbing, turn towards the steepest ascent at this rate per angle to it; 0: straight on") \
  X(coverage_half_side,     "mm",        100, 30000,    500, \
    "coverage: half the side of the square round the start; within 0.7 of site_radius") \
  X(coverage_spacing,       "mm",         50,  2000,    200, "coverage: distance between two lines") \
  X(escape_attempts,        "",            0,    20,      6, \
    "a robot that is stuck tries this often to get out, then stops with the fault stuck; 0: no escape") \
  X(stroke_down,            "ms",         20,  1000,    180, "strokes: time of the easy way") \
  X(stroke_up,              "ms",         20,  1000,    200, \
    "strokes: time of the hard way, on which the tracks slip and carry ground back") \
  X(stroke_ease,            "0.1 m/s^2",   1,   500,     30, \
    "strokes: change of the commanded speed into the easy way; into the hard way it is at once, as 500 is") \
  X(stroke_time,            "ms",        100, 30000,  16000, "strokes: longest work at one place")

/// Those that a robot also takes while it is armed or runs: gains and thresholds that count from the
/// next tick on, of the walk from its next leg. All others shape what is under way.
#define SCREED_LIVE_PARAMETERS(X) \
  X(climb_threshold) X(climb_hysteresis) X(climb_speed) X(climb_turn) \
  X(walk_speed_min) X(walk_speed_max) X(walk_yaw_rate_max) X(walk_leg_min) X(walk_leg_max) \
  X(lost_sigma) X(lost_action) X(fix_sigma) \
  X(speed_kp) X(speed_ki) X(accel_limit) X(yaw_kp) X(yaw_ki) \
  X(tilt_limit) X(battery_low) X(stall_time) X(stuck_time)
// clang-format on

namespace screed {

/// hill_sensing, Algorithm 6, unless make firmware LEVELING=NAME says another. Which algorithms a
/// build has, and so the greatest value, only what uses that part of the table needs to know: it
/// includes algorithms_in_build.h.
#ifdef SCREED_DEFAULT_ALGORITHM
constexpr int16_t kDefaultAlgorithm = SCREED_DEFAULT_ALGORITHM;
#else
constexpr int16_t kDefaultAlgorithm = 1;
#endif

struct Parameters {
  /// A parameter's row in the table, from 0, as it goes by radio and into the EEPROM.
  enum Number : uint8_t {
#define SCREED_NUMBER(name, unit, min, max, value, meaning) k_##name,
    SCREED_PARAMETERS(SCREED_NUMBER)
#undef SCREED_NUMBER
        kEnd
  };
  static constexpr uint8_t kCount = kEnd;

  /// By their numbers.
  int16_t values[kCount] = {
#define SCREED_DEFAULT(name, unit, min, max, value, meaning) (value),
      SCREED_PARAMETERS(SCREED_DEFAULT)
#undef SCREED_DEFAULT
  };
#define SCREED_ACCESSOR(name, unit, min, max, value, meaning) \
  int16_t name() const {                                      \
    return values[k_##name];                                  \
  }                                                           \
  int16_t& name() {                                           \
    return values[k_##name];                                  \
  }
  SCREED_PARAMETERS(SCREED_ACCESSOR)
#undef SCREED_ACCESSOR

  /// True when every value lies in its range; a robot with any other parameters refuses to arm.
  bool valid() const;
};

/// Whether a robot takes the parameter of this number while it is armed or runs.
bool changes_while_running(uint8_t number);

// The parameter table as text, for hosts: names, units, ranges and meanings for experiment files
// and listings. Not for the MCU image, which has no room for the strings.

struct ParameterInfo {
  uint8_t number;
  const char* name;
  const char* unit;
  int16_t min;
  int16_t max;
  int16_t default_value;
  const char* meaning;
};

/// By their numbers. Defined in parameters.cpp, so that texts and ranges, which grow with the
/// algorithms, are compiled once.
extern const ParameterInfo kParameterTable[Parameters::kCount];

}  // namespace screed
