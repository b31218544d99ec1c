// Says how far the tracks move the robot: slip, stuck and the share of travel, from what it has on
// board.
//
// A recurrent network (nn/models/slip.json, in nn/infer's integers) is asked 25 times a second
// whether the robot hardly moves, and what share of the belts' travel the chassis makes. Its inputs
// are how far the belts' speed departs from what the accelerometer measured since the tracks stood
// (over 0.6, 2.6 and 10 s, since more would be drift), the turn that the gyro measures and the
// difference of the tracks that ought to make one, the belts' speed, the slope, what the motors
// need beyond idling (a robot that hangs needs little), how much the chassis vibrates (one that
// stands does not) and how it pitches (one that digs itself in does so slowly). The network's
// memory holds how all this was before. A step takes two calls, so that no tick has all of it.
// docs/studies/networks.md has figures, `screed nn stuck` measures them.
#pragma once

#include <stdint.h>

#include "firmware/control/kinematics.h"
#include "firmware/math/fixed.h"

namespace screed {

constexpr uint8_t kSlipInputs = 12;
constexpr uint8_t kSlipUnits = 10;
constexpr uint8_t kSlipOutputs = 2;  // held: log of the odds; share of travel

/// The mean of the network's output "held" (log of the odds, Q12) after one step more, 0..65535 for
/// -8..8: over four steps, 0.16 s. Halves, so that a difference fits 16 bits.
SCREED_CONSTEXPR14 uint16_t slip_evidence(uint16_t evidence, int16_t held) {
  const auto half_held = static_cast<int16_t>(asr_i16(held, 1) + 16384);
  return static_cast<uint16_t>(
      evidence + asr_i16(static_cast<int16_t>(half_held - static_cast<int16_t>(evidence >> 1)), 1));
}

class SlipWatch {
 public:
  // 126 = 40 pi = 10 (0.1 mm) x 4 (quartered rate) x pi (B/2 x 2 pi / 65536, Q16)
  explicit SlipWatch(uint16_t tread_mm) : arc_q16_(static_cast<uint16_t>(tread_mm * 126U)) {}

  /// One tick. gyro, accel: the three counts (70 mdps, 0.244 mg) as they come; sin_pitch_q14 > 0:
  /// nose up; yaw_rate: angle units/s. Half a step of the network is made when `classify_now` is
  /// set, in every second tick: those in which no command's MAC is checked, so that the longest
  /// tick stays as long as it is. A robot whose tracks stand is not stuck, and the network forgets.
  SCREED_OUT_OF_LINE void tick(const TrackMotion& left, const TrackMotion& right,
                               const int16_t* gyro, const int16_t* accel, int16_t sin_pitch_q14,
                               int32_t yaw_rate, bool classify_now);

  /// In place of tick(): the tracks slip on purpose. It forgets all but what it knows of the
  /// sensors, and says that nothing is stuck and that the travel moves the robot nowhere.
  void pass_over(const TrackMotion& left, const TrackMotion& right);

  /// The tracks move much more than the robot.
  bool slips() const;
  /// They have done so for long: the robot is dug in or hangs. Until it moves or the tracks stop.
  bool stuck() const { return state_.stuck; }

  /// Share of the belts' mean travel that the chassis makes, over about the last half second, 255:
  /// all of it, which is also said where nothing is known, with tracks at rest.
  uint8_t travel_share() const { return state_.travel_share; }

  /// The robot has driven against something hard within the last 2.5 s: it lost half of its speed
  /// within a few ticks. Digging in takes longer.
  bool collided() const { return state_.collision_ticks != 0; }
  static constexpr uint8_t kCollisionTicks = 250;

  // For training and tests.
  const int8_t* network_inputs() const { return state_.values; }
  uint16_t evidence() const { return state_.evidence; }
  bool half_done() const { return state_.half_done; }  ///< of a step of the network

  static constexpr int16_t kMinTrackSpeed_dmm_per_s = 350;  ///< below, slip is not observable
  static constexpr int16_t kStanding_dmm_per_s = 100;       ///< below, the tracks stand

 private:
  /// Vibration of an axis, its mean removed.
  struct Vibration {
    int32_t mean;        // 64 times the mean over 0.64 s
    int16_t band_pass;   // 4 times what differs from the mean, smoothed over 4 ticks
    uint16_t magnitude;  // 16 times the mean of its absolute value over 0.16 s
  };
  /// What is forgotten while the tracks stand.
  struct Memory {
    int32_t velocity_loss[3];    // belts' speed minus that by inertia; about 0.05 mm/s
    int16_t states[kSlipUnits];  // of the network
  };
  struct State {
    int32_t mean;  // of what enters velocity_loss when nothing slips: bias, error of the pitch; Q9
    int16_t lost;  // speed lost in a few ticks, in the same unit
    uint8_t collision_ticks;  // left until a collision is long ago
    uint16_t faster_track;    // track's speed, 0.1 mm/s
    int16_t yaw_rate;         // smoothed, a quarter
    int16_t effort;           // smoothed over 8 ticks, Q3 duty
    int16_t half_speed;       // of the belts in the tick before, half of 0.1 mm/s
    uint16_t evidence;        // mean of the output "held", 0..65535
    Vibration vibration[3];   // pitch rate, specific force ahead, up
    bool stuck;
    bool half_done;  // of a step of the network
    uint8_t travel_share;
    // Inputs of the network, then the bytes of its states. Signs are for driving ahead; "share" is
    // over the faster track's speed. What exceeds a byte is limited.
    //   0-2   belts' speed minus inertial speed, over 0.6, 2.6 and 10 s, share, Q7
    //   3     |yaw rate| as speed of a track, share, Q7
    //   4     half the difference of the tracks, share, Q7
    //   5     faster track, 3.2 mm/s
    //   6     sine of the pitch, Q8
    //   7     effort of both tracks, 1 duty
    //   8-10  vibration of pitch rate, force ahead, force up: 32 log2 of it, 0 at 16 counts
    //   11    mean pitch rate, counts
    int8_t values[kSlipInputs + kSlipUnits];
    Memory memory;
    int16_t candidates[kSlipUnits];
  };

  static void update_vibration(Vibration& vibration, int16_t counts);
  void feel_collision(int16_t residual);
  void set_inputs(int16_t half_left, int16_t half_right, int16_t sin_pitch_q14);
  void conclude();
  void forget();

  uint16_t arc_q16_;  ///< 0.1 mm/s at the track per four units of yaw rate
  State state_{};
};

}  // namespace screed
