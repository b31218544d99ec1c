// Timer3: the 100 Hz control tick.
#include "hal/avr/tick_timer.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "hal/avr/imu.h"
#include "hal/avr/interrupts_off.h"
#include "hal/avr/watchdog.h"
#include "hal/sample.h"

namespace screed {
namespace avr {
namespace {

constexpr uint16_t kCountsPerTick = F_CPU / 8 / kTickRate_hz;
constexpr uint8_t kCountsPerUs = F_CPU / 8 / 1000000UL;
// The IMU is read so that its numbers are complete, and no older than this, when the tick begins.
// Four bursts and one register take 1.3 ms at 400 kHz.
constexpr uint16_t kImuLead_us = 2000;

struct State {
  volatile uint8_t ticks;  // since the last wait ended
  uint32_t time_us;
  uint16_t last_us;
};
State state;

/// Counts since the event of the current tick, missed ticks included; stops at 65535.
uint16_t counts_since_tick() {
  uint8_t missed = 0;
  uint16_t counts = 0;
  {
    const InterruptsOff interrupts_off;
    counts = TCNT3;
    missed = state.ticks;
    if ((TIFR3 & _BV(OCF3A)) != 0) {  // the tick came in between
      counts = TCNT3;
      missed = static_cast<uint8_t>(missed + 1);
    }
  }
  for (; missed != 0; --missed) {
    if (counts > UINT16_MAX - kCountsPerTick) return UINT16_MAX;
    counts = static_cast<uint16_t>(counts + kCountsPerTick);
  }
  return counts;
}

}  // namespace

ISR(TIMER3_COMPA_vect) {
  state.ticks = static_cast<uint8_t>(state.ticks + 1);
}

ISR(TIMER3_COMPB_vect) {
  imu_start_round();
  watchdog_check();
}

void tick_timer_init() {
  TCCR3A = 0;
  TCCR3B = _BV(WGM32) | _BV(CS31);  // clear at OCR3A, clock / 8
  OCR3A = kCountsPerTick - 1;
  OCR3B = kCountsPerTick - kImuLead_us * kCountsPerUs;
  TCNT3 = 0;
  TIFR3 = _BV(OCF3A) | _BV(OCF3B);
  TIMSK3 = _BV(OCIE3A) | _BV(OCIE3B);
  SMCR = 0;  // idle: timers, USART, TWI and ADC go on
}

void tick_timer_wait() {
  state.last_us = counts_since_tick() / kCountsPerUs;
  cli();
  while (state.ticks == 0) {
    // The instruction after sei() is executed before any interrupt: no tick is slept through.
    SMCR = _BV(SE);
    sei();
    sleep_cpu();
    SMCR = 0;
    cli();
  }
  uint8_t ticks = state.ticks;
  state.ticks = 0;
  sei();
  for (; ticks != 0; --ticks) state.time_us += kTickPeriod_us;
}

uint32_t tick_timer_time_us() {
  return state.time_us;
}

uint16_t tick_timer_last_us() {
  return state.last_us;
}

}  // namespace avr
}  // namespace screed
