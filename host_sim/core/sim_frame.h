// One frame of a session: what is recorded of the world and the robot at each control tick (thesis
// Table 5.1 and more).
//
// The list is a macro so that the struct, the columns of the HDF5 table and the header of the CSV
// export are one thing. All angles in rad, lengths in m, SI units throughout; the raw counts of
// sensors and outputs are recorded beside it.
#pragma once

#include <cstdint>

// clang-format off
//  type      name            unit      meaning
#define SCREED_FRAME_COLUMNS(X) \
  X(double,   time,           "s",      "simulated time at the end of the tick") \
  X(double,   x,              "m",      "chassis position, world; on the bed when it wraps around (Table 5.1)") \
  X(double,   y,              "m",      "chassis position, world (Table 5.1)") \
  X(double,   z,              "m",      "chassis position, world") \
  X(double,   delta_x,        "m",      "change of x since the previous frame, without teleports (Table 5.1)") \
  X(double,   delta_y,        "m",      "change of y since the previous frame, without teleports (Table 5.1)") \
  X(double,   delta_theta,    "rad",    "change of yaw since the previous frame (Table 5.1)") \
  X(double,   v_left,         "rad/s",  "left drive wheel, as commanded by the kinematics (Table 5.1)") \
  X(double,   v_right,        "rad/s",  "right drive wheel, as commanded by the kinematics (Table 5.1)") \
  X(double,   pitch,          "rad",    "chassis pitch, nose up positive (Table 5.1)") \
  X(double,   roll,           "rad",    "chassis roll, left side up positive (Table 5.1)") \
  X(double,   yaw,            "rad",    "chassis heading, counter-clockwise from east") \
  X(double,   linear,         "m/s",    "desired linear velocity l (Table 5.1)") \
  X(double,   angular,        "rad/s",  "desired angular velocity omega (Table 5.1)") \
  X(double,   velocity_x,     "m/s",    "chassis velocity in its own frame, forward") \
  X(double,   velocity_y,     "m/s",    "chassis velocity in its own frame, left") \
  X(double,   velocity_z,     "m/s",    "chassis velocity in its own frame, up") \
  X(double,   rate_x,         "rad/s",  "angular velocity in the chassis frame") \
  X(double,   rate_y,         "rad/s",  "angular velocity in the chassis frame") \
  X(double,   rate_z,         "rad/s",  "angular velocity in the chassis frame") \
  X(double,   track_left,     "m/s",    "speed of the left track over its wheels") \
  X(double,   track_right,    "m/s",    "speed of the right track over its wheels") \
  X(double,   slip_left,      "1",      "longitudinal slip of the left track, (track - ground) / max of both, -1..1") \
  X(double,   slip_right,     "1",      "longitudinal slip of the right track") \
  X(double,   sinkage_left,   "m", \
    "depth of the left running gear below the undisturbed soil, 0 on rigid ground") \
  X(double,   sinkage_right,  "m",      "depth of the right running gear") \
  X(double,   load_left,      "N",      "what the left running gear carries, vertically") \
  X(double,   load_right,     "N",      "what the right running gear carries") \
  X(double,   current_left,   "A",      "motor current") \
  X(double,   current_right,  "A",      "motor current") \
  X(double,   battery,        "V",      "battery terminal voltage") \
  X(double,   energy,         "J",      "energy drawn from the battery since the start") \
  X(double,   est_pitch,      "rad",    "pitch as the firmware estimates it") \
  X(double,   est_roll,       "rad",    "roll as the firmware estimates it") \
  X(double,   est_heading,    "rad",    "heading as the firmware estimates it") \
  X(double,   odometry_x,     "m",      "position as the firmware estimates it, from the start pose") \
  X(double,   odometry_y,     "m",      "position as the firmware estimates it, from the start pose") \
  X(int32_t,  state,          "",       "supervisor state (firmware/robot/supervisor.h)") \
  X(int32_t,  leveling_state, "",       "state of the leveling algorithm (firmware/leveling/leveling.h)") \
  X(int32_t,  faults,         "",       "latched fault bits (firmware/robot/supervisor.h)") \
  X(int32_t,  beds_x,         "", \
    "beds that the robot has crossed eastwards: unwrapped x is x plus this times the bed's width") \
  X(int32_t,  beds_y,         "",       "beds that the robot has crossed northwards")
// clang-format on

namespace screed {

struct SimFrame {
#define SCREED_FRAME_FIELD(type, name, unit, meaning) type name = 0;
  SCREED_FRAME_COLUMNS(SCREED_FRAME_FIELD)
#undef SCREED_FRAME_FIELD
};

}  // namespace screed
