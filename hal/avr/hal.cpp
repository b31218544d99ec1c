// hal/hal.h on the ATmega32U4: hands each call to the drivers.
#include "hal/hal.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "board.h"
#include "firmware/parameters/algorithms_in_build.h"
#include "firmware/parameters/parameters.h"
#include "hal/avr/battery.h"
#include "hal/avr/buttons.h"
#include "hal/avr/console.h"
#include "hal/avr/eeprom.h"
#include "hal/avr/emit_marker.h"
#include "hal/avr/encoders.h"
#include "hal/avr/imu.h"
#include "hal/avr/leds.h"
#include "hal/avr/motors.h"
#include "hal/avr/radio_uart.h"
#include "hal/avr/reset_cause.h"
#include "hal/avr/stack_guard.h"
#include "hal/avr/tick_timer.h"
#include "hal/avr/usb_serial.h"
#include "hal/avr/watchdog.h"

namespace screed {
namespace avr {

/// The leveling algorithms of this image, a bit each, for tools that read its ELF file. The section
/// has no flags ("" before the assembler's comment): nothing of it is flashed.
extern const uint16_t image_algorithms;
__attribute__((used, section(".screed.algorithms,\"\",@progbits;")))
const uint16_t image_algorithms = kAlgorithmsInBuild;

}  // namespace avr

namespace hal {
namespace {

constexpr int16_t kTestDuty = 80;  // of a motor alone: a fifth of kDutyMax, 1.5 V

}  // namespace

void init() {
  // On the Arduino core USB is attached by now. With hal/avr/arduino's init() interrupts are off; a
  // sketch that brings in the core's own has them on, and 10 a tick for millis(), which stands
  // still from now on.
  cli();
  avr::motors_init();
  TIMSK0 = 0;
  avr::reset_cause_init();
  avr::parameter_eeprom_init();
  avr::credential_eeprom_init();
  avr::emit_marker(avr::kMarkerStart, &avr::parameters_of_start());
  avr::buttons_init();
  avr::leds_init();
  avr::encoders_init();
  avr::radio_uart_init();
  avr::battery_init();
  avr::imu_init();
  avr::usb_serial_init();
  avr::tick_timer_init();
  avr::watchdog_init();
  sei();
}

const BoardConstants& board_constants() {
  return kBoard;
}

const Parameters& parameters() {
  return avr::parameters_of_start();
}

const Credentials& credentials() {
  return avr::credentials();
}

bool parameters_intact() {
  return avr::parameter_store_state() != StoreState::kCorrupt;
}

bool wait_for_tick() {
  // What has time until the next tick.
  avr::usb_serial_step();
  avr::console_step();
  avr::parameter_eeprom_step();
  avr::stack_guard_step();
  if (!avr::stack_intact()) {
    avr::set_next_reset_cause(avr::ResetCause::kStack);
    avr::watchdog_reset_now();
  }
  avr::tick_timer_wait();
  avr::watchdog_feed();
  return true;
}

__attribute__((noinline)) void read_sensors(SensorSample& sample) {
  sample.time_us = avr::tick_timer_time_us();
  sample.last_tick_us = avr::tick_timer_last_us();
  const avr::EncoderCounts counts = avr::encoders_read();
  sample.encoder_left = counts.left;
  sample.encoder_right = counts.right;
  sample.encoder_errors = counts.errors;
  avr::imu_read(sample);
  sample.battery = avr::battery_read();
  sample.radio_errors = avr::radio_uart_overruns();
  sample.reset_cause = static_cast<uint8_t>(avr::reset_cause());
  sample.radio_in_count = avr::radio_uart_read(sample.radio_in, kRadioInCapacity);
  avr::emit_marker(avr::kMarkerSample, &sample);
}

void write_outputs(const RobotOutput& output) {
  int16_t left = output.duty_left;
  int16_t right = output.duty_right;
  uint8_t leds = output.leds;
  // Both off: the robot itself drives nothing, and no fault is latched.
  if ((leds & (kLedYellow | kLedRed)) == 0) {
    const uint8_t tested = avr::console_tested_motor();
    if (tested == 'l') left = kTestDuty;
    if (tested == 'r') right = kTestDuty;
    if (tested != 0) leds |= kLedYellow;
  }
  avr::motors_drive(left, right);
  avr::leds_write(leds);
  avr::radio_uart_write(output.radio_out, output.radio_out_count);
  avr::console_mirror(output.radio_out, output.radio_out_count);
  if (output.store_parameter != 0) {
    avr::parameter_store(output.store_parameter, output.store_value);
  }
  avr::emit_marker(avr::kMarkerOutput, &output);
}

}  // namespace hal
}  // namespace screed
