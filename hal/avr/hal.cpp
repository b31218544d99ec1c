// hal/hal.h on the ATmega32U4: hands each call to the drivers.
#include "hal/hal.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "board.h"
#include "firmware/robot/parameters.h"
#include "hal/avr/battery.h"
#include "hal/avr/encoders.h"
#include "hal/avr/imu.h"
#include "hal/avr/leds.h"
#include "hal/avr/motors.h"
#include "hal/avr/radio_uart.h"
#include "hal/avr/tick_timer.h"
#include "hal/avr/watchdog.h"

namespace screed {
namespace hal {
namespace {

const Parameters kDefaults;

/// The bootloader leaves the USB controller running; its interrupts have no handler here.
void usb_off() {
  UDIEN = 0;
  USBCON = _BV(FRZCLK);
}

}  // namespace

void init() {
  avr::motors_init();
  usb_off();
  avr::leds_init();
  avr::encoders_init();
  avr::radio_uart_init();
  avr::battery_init();
  avr::imu_init();
  avr::tick_timer_init();
  avr::watchdog_init();
  sei();
}

const BoardConstants& board_constants() {
  return kBoard;
}

const Parameters& parameters() {
  return kDefaults;
}

bool wait_for_tick() {
  avr::tick_timer_wait();
  avr::watchdog_feed();
  return true;
}

void read_sensors(SensorSample& sample) {
  sample.time_us = avr::tick_timer_time_us();
  sample.last_tick_us = avr::tick_timer_last_us();
  const avr::EncoderCounts counts = avr::encoders_read();
  sample.encoder_left = counts.left;
  sample.encoder_right = counts.right;
  sample.encoder_errors = counts.errors;
  avr::imu_read(sample);
  sample.battery = avr::battery_read();
  sample.radio_in_count = avr::radio_uart_read(sample.radio_in, kRadioInCapacity);
}

void write_outputs(const RobotOutput& output) {
  avr::motors_drive(output.duty_left, output.duty_right);
  avr::leds_write(output.leds);
  avr::radio_uart_write(output.radio_out, output.radio_out_count);
}

}  // namespace hal
}  // namespace screed
