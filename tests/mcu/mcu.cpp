// An ATmega32U4 with an image, simulated by simavr.
#include "tests/mcu/mcu.h"

extern "C" {
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
}

#include <algorithm>
#include <stdexcept>

#ifdef __SANITIZE_ADDRESS__
// simavr frees neither an image nor an MCU.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libsimavr";
}
#endif

namespace screed::mcu {
namespace {

constexpr std::uint8_t kPaint = 0xA5;
constexpr std::uint32_t kTickVector = 32 * 4;  // TIMER3_COMPA
constexpr std::uint16_t kTwcr = 0xBC;
constexpr std::uint8_t kTwie = 1;
constexpr std::uint64_t kCyclesPerMs = kClock_hz / 1000;

avr_irq_t* uart_irq(avr_t* avr, int index) {
  return avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('1'), index);
}

}  // namespace

Mcu::Mcu(const std::string& elf_path, std::uint16_t static_ram) {
  elf_firmware_t image = {};
  if (elf_read_firmware(elf_path.c_str(), &image) != 0) {
    throw std::runtime_error("cannot read the image " + elf_path);
  }
  avr_ = avr_make_mcu_by_name("atmega32u4");
  if (avr_ == nullptr) throw std::runtime_error("simavr does not know the atmega32u4");
  avr_init(avr_);
  avr_->log = LOG_ERROR;
  avr_load_firmware(avr_, &image);
  avr_->frequency = kClock_hz;
  avr_->vcc = avr_->avcc = avr_->aref = 5000;
  avr_->custom.data = this;
  avr_->sleep = [](avr_t* avr, avr_cycle_count_t cycles) { on_sleep(avr, cycles); };

  std::uint32_t flags = 0;
  avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('1'), &flags);
  uart_input_ = uart_irq(avr_, UART_IRQ_INPUT);
  avr_irq_register_notify(uart_irq(avr_, UART_IRQ_OUTPUT), &Mcu::on_sent, this);
  avr_irq_register_notify(uart_irq(avr_, UART_IRQ_OUT_XON), &Mcu::on_ready, this);
  avr_irq_register_notify(uart_irq(avr_, UART_IRQ_OUT_XOFF), &Mcu::on_full, this);

  avr_irq_register_notify(
      avr_io_getirq(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_GETIRQ('D')),
                    IOPORT_IRQ_DIRECTION_ALL),
      &Mcu::on_direction, this);

  paint_begin_ = static_cast<std::uint16_t>(kRamBegin + static_ram);
  std::fill(avr_->data + paint_begin_, avr_->data + kRamEnd, kPaint);
}

Mcu::~Mcu() {
  avr_terminate(avr_);
}

void Mcu::on_sent(avr_irq_t*, std::uint32_t value, void* self) {
  static_cast<Mcu*>(self)->sent_.push_back(static_cast<std::uint8_t>(value));
}

void Mcu::on_ready(avr_irq_t*, std::uint32_t, void* self) {
  static_cast<Mcu*>(self)->uart_ready_ = true;
}

void Mcu::on_full(avr_irq_t*, std::uint32_t, void* self) {
  static_cast<Mcu*>(self)->uart_ready_ = false;
}

void Mcu::on_sleep(avr_t* avr, std::uint64_t cycles) {
  static_cast<Mcu*>(avr->custom.data)->slept_ += cycles + 1;  // as simavr advances its clock
}

void Mcu::feed() {
  while (uart_ready_ && !to_receive_.empty()) {
    const std::uint8_t byte = to_receive_.front();
    to_receive_.pop_front();
    avr_raise_irq(uart_input_, byte);
  }
}

void Mcu::count_tick() {
  if (tick_cycle_ != 0) {
    const std::uint64_t length = avr_->cycle - tick_cycle_;
    const std::uint64_t slept = slept_ - tick_slept_;
    busiest_ = std::max(busiest_, length - std::min(slept, length));
    shortest_ = std::min(shortest_, length);
    longest_ = std::max(longest_, length);
    ++ticks_;
  }
  tick_cycle_ = avr_->cycle;
  tick_slept_ = slept_;
}

void Mcu::clear_load() {
  ticks_ = busiest_ = longest_ = 0;
  shortest_ = UINT64_MAX;
}

void Mcu::step() {
  if (avr_->pc == 0) ++starts_;
  if (avr_->pc == kTickVector) count_tick();
  if (!to_receive_.empty()) feed();
  avr_run(avr_);
}

bool Mcu::alive() const {
  return avr_->state == cpu_Running || avr_->state == cpu_Sleeping;
}

double Mcu::time_ms() const {
  return static_cast<double>(avr_->cycle) / static_cast<double>(kCyclesPerMs);
}

void Mcu::run_ms(double ms) {
  run_until_sent(SIZE_MAX, ms);
}

void Mcu::run_until_sent(std::size_t bytes, double ms) {
  // Ends are counted from the last end, so that many short runs are as long as one; a timer ends a
  // sleep there.
  end_ += static_cast<std::uint64_t>(ms * static_cast<double>(kCyclesPerMs));
  if (end_ > avr_->cycle) {
    avr_cycle_timer_register(avr_, end_ - avr_->cycle, &Mcu::on_end, this);
  }
  while (alive() && sent_.size() < bytes && avr_->cycle < end_) step();
  if (avr_->cycle < end_) {
    avr_cycle_timer_cancel(avr_, &Mcu::on_end, this);
    end_ = avr_->cycle;
  }
}

std::uint64_t Mcu::on_end(avr_t*, std::uint64_t, void*) {
  return 0;
}

void Mcu::receive(const std::vector<std::uint8_t>& bytes) {
  to_receive_.insert(to_receive_.end(), bytes.begin(), bytes.end());
}

void Mcu::set_pin(char port, int bit, bool high) {
  // Else simavr falls back to the pull-up at the next write to the port.
  avr_ioport_external_t driven = {};
  DrivenPins& pins = driven_pins_[port];
  pins.mask = static_cast<std::uint8_t>(pins.mask | 1U << bit);
  pins.value = static_cast<std::uint8_t>(high ? pins.value | 1U << bit : pins.value & ~(1U << bit));
  driven.name = static_cast<unsigned char>(port) & 0x7FU;
  driven.mask = pins.mask;
  driven.value = pins.value;
  avr_ioctl(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_SET_EXTERNAL(port)), &driven);
  avr_raise_irq(avr_io_getirq(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_GETIRQ(port)), bit),
                high ? 1 : 0);
  // simavr looks for interrupts from outside only when a sleep has ended.
  avr_cycle_timer_register(avr_, 1, &Mcu::on_end, nullptr);
}

void Mcu::watch_pin(char port, int bit, void (*on_change)(void* context), void* context) {
  avr_irq_t* const pin =
      avr_io_getirq(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_GETIRQ(port)), bit);
  const int port_register = 0x25 + 3 * (port - 'B');
  watches_.push_back({on_change, context, (avr_->data[port_register] >> bit) & 1U});
  avr_irq_register_notify(pin, &Mcu::on_watched, &watches_.back());
}

void Mcu::on_watched(avr_irq_t*, std::uint32_t value, void* watch) {
  auto& it = *static_cast<Watch*>(watch);
  if ((value & 1U) == it.level) return;
  it.level = value & 1U;
  it.on_change(it.context);
}

void Mcu::set_adc_mv(int channel, int mv) {
  avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + channel),
                static_cast<std::uint32_t>(mv));
}

void Mcu::on_direction(avr_irq_t*, std::uint32_t value, void* self) {
  Mcu& mcu = *static_cast<Mcu*>(self);
  const bool driven = (value & 1) != 0;  // PD0 is SCL
  if (driven && !mcu.scl_driven_) ++mcu.scl_pulses_;
  mcu.scl_driven_ = driven;
}

void Mcu::silence_twi() {
  avr_->data[kTwcr] = static_cast<std::uint8_t>(avr_->data[kTwcr] & ~kTwie);
}

void Mcu::break_tick() {
  avr_->flash[kTickVector] = 0x18;  // reti
  avr_->flash[kTickVector + 1] = 0x95;
}

std::uint8_t Mcu::memory(std::uint16_t address) const {
  return avr_->data[address];
}

std::uint16_t Mcu::word(std::uint16_t address) const {
  return static_cast<std::uint16_t>(memory(address) |
                                    (memory(static_cast<std::uint16_t>(address + 1)) << 8));
}

unsigned Mcu::stack_used() const {
  const std::uint8_t* const end = avr_->data + kRamEnd;
  const std::uint8_t* const lowest = std::find_if(avr_->data + paint_begin_, avr_->data + kRamEnd,
                                                  [](std::uint8_t byte) { return byte != kPaint; });
  return static_cast<unsigned>(end - lowest);
}

}  // namespace screed::mcu
