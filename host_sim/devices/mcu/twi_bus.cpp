// The I2C bus with the ATmega32U4's TWI as master.
#include "host_sim/devices/mcu/twi_bus.h"

extern "C" {
#include <simavr/sim_avr.h>
}

#include "host_sim/core/errors.h"

namespace screed::mcu {
namespace {

constexpr std::uint16_t kTwbr = 0xB8;
constexpr std::uint16_t kTwsr = 0xB9;
constexpr std::uint16_t kTwdr = 0xBB;
constexpr std::uint16_t kTwcr = 0xBC;
constexpr std::uint8_t kTwint = 1 << 7;
constexpr std::uint8_t kTwea = 1 << 6;
constexpr std::uint8_t kTwsta = 1 << 5;
constexpr std::uint8_t kTwsto = 1 << 4;
constexpr std::uint8_t kTwen = 1 << 2;
constexpr std::uint8_t kTwie = 1 << 0;

// Status codes of a master (data sheet, tables 20-3 and 20-4).
constexpr std::uint8_t kStart = 0x08;
constexpr std::uint8_t kRepeatedStart = 0x10;
constexpr std::uint8_t kWriteAck = 0x18;
constexpr std::uint8_t kWriteNack = 0x20;
constexpr std::uint8_t kSentAck = 0x28;
constexpr std::uint8_t kSentNack = 0x30;
constexpr std::uint8_t kArbitrationLost = 0x38;
constexpr std::uint8_t kReadAck = 0x40;
constexpr std::uint8_t kReadNack = 0x48;
constexpr std::uint8_t kReceivedAck = 0x50;
constexpr std::uint8_t kReceivedNack = 0x58;
constexpr std::uint8_t kNothing = 0xF8;

constexpr PinName kSda = {'D', 1};
constexpr PinName kScl = {'D', 0};

}  // namespace

struct TwiBus::Hooks {
  static TwiBus& of(void* self) { return *static_cast<TwiBus*>(self); }
  static void control(avr_t*, avr_io_addr_t, std::uint8_t value, void* self) {
    of(self).write_control(value);
  }
  static void status(avr_t*, avr_io_addr_t, std::uint8_t value, void* self) {
    of(self).write_status(value);
  }
  static void data(avr_t* avr, avr_io_addr_t address, std::uint8_t value, void*) {
    avr->data[address] = value;
  }
  static avr_cycle_count_t timer(avr_t*, avr_cycle_count_t, void* self) {
    of(self).finish();
    return 0;
  }
};

TwiBus::TwiBus(Mcu& mcu) : mcu_(mcu) {
  avr_t* const avr = mcu.simulator();
  for (std::uint8_t i = 0; i < avr->interrupts.vector_count; ++i) {
    if (avr->interrupts.vector[i]->vector == kTwiVector) vector_ = avr->interrupts.vector[i];
  }
  if (vector_ == nullptr) throw RunError("simavr has no interrupt of the TWI");
  const auto take_over = [&](std::uint16_t address, avr_io_write_t write) {
    auto& io = avr->io[AVR_DATA_TO_IO(address)];
    io.w.c = write;
    io.w.param = this;
    io.r.c = nullptr;
    io.r.param = nullptr;
  };
  take_over(kTwcr, &Hooks::control);
  take_over(kTwsr, &Hooks::status);
  take_over(kTwdr, &Hooks::data);
  mcu.watch_direction(kScl.port, [this](std::uint8_t directions) { on_direction(directions); });
  mcu.on_reset([this] { reset(); });
  // Pull-ups.
  mcu.set_pin(kSda, true);
  mcu.set_pin(kScl, true);
  reset();
}

std::uint8_t& TwiBus::control() {
  return mcu_.simulator()->data[kTwcr];
}

void TwiBus::reset() {
  mcu_.simulator()->data[kTwsr] = kNothing;
  phase_ = Phase::kIdle;
  busy_ = start_waiting_ = addressing_ = false;
  selected_ = nullptr;
}

std::uint64_t TwiBus::cycles_per_bit() const {
  const unsigned prescaler = 1U << (2 * (mcu_.memory(kTwsr) & 3U));
  return 16 + std::uint64_t{2} * mcu_.memory(kTwbr) * prescaler;
}

void TwiBus::after(std::uint64_t bits) {
  busy_ = true;
  avr_cycle_timer_register(mcu_.simulator(), bits * cycles_per_bit(), &Hooks::timer, this);
}

void TwiBus::write_status(std::uint8_t value) {
  std::uint8_t& status = mcu_.simulator()->data[kTwsr];
  status = static_cast<std::uint8_t>((status & 0xF8) | (value & 3U));
}

void TwiBus::write_control(std::uint8_t value) {
  avr_t* const avr = mcu_.simulator();
  auto* const vector = static_cast<avr_int_vector_t*>(vector_);
  const bool flag = (control() & kTwint) != 0;
  if ((value & kTwen) == 0) {
    // Off: whatever was going on is dropped; the devices see an unfinished transfer.
    control() = static_cast<std::uint8_t>(value & ~(kTwint | kTwsto));
    avr_clear_interrupt(avr, vector);
    avr_cycle_timer_cancel(avr, &Hooks::timer, this);
    reset();
    return;
  }
  const bool go = (value & kTwint) != 0;  // writing a one clears the flag
  control() = static_cast<std::uint8_t>((value & ~kTwint) | (flag && !go ? kTwint : 0));
  if (!go) {
    if (flag && (value & kTwie) != 0) avr_raise_interrupt(avr, vector);
    return;
  }
  if (flag) avr_clear_interrupt(avr, vector);
  if ((value & kTwsto) != 0) {
    stop_devices();
    phase_ = Phase::kIdle;
    avr->data[kTwsr] = static_cast<std::uint8_t>((avr->data[kTwsr] & 3U) | kNothing);
    // The condition takes a bit; the program only sees the flag vanish. With SDA held low there is
    // no condition, and the bus stays busy.
    control() = static_cast<std::uint8_t>(control() & ~kTwsto);
  }
  if ((value & kTwsta) != 0) {
    begin_start();
  } else if (flag && (value & kTwsto) == 0 && phase_ != Phase::kIdle) {
    begin_byte();
  }
}

void TwiBus::begin_start() {
  if (held_) {
    start_waiting_ = true;
    return;
  }
  start_waiting_ = false;
  addressing_ = false;
  after(phase_ == Phase::kIdle ? 2 : 1);  // with the stop condition or the idle time before it
  phase_ = phase_ == Phase::kIdle ? Phase::kIdle : Phase::kStarted;
}

void TwiBus::begin_byte() {
  addressing_ = phase_ == Phase::kStarted;
  constexpr std::uint64_t kByteAndAck = 9;
  after(kByteAndAck);
}

void TwiBus::finish() {
  busy_ = false;
  if ((control() & kTwsta) != 0) {
    finish_start();
  } else if (addressing_) {
    finish_address();
  } else {
    finish_byte();
  }
}

void TwiBus::finish_start() {
  const bool repeated = phase_ != Phase::kIdle;
  phase_ = Phase::kStarted;
  report(repeated ? kRepeatedStart : kStart);
}

void TwiBus::finish_address() {
  addressing_ = false;
  const std::uint8_t byte = mcu_.memory(kTwdr);
  const bool read = (byte & 1U) != 0;
  if (held_) {  // the first one bit of the address meets a low wire
    phase_ = Phase::kIdle;
    report(kArbitrationLost);
    return;
  }
  selected_ = nullptr;
  for (I2cDevice* const device : devices_) {
    if (device->select(static_cast<std::uint8_t>(byte >> 1), read)) selected_ = device;
  }
  phase_ = read ? Phase::kReceiver : Phase::kTransmitter;
  if (read) {
    report(selected_ != nullptr ? kReadAck : kReadNack);
  } else {
    report(selected_ != nullptr ? kWriteAck : kWriteNack);
  }
}

void TwiBus::finish_byte() {
  if (phase_ == Phase::kReceiver) {
    const bool acknowledge = (control() & kTwea) != 0;
    if (held_ && !acknowledge) {  // the master's one in the acknowledge bit meets a low wire
      phase_ = Phase::kIdle;
      report(kArbitrationLost);
      return;
    }
    // A wire that nobody drives is high.
    mcu_.simulator()->data[kTwdr] = held_                  ? std::uint8_t{0}
                                    : selected_ != nullptr ? selected_->read()
                                                           : std::uint8_t{0xFF};
    report(acknowledge ? kReceivedAck : kReceivedNack);
    return;
  }
  const std::uint8_t byte = mcu_.memory(kTwdr);
  if (held_ && byte != 0) {
    phase_ = Phase::kIdle;
    report(kArbitrationLost);
    return;
  }
  report(held_ || (selected_ != nullptr && selected_->write(byte)) ? kSentAck : kSentNack);
}

void TwiBus::stop_devices() {
  if (selected_ != nullptr) selected_->stop();
  selected_ = nullptr;
}

void TwiBus::report(std::uint8_t status) {
  avr_t* const avr = mcu_.simulator();
  avr->data[kTwsr] = static_cast<std::uint8_t>((avr->data[kTwsr] & 3U) | status);
  avr_raise_interrupt(avr, static_cast<avr_int_vector_t*>(vector_));
}

void TwiBus::hold_data(std::optional<unsigned> until_clocks) {
  held_ = true;
  clocks_to_release_ = until_clocks;
  mcu_.set_pin(kSda, false);
}

void TwiBus::release_data() {
  held_ = false;
  clocks_to_release_.reset();
  mcu_.set_pin(kSda, true);
  if (start_waiting_) begin_start();
}

void TwiBus::on_direction(std::uint8_t directions) {
  const bool driven = (directions >> kScl.bit & 1U) != 0;
  if (driven && !clock_driven_) {
    ++clock_pulses_;
    if (held_ && clocks_to_release_.has_value() && clock_pulses_ != 0) {
      if (*clocks_to_release_ <= 1) {
        release_data();
      } else {
        --*clocks_to_release_;
      }
    }
  }
  clock_driven_ = driven;
}

}  // namespace screed::mcu
