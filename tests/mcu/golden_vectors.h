// The golden vectors: many inputs through every numeric primitive of the firmware, the results as a
// stream of bytes. The same code runs on the MCU and on the host, and the streams must agree: a
// product in a 16-bit int, a shift that depends on the compiler or a wrong constraint of inline
// assembler shows here.
#pragma once

#include <stdint.h>

#include "firmware/control/drive_control.h"
#include "firmware/control/kinematics.h"
#include "firmware/control/track_speed_control.h"
#include "firmware/estimation/attitude.h"
#include "firmware/estimation/position_estimate.h"
#include "firmware/leveling/leveling.h"
#include "firmware/math/fixed.h"
#include "firmware/math/random.h"
#include "firmware/math/sqrt.h"
#include "firmware/math/trig.h"
#include "firmware/math/units.h"
#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/protocol/slcan.h"
#include "tests/mcu/sample_wire.h"

namespace screed {

constexpr uint8_t kGoldenSections = 12;

constexpr BoardConstants kGoldenBoard = {9048, 1831, 195, 7200, 250, 145};

/// Inputs: numbers whose size varies as well, so that small and huge ones meet. One
/// number a statement: the order in which arguments are evaluated is the compiler's choice.
class GoldenNumbers {
 public:
  uint32_t any() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }
  int32_t wide() {
    const int32_t value = static_cast<int32_t>(any());
    return asr(value, static_cast<uint8_t>(any() & 31U));
  }
  int16_t narrow() { return static_cast<int16_t>(wide()); }
  int16_t within(int16_t limit) {
    const uint32_t span = static_cast<uint32_t>(limit) * 2U + 1U;
    return static_cast<int16_t>(static_cast<int32_t>(any() % span) - limit);
  }

 private:
  uint32_t state_ = 2463534242U;
};

constexpr uint8_t kExtremeCount = 16;
inline int32_t extreme(uint8_t index) {
  const int32_t one = 1;
  switch (index) {
    case 0:
      return INT32_MIN;
    case 1:
      return INT32_MIN + 1;
    case 2:
      return -(one << 30);
    case 3:
      return -65536;
    case 4:
      return -32769;
    case 5:
      return -32768;
    case 6:
      return -1;
    case 7:
      return 0;
    case 8:
      return 1;
    case 9:
      return 32767;
    case 10:
      return 32768;
    case 11:
      return 65535;
    case 12:
      return 65536;
    case 13:
      return one << 30;
    case 14:
      return INT32_MAX - 1;
    default:
      return INT32_MAX;
  }
}

template <typename Link>
void put_signed(Link& link, int32_t value) {
  put_long(link, static_cast<uint32_t>(value));
}

template <typename Link>
void golden_shifts(Link& link) {
  GoldenNumbers numbers;
  for (uint16_t i = 0; i < 300; ++i) {
    const int32_t a = i < kExtremeCount ? extreme(static_cast<uint8_t>(i)) : numbers.wide();
    const int32_t b = numbers.wide();
    const uint8_t n = static_cast<uint8_t>(numbers.any() % 31U);
    put_signed(link, asr(a, n));
    put_signed(link, asr_round(asr(a, 1), static_cast<uint8_t>(n % 29U + 1U)));
    put_signed(link, limit_i32(a, static_cast<int32_t>(abs_i16(static_cast<int16_t>(b)))));
    put_word(link, static_cast<uint16_t>(saturate_i16(a)));
    put_long(link, abs_u32(a));
    put_word(link, abs_i16(static_cast<int16_t>(a)));
    put_signed(link, add_sat_i32(a, b));
    put_signed(link, mul_i16(static_cast<int16_t>(a), static_cast<int16_t>(b)));
  }
}

template <typename Link>
void golden_scale_q16(Link& link) {
  GoldenNumbers numbers;
  for (uint8_t i = 0; i < kExtremeCount; ++i) {
    for (uint8_t j = 0; j < kExtremeCount; ++j) {
      put_signed(link, scale_q16(extreme(i), saturate_i16(extreme(j))));
    }
  }
  for (uint16_t i = 0; i < 2000; ++i) {
    const int32_t a = numbers.wide();
    put_signed(link, scale_q16(a, numbers.narrow()));
  }
}

template <typename Link>
void golden_sine(Link& link) {
  uint16_t angle = 0;
  do {
    put_word(link, static_cast<uint16_t>(sin_q15(static_cast<Angle>(angle))));
    put_word(link, static_cast<uint16_t>(cos_q15(static_cast<Angle>(angle))));
    angle = static_cast<uint16_t>(angle + 13U);
  } while (angle >= 13);
  for (uint8_t i = 0; i < kExtremeCount; ++i) {
    put_word(link, static_cast<uint16_t>(sin_q15(wrap_angle(extreme(i) / 2))));
    put_word(link, static_cast<uint16_t>(cos_q15(saturate_i16(extreme(i)))));
  }
}

template <typename Link>
void golden_atan2(Link& link) {
  GoldenNumbers numbers;
  for (uint8_t i = 0; i < kExtremeCount; ++i) {
    for (uint8_t j = 0; j < kExtremeCount; ++j) {
      put_word(link, static_cast<uint16_t>(atan2_angle(extreme(i), extreme(j))));
    }
  }
  for (uint16_t i = 0; i < 1000; ++i) {
    const int32_t y = numbers.wide();
    put_word(link, static_cast<uint16_t>(atan2_angle(y, numbers.wide())));
  }
}

template <typename Link>
void golden_sqrt(Link& link) {
  GoldenNumbers numbers;
  for (uint8_t i = 0; i < kExtremeCount; ++i) {
    put_word(link, isqrt32(static_cast<uint32_t>(extreme(i))));
  }
  for (uint16_t i = 0; i < 300; ++i) {
    const uint32_t root = numbers.any() >> 16;
    put_word(link, isqrt32(root * root - 1U));
    put_word(link, isqrt32(root * root));
    put_word(link, isqrt32(root * root + 1U));
    put_word(link, isqrt32(static_cast<uint32_t>(numbers.wide())));
  }
}

template <typename Link>
void golden_units(Link& link) {
  GoldenNumbers numbers;
  for (uint16_t i = 0; i < 500; ++i) {
    const int16_t value = i == 0   ? static_cast<int16_t>(INT16_MAX)
                          : i == 1 ? static_cast<int16_t>(INT16_MIN)
                                   : static_cast<int16_t>(numbers.any() & 0xFFFFU);
    put_word(link, static_cast<uint16_t>(angle_from_centidegrees(clamp_i16(value, -17999, 17999))));
    put_word(link, static_cast<uint16_t>(centidegrees_from_angle(value)));
    put_word(link, static_cast<uint16_t>(yaw_rate_from_degrees(clamp_i16(value, -179, 179))));
    put_word(link, ticks_from_ms(static_cast<int16_t>(value & INT16_MAX)));
    put_word(link, static_cast<uint16_t>(angle_difference(value, numbers.narrow())));
  }
  Random random(12345);
  for (uint16_t i = 0; i < 200; ++i) {
    put_word(link, static_cast<uint16_t>(random.uniform(INT16_MIN, INT16_MAX)));
    put_word(link, static_cast<uint16_t>(random.uniform(-10, 10)));
  }
}

template <typename Link>
void golden_kinematics(Link& link) {
  GoldenNumbers numbers;
  const SkidSteer kinematics(kGoldenBoard.tread_mm);
  const SkidSteer widest(300);
  for (uint16_t i = 0; i < 500; ++i) {
    const int32_t rate = i < kExtremeCount ? extreme(static_cast<uint8_t>(i)) : numbers.wide();
    const int16_t speed = i % 8U == 0 ? static_cast<int16_t>(INT16_MIN) : numbers.narrow();
    const TrackSpeeds tracks = (i % 2U == 0 ? kinematics : widest).tracks(speed, rate, 250);
    put_word(link, static_cast<uint16_t>(tracks.left));
    put_word(link, static_cast<uint16_t>(tracks.right));
  }
}

template <typename Link>
void golden_control(Link& link) {
  GoldenNumbers numbers;
  Parameters parameters;
  for (uint8_t run = 0; run < 2; ++run) {
    if (run == 1) {  // the largest gains of the parameter table
      parameters.speed_kp() = 320;
      parameters.speed_ki() = 3200;
      parameters.yaw_kp() = 1024;
      parameters.yaw_ki() = 4096;
      parameters.accel_limit() = 5000;
    }
    TrackSpeedControl track(kGoldenBoard, parameters);
    DriveControl drive(kGoldenBoard, parameters);
    for (uint16_t i = 0; i < 300; ++i) {
      const int16_t target = i % 7U == 0 ? static_cast<int16_t>(0) : numbers.within(250);
      const int16_t counts = i % 31U == 0 ? numbers.within(kMaxTrackCounts) : numbers.within(8);
      const uint16_t battery =
          static_cast<uint16_t>(i % 13U == 0 ? 0 : 6000U + (numbers.any() & 2047U));
      put_word(link, static_cast<uint16_t>(track.tick(target, counts, battery)));
      put_word(link, static_cast<uint16_t>(track.speed_dmm_per_s()));
      const DriveMeasurement measured = {counts, numbers.within(8), numbers.wide() / 2, battery};
      const DriveOutput duty = drive.tick({target, numbers.narrow()}, measured);
      put_word(link, static_cast<uint16_t>(duty.duty_left));
      put_word(link, static_cast<uint16_t>(duty.duty_right));
    }
  }
}

template <typename Link>
void golden_position(Link& link) {
  GoldenNumbers numbers;
  PositionEstimate position(kGoldenBoard.count_um_q4, 42);
  Parameters parameters;
  parameters.site_x() = 1500;
  parameters.site_y() = 1280;
  for (uint16_t i = 0; i < 500; ++i) {
    const int16_t left = numbers.within(100);
    const int16_t right = numbers.within(100);
    const Angle heading = numbers.narrow();
    position.update(left, right, heading, numbers.within(8000), static_cast<uint8_t>(i));
    bool fits = false;
    if (i % 16U == 0) fits = position.measure(kX, numbers.within(3000), 20, 9);
    if (i % 16U == 8) {
      fits = touch_wall(kGoldenBoard, parameters, heading, i % 32U == 8, position);
    }
    if (i % 128U == 100) position.measure(kY, numbers.within(2000), 30, 0);
    put_signed(link, position.mm(kX));
    put_signed(link, position.mm(kY));
    Place place;
    position.get(place);
    link.put(place.sigma[kX]);
    link.put(place.sigma[kY]);
    put_word(link, fits ? 1U : 0U);
  }
}

template <typename Link>
void golden_attitude(Link& link) {
  GoldenNumbers numbers;
  AttitudeEstimator attitude;
  ImuSample sample{};
  for (uint16_t i = 0; i < 800; ++i) {
    // Level at rest first, then turned about, at last anything the sensors can say.
    const int16_t gyro = i < 400 ? static_cast<int16_t>(4) : static_cast<int16_t>(4000);
    for (uint8_t axis = 0; axis < 3; ++axis) {
      sample.imu.gyro()[axis] = i < 700 ? numbers.within(gyro) : numbers.narrow();
      sample.imu.accel()[axis] =
          i < 700 ? numbers.within(static_cast<int16_t>(i + 20U)) : numbers.narrow();
      sample.imu.mag()[axis] = i < 700 ? numbers.within(50) : numbers.narrow();
    }
    if (i < 700) {
      sample.imu.accel()[2] = static_cast<int16_t>(sample.imu.accel()[2] + 4096);
      sample.imu.mag()[1] = static_cast<int16_t>(sample.imu.mag()[1] + 1200);
      sample.imu.mag()[2] = static_cast<int16_t>(sample.imu.mag()[2] - 2500);
    }
    sample.mag_fresh = i % 3U != 0;
    attitude.update(sample, i % 50U != 0);
    put_word(link, static_cast<uint16_t>(attitude.roll()));
    put_word(link, static_cast<uint16_t>(attitude.pitch()));
    put_word(link, static_cast<uint16_t>(attitude.heading()));
    put_signed(link, attitude.yaw_rate());
    put_signed(link, attitude.gyro_bias_mdps(static_cast<uint8_t>(i % 3U)));
  }
}

template <typename Link>
void golden_leveling(Link& link) {
  GoldenNumbers numbers;
  Parameters parameters;
  for (uint8_t run = 0; run < 6; ++run) {
    parameters.algorithm() = static_cast<int16_t>(run % 3U);
    parameters.site_radius() = run < 3 ? static_cast<int16_t>(2000) : static_cast<int16_t>(30000);
    parameters.random_seed() = static_cast<int16_t>(32767 - run);
    Leveling leveling(parameters);
    leveling.start();
    LevelingInput input = {0, 0, {{0, 0}, {0, 0}}, {0, 0}};
    for (uint16_t i = 0; i < 400; ++i) {
      if (i % 10U == 0) {
        input.pitch = numbers.within(3000);
        input.heading = numbers.narrow();
        input.place.mm[kX] = numbers.narrow();
        input.place.mm[kY] = i % 100U == 0 ? INT16_MIN : numbers.narrow();
        input.place.sigma[kX] = static_cast<uint8_t>(numbers.any());
        input.place.sigma[kY] = static_cast<uint8_t>(numbers.any() & 63U);
      }
      input.drive = {numbers.narrow(), 77};
      const MotionCommand motion = leveling.tick(input);
      put_word(link, static_cast<uint16_t>(motion.speed_mm_per_s));
      put_word(link, static_cast<uint16_t>(motion.yaw_rate));
      link.put(static_cast<uint8_t>(leveling.state()));
      put_word(link, leveling.peaks());
    }
  }
}

template <typename Link>
void golden_messages(Link& link) {
  GoldenNumbers numbers;
  SlcanParser parser;
  for (uint16_t i = 0; i < 200; ++i) {
    CanFrame frame{};
    frame.id = static_cast<uint16_t>(numbers.any() & 0x7FFU);
    frame.size = static_cast<uint8_t>(2U + numbers.any() % 7U);
    for (uint8_t& byte : frame.data) byte = static_cast<uint8_t>(numbers.any() >> 24);
    e2e_protect(frame.id, static_cast<uint8_t>(i & 0x0FU), frame.data, frame.size);
    uint8_t line[kSlcanLineMax];
    const uint8_t length = slcan_encode(frame, line);
    const uint8_t place = static_cast<uint8_t>(numbers.any() % length);
    const uint8_t wrong = static_cast<uint8_t>(numbers.any() & 0x7FU);
    if (i % 5U == 0) line[place] = wrong;
    CanFrame parsed{};
    for (uint8_t at = 0; at < length; ++at) {
      link.put(line[at]);
      if (parser.feed(line[at], parsed))
        link.put(e2e_check(parsed.id, parsed.data, parsed.size) ? 1 : 0);
    }
    uint8_t bytes[3];
    put_drive_argument(bytes, {numbers.within(2047), numbers.within(2047)});
    const DriveArgument argument = get_drive_argument(bytes);
    put_word(link, static_cast<uint16_t>(argument.speed_mm_per_s));
    put_word(link, static_cast<uint16_t>(argument.turn_ddeg_per_s));
  }
  link.put(parser.rejected());
}

/// Sends all results of one section, 0..kGoldenSections-1.
template <typename Link>
void golden_section(uint8_t section, Link& link) {
  switch (section) {
    case 0:
      return golden_shifts(link);
    case 1:
      return golden_scale_q16(link);
    case 2:
      return golden_sine(link);
    case 3:
      return golden_atan2(link);
    case 4:
      return golden_sqrt(link);
    case 5:
      return golden_units(link);
    case 6:
      return golden_kinematics(link);
    case 7:
      return golden_control(link);
    case 8:
      return golden_position(link);
    case 9:
      return golden_attitude(link);
    case 10:
      return golden_leveling(link);
    default:
      return golden_messages(link);
  }
}

}  // namespace screed
