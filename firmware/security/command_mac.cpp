// What the MAC of a command covers.
#include "firmware/security/command_mac.h"

#include <string.h>

#include "firmware/protocol/messages.h"

namespace screed {

void command_mac(const uint8_t* key, uint16_t can_id, uint8_t robot_id, uint16_t boot_epoch,
                 uint16_t counter, const uint8_t* data, uint8_t (&mac)[kSipHashSize]) {
  uint8_t message[7 + kCommandBodySize];
  put_u16(message, can_id);
  message[2] = robot_id;
  put_u16(message + 3, counter);
  put_u16(message + 5, boot_epoch);
  memcpy(message + 7, data, kCommandBodySize);
  siphash_2_4(key, message, sizeof(message), mac);
}

}  // namespace screed
