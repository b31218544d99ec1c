// Attitude estimator: gyroscope, accelerometer and magnetometer counts in, orientation out, in
// integers. Knows nothing of robots, buses or time: one call of update() is one control tick of 10
// ms.
//
// Structure after VQF (D. Laidig, T. Seel, "VQF: Highly accurate IMU orientation estimation with
// bias estimation and magnetic disturbance rejection", Information Fusion 91, 2023;
// arXiv:2203.17024): the gyroscope is integrated strap-down, the acceleration is turned into that
// almost inertial frame and low-pass filtered THERE, where what a vehicle does averages out and
// gravity stays. docs/studies/attitude.md has the formulas and figures.
#pragma once

#include <stdint.h>

#include "firmware/math/quaternion.h"
#include "firmware/math/trig.h"
#include "hal/sample.h"

namespace screed {

/// One sample of the inertial sensors. Clipped counts of the accelerometer are taken as they are;
/// the magnetometer's are without hard iron, and of any scale: only the direction is used.
struct ImuSample {
  ImuCounts imu;
  bool mag_fresh;  ///< new since the last call; when false the magnetometer is not looked at
};

/// The orientation as three angles.
struct AttitudeAngles {
  Angle roll;   ///< > 0: left side up
  Angle pitch;  ///< > 0: nose up, -16384..16384
  /// counter-clockwise from east, seen from above; from the start pose without magnetometer
  Angle heading;
  int16_t sin_pitch_q14;
  int16_t cos_tilt_q14;  ///< of the inclination, whichever way
};

class AttitudeEstimator {
 public:
  AttitudeEstimator() { reset(); }

  /// Forgets everything, the gyroscope bias as well.
  SCREED_OUT_OF_LINE void reset();

  /// Advances by one tick. `may_be_at_rest` = false forbids to take this sample for standstill: a
  /// caller that drives or sees its wheels turn says so, else a slow even turn (its rate steady
  /// within 2 degrees/s) is learned as bias.
  SCREED_OUT_OF_LINE void update(const ImuSample& sample, bool may_be_at_rest = true);

  /// Sensor to earth (ENU, y to magnetic north), Q30, length 1 within 2e-4. Identity before the
  /// first usable sample.
  const Quaternion& orientation() const { return state_.orientation; }

  /// Roll, pitch and heading at once: three arc tangents, so once a tick is enough.
  AttitudeAngles angles() const;
  Angle roll() const { return angles().roll; }
  Angle pitch() const { return angles().pitch; }
  Angle heading() const { return angles().heading; }

  /// Turn rate about the earth's vertical, bias removed, 65536 units = one turn a second; > 0
  /// counter-clockwise.
  int32_t yaw_rate() const { return state_.yaw_rate; }

  /// Gravity has been averaged for 3 s: roll and pitch can be relied on. The first standstill found
  /// starts this again, since the bias may have spoilt what was before: at rest from the start on,
  /// it is true after 4.5 s.
  bool ready() const { return state_.ticks == kStartTicks; }

  /// It was ready once: roll and pitch are those of the gyro, and of what was averaged before, also
  /// while the average is taken anew. A lost attitude begins again with that of the accelerometer.
  bool known() const { return state_.known; }

  static constexpr uint16_t kStartTicks = 300;  ///< 3 s, the time constant of the gravity filter
  static constexpr uint8_t kRestTicks = 150;    ///< 1.5 s, until a standstill is found

  /// The magnetometer has set the heading.
  bool heading_ready() const { return state_.mag_samples != 0; }

  /// The magnetic field differs from what it was, so the heading follows the gyroscope alone.
  bool mag_disturbed() const { return state_.mag_distrusted > kMagHitchTicks; }

  /// Standard deviation of the heading by its age, 0.5 degrees: 2 degrees while the magnetometer is
  /// trusted, then 0.5 more in 20 s; 255 before the magnetometer has set it.
  uint8_t heading_sigma() const;

  static constexpr uint8_t kMagHitchTicks = 20;  ///< without a sample to trust: no disturbance yet

  /// Standstill is detected: the bias is being taken from the gyroscope's mean.
  bool at_rest() const { return state_.rest_ticks == kRestTicks; }

  /// Estimated gyroscope bias of an axis (0 x, 1 y, 2 z) in millidegrees a second, within +-30,000.
  int32_t gyro_bias_mdps(uint8_t axis) const;

 private:
  /// What the estimator remembers, all of it zero after a reset but the orientation. By itself so
  /// that it is forgotten at once: member by member that takes 100 bytes of flash more.
  struct State {
    Quaternion orientation;
    int32_t gravity[3];  // filtered acceleration in the earth frame, counts, 14 binary digits
    int32_t slope[3];    // change of gravity a tick, counts, 22 binary digits
    // What is read one by one: the AVR reaches 63 bytes far from a pointer.
    uint16_t ticks;           // since the alignment, stops at kStartTicks; 0: not aligned yet
    uint16_t mag_samples;     // taken in, stops at kHeadingStartSamples
    uint8_t mag_age;          // ticks since the last magnetometer sample
    uint8_t rest_ticks;       // stops at kRestTicks
    uint8_t bias_samples;     // taken at rest, stops at kBiasTicks
    bool known;               // gravity has been averaged once
    uint16_t mag_distrusted;  // ticks since the magnetometer was last trusted, stops at its end
    int32_t yaw_rate;
    int16_t field[2];  // the site's magnetic field: strength and vertical part, 4 counts
    // What loops read.
    int32_t bias[3];  // half angle in radians a tick, 33 binary digits
    int32_t mean[6];  // short means for the rest detection, counts, 14 binary digits: gyro, then
                      // accelerometer
    // Rotation of this tick, half angle, 33 binary digits; the lower half, which rounding to 17
    // takes, is carried into the next tick.
    int32_t exact[3];
    int16_t half_angle[3];  // rotation of this tick, half angle in radians, 17 binary digits
  };

  bool align(const int16_t (&accel)[3]);
  void detect_rest(const ImuSample& sample, bool may_be_at_rest);
  void forget_slope();
  void learn_bias_at_rest();
  void learn_bias_in_motion(const RotationMatrix& to_earth, const SmallQuaternion& correction);
  void integrate(const int16_t (&gyro)[3]);
  void filter_gravity(const RotationMatrix& to_earth, const int16_t (&accel)[3]);
  bool trust(const RotationMatrix& to_earth, const int16_t (&mag)[3]);
  int16_t heading_correction(const RotationMatrix& to_earth, const int16_t (&mag)[3]);
  void correct(const SmallQuaternion& correction);

  State state_;
};

}  // namespace screed
