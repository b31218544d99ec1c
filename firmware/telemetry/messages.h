// The frames that travel between robot and ground: ids, sizes, and where each value stands.
//
// id = class[10:8] | node[7:4] | index[3:0]; node 0 is the ground, 1 the robot. Every frame starts
// with the two bytes of e2e.h; bits 12..15 carry four bits of the message. All numbers are little
// endian.
#pragma once

#include <stdint.h>

#include "firmware/telemetry/slcan.h"

namespace screed {

enum MessageId : uint16_t {
  kIdGroundHeartbeat = 0x000,  ///< up:   time u32 ms
  kIdEmergencyStop = 0x001,    ///< up:   reason u8
  kIdHeartbeat =
      0x010,  ///< state in the header bits; faults u16, link alive u8 (0, 1), rejected lines u8
  kIdCommand = 0x110,     ///< up:   op u8, argument 24 bits
  kIdCommandAck = 0x111,  ///< op u8, result u8
  kIdAttitude = 0x210,    ///< roll s16, pitch s16, heading u16, 0.01 degree
  kIdLeveling = 0x211,  ///< state in the header bits; algorithm u8, peaks u8, speed s16 mm/s, turn
                        ///< s16 0.01 degree/s
  kIdEncoders = 0x212,  ///< left u16, right u16 counts, interval u16 4 us
  kIdMotors = 0x213,    ///< duty left s16, right s16, missed edges u8
  kIdOdometry = 0x214,  ///< x s16, y s16 mm, heading u16 0.01 degree
  kIdAccelRaw = 0x310,  ///< 3 x s16 LSB
  kIdGyroRaw = 0x311,   ///< 3 x s16 LSB
  kIdMagRaw = 0x312,    ///< 3 x s16 LSB
  kIdBaro = 0x313,      ///< pressure u32 Pa/16 (24 bits used), temperature s16 0.01 degC
  kIdPower = 0x314,     ///< battery u16 mV, CPU load u8 %
  kIdHealth = 0x315,    ///< reset cause in the header bits; failing chips u8, failed I2C transfers
                        ///< u8, lost radio bytes u8, last tick u16 us
};

/// Operations of kIdCommand.
enum class CommandOp : uint8_t {
  kArm = 1,
  kRun = 2,
  kStop = 3,
  kDisarm = 4,
  kClear = 5,
  kDrive = 6,  ///< argument: speed s12 mm/s, turn s12 0.1 degree/s; for the algorithm "drive"
};

constexpr uint8_t kE2eHeaderSize = 2;

inline void put_u16(uint8_t* at, uint16_t value) {
  at[0] = static_cast<uint8_t>(value & 0xFFU);
  at[1] = static_cast<uint8_t>(value >> 8);
}
inline void put_s16(uint8_t* at, int16_t value) {
  put_u16(at, static_cast<uint16_t>(value));
}
inline void put_u32(uint8_t* at, uint32_t value) {
  put_u16(at, static_cast<uint16_t>(value & 0xFFFFU));
  put_u16(at + 2, static_cast<uint16_t>(value >> 16));
}
inline uint16_t get_u16(const uint8_t* at) {
  return static_cast<uint16_t>(at[0] | static_cast<uint16_t>(static_cast<uint16_t>(at[1]) << 8));
}
inline int16_t get_s16(const uint8_t* at) {
  return static_cast<int16_t>(get_u16(at));
}

/// The argument of CommandOp::kDrive. speed: +-2047 mm/s; turn: +-204.7 degrees/s in tenths.
struct DriveArgument {
  int16_t speed_mm_per_s;
  int16_t turn_ddeg_per_s;
};
void put_drive_argument(uint8_t* at, const DriveArgument& argument);
DriveArgument get_drive_argument(const uint8_t* at);

}  // namespace screed
