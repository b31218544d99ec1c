// Keys as the viewer names them, whatever they come from.
#pragma once

#include "tools/screed/cli/terminal_screen.h"

namespace screed::viewer {

/// The character of a key, small; or one of these.
using Key = int;
inline constexpr Key kKeyLeft = 256;
inline constexpr Key kKeyRight = 257;
inline constexpr Key kKeyUp = 258;
inline constexpr Key kKeyDown = 259;
inline constexpr Key kKeyHome = 260;
inline constexpr Key kKeyEnd = 261;
inline constexpr Key kKeyEscape = 262;
inline constexpr Key kKeyBackspace = 263;
inline constexpr Key kKeyF12 = 264;
inline constexpr Key kKeyEmergencyStop = kEmergencyStopKey;

}  // namespace screed::viewer
