// What the image shows to a simulator of the microcontroller: where the data that cross hal.h lie
// in RAM, and when.
//
// The address goes into two registers that nothing else uses, then a mark into a third; a simulator
// watches the third. On the robot nobody looks. It is part of the very image that is flashed, costs
// five instructions, and needs neither symbols nor variables. Runs on any machine.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Written to GPIOR0 while GPIOR1 and GPIOR2 hold an address, low byte first.
enum TraceMarker : uint8_t {
  kMarkerStart = 1,   ///< hal::init() has found these Parameters
  kMarkerSample = 2,  ///< read_sensors() has filled this SensorSample
  kMarkerOutput = 3,  ///< write_outputs() has applied this RobotOutput
};

}  // namespace avr
}  // namespace screed
