// The key of test images and of the ground stations that talk to them. Runs on any machine.
#pragma once

#include "firmware/security/command_mac.h"

namespace screed {

constexpr Credentials kTestCredentials = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, 1, true, 2};

}  // namespace screed
