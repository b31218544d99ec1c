// An ATmega32U4 with an image, simulated by simavr.
#include "host_sim/devices/mcu/mcu.h"

extern "C" {
#include <simavr/avr_adc.h>
#include <simavr/avr_eeprom.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_gdb.h>
}

#include <elf.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>

#include "host_sim/core/errors.h"

#ifdef __SANITIZE_ADDRESS__  // gcc's word
#define SCREED_LEAK_CHECKER
#elif defined(__has_feature)  // clang's
#if __has_feature(address_sanitizer)
#define SCREED_LEAK_CHECKER
#endif
#endif
#ifdef SCREED_LEAK_CHECKER
#include <sanitizer/lsan_interface.h>
#endif

namespace screed::mcu {
namespace {

/// simavr frees not everything an MCU holds: what is allocated while one of these lives is no leak
/// of ours.
struct SimavrAllocates {
#ifdef SCREED_LEAK_CHECKER
  __lsan::ScopedDisabler disabler;
#else
  SimavrAllocates() {}  // not = default: else the object counts as unused
#endif
};

constexpr std::uint8_t kPaint = 0xA5;
constexpr std::uint64_t kCyclesPerMs = kClock_hz / 1000;
constexpr std::uint16_t kEepromBytes = 1024;
constexpr std::uint32_t kSupply_mv = 5000;
// Data sheet 4.8.1 "Interrupt Response Time": five cycles, five more out of sleep. simavr counts
// none.
constexpr std::uint64_t kResponseCycles = 5;
constexpr std::uint64_t kWakeUpCycles = 5;
// Two bytes in the receive buffer, one in the shift register (data sheet 18.8.4 "Data OverRun").
constexpr unsigned kReceiverBytes = 3;

constexpr std::uint16_t kUcsr1a = 0xC8;
constexpr std::uint16_t kUcsr1c = 0xCA;
constexpr std::uint16_t kUbrr1l = 0xCC;
constexpr std::uint16_t kUbrr1h = 0xCD;
constexpr std::uint8_t kU2x = 1 << 1;
constexpr std::uint8_t kDor = 1 << 3;

std::uint16_t pin_register(char port) {
  return static_cast<std::uint16_t>(kPinB + 3 * (port - 'B'));
}
std::uint16_t direction_register(char port) {
  return static_cast<std::uint16_t>(pin_register(port) + 1);
}
std::uint16_t port_register(char port) {
  return static_cast<std::uint16_t>(pin_register(port) + 2);
}

avr_irq_t* port_irq(avr_t* avr, char port, int index) {
  return avr_io_getirq(avr, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_GETIRQ(port)), index);
}

/// simavr reads whatever it is given; so look first.
void check_elf(const std::string& path) {
  std::array<char, 20> head{};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read");
  file.read(head.data(), head.size());
  constexpr char kMachineAvr = 83;
  if (!file ||
      std::memcmp(head.data(),
                  "\x7F"
                  "ELF",
                  4) != 0 ||
      head[18] != kMachineAvr) {
    throw InputError(path + ": not an ELF image for an AVR");
  }
}

}  // namespace

std::optional<std::uint16_t> image_algorithms(const std::string& elf_path) {
  check_elf(elf_path);
  std::ifstream file(elf_path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const auto read = [&](std::size_t offset, auto value) {
    if (offset > bytes.size() || bytes.size() - offset < sizeof value)
      throw InputError(elf_path + ": the image is incomplete");
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  const auto header = read(0, Elf32_Ehdr());
  const auto section = [&](std::size_t number) {
    return read(header.e_shoff + number * sizeof(Elf32_Shdr), Elf32_Shdr());
  };
  const std::size_t names = section(header.e_shstrndx).sh_offset;
  const std::string_view wanted(".screed.algorithms\0", 19);
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const Elf32_Shdr it = section(i);
    const std::size_t name = names + it.sh_name;
    if (name < bytes.size() && std::string_view(bytes).substr(name, wanted.size()) == wanted)
      return read(it.sh_offset, std::uint16_t());
  }
  return std::nullopt;
}

std::string vector_name(std::uint8_t vector) {
  static constexpr const char* kNames[kVectors] = {
      "RESET",        "INT0",         "INT1",         "INT2",         "INT3",
      nullptr,        nullptr,        "INT6",         nullptr,        "PCINT0",
      "USB_GEN",      "USB_COM",      "WDT",          nullptr,        nullptr,
      nullptr,        "TIMER1_CAPT",  "TIMER1_COMPA", "TIMER1_COMPB", "TIMER1_COMPC",
      "TIMER1_OVF",   "TIMER0_COMPA", "TIMER0_COMPB", "TIMER0_OVF",   "SPI_STC",
      "USART1_RX",    "USART1_UDRE",  "USART1_TX",    "ANALOG_COMP",  "ADC",
      "EE_READY",     "TIMER3_CAPT",  "TIMER3_COMPA", "TIMER3_COMPB", "TIMER3_COMPC",
      "TIMER3_OVF",   "TWI",          "SPM_READY",    "TIMER4_COMPA", "TIMER4_COMPB",
      "TIMER4_COMPD", "TIMER4_OVF",   "TIMER4_FPF"};
  const char* const name = vector < kVectors ? kNames[vector] : nullptr;
  return name != nullptr ? name : "vector " + std::to_string(vector);
}

/// What simavr calls, and the module that hears of resets.
struct Mcu::Hooks {
  avr_io_t module{};
  Mcu* mcu = nullptr;

  static Mcu& of(void* self) { return *static_cast<Mcu*>(self); }

  static void say(avr_t* avr, int level, const char* format, va_list arguments) {
    if (avr == nullptr || level > LOG_ERROR || avr->custom.data == nullptr) return;
    std::array<char, 256> text{};
    std::vsnprintf(text.data(), text.size(), format, arguments);
    of(avr->custom.data).last_message_ = text.data();
  }

  static void sleep(avr_t* avr, avr_cycle_count_t cycles) {
    Mcu& it = of(avr->custom.data);
    if (!it.asleep_) {
      it.asleep_ = true;
      if (it.sleep_callback_) it.sleep_callback_();
    }
    it.slept_ += cycles + 1;  // as simavr advances its clock
  }

  static void reset(avr_io_t* module) {
    Mcu& it = *reinterpret_cast<Hooks*>(module)->mcu;
    ++it.starts_;
    it.asleep_ = false;
    it.feeding_ = false;
    it.apply_pins();
    for (const auto& callback : it.reset_callbacks_) callback();
  }

  // Again and again until it is cancelled: where the program falls asleep in this very cycle,
  // simavr sleeps on to the next timer.
  static avr_cycle_count_t end(avr_t* avr, avr_cycle_count_t, void*) { return avr->cycle + 1; }

  static avr_cycle_count_t feed(avr_t*, avr_cycle_count_t when, void* self) {
    Mcu& it = of(self);
    if (it.to_receive_.empty()) {
      it.feeding_ = false;
      return 0;
    }
    it.receive_byte(it.to_receive_.front());
    it.to_receive_.pop_front();
    return when + it.cycles_per_character();
  }

  static void sent(avr_irq_t*, std::uint32_t value, void* self) {
    of(self).send_on(static_cast<std::uint8_t>(value));
  }

  static void character_time(avr_irq_t*, std::uint32_t, void* self) {
    of(self).set_character_time();
  }

  static void byte(avr_irq_t*, std::uint32_t value, void* callback) {
    (*static_cast<std::function<void(std::uint8_t)>*>(callback))(static_cast<std::uint8_t>(value));
  }

  static void pin(avr_irq_t*, std::uint32_t value, void* hook) {
    auto& it = *static_cast<PinHook*>(hook);
    const bool level = (value & 1U) != 0;
    if (level == it.level) return;
    it.level = level;
    it.callback(level);
  }

  static void interrupt(avr_irq_t*, std::uint32_t value, void* hook) {
    auto& it = *static_cast<VectorHook*>(hook);
    Mcu& mcu = *it.mcu;
    if (value != 0) {
      it.begun = mcu.avr_->cycle;
      if (it.callback) it.callback();
      mcu.avr_->cycle += kResponseCycles + (mcu.asleep_ ? kWakeUpCycles : 0);
      mcu.asleep_ = false;
      if (it.vector == kTimer3CompaVector) mcu.count_tick();
      return;
    }
    constexpr std::uint64_t kReti = 4;  // simavr counts it afterwards
    InterruptTimes& times = mcu.interrupts_.at(it.vector);
    const std::uint64_t cycles = mcu.avr_->cycle - it.begun + kReti;
    ++times.count;
    times.all_cycles += cycles;
    times.longest_cycles = std::max(times.longest_cycles, cycles);
  }
};

Mcu::Mcu(const std::string& elf_path, std::uint16_t static_ram) : hooks_(new Hooks) {
  const SimavrAllocates simavr;
  avr_global_logger_set(&Hooks::say);
  avr_ = avr_make_mcu_by_name("atmega32u4");
  if (avr_ == nullptr) throw RunError("simavr does not know the atmega32u4");
  avr_init(avr_);
  avr_->custom.data = this;
  avr_->log = LOG_ERROR;
  avr_->sleep = &Hooks::sleep;
  // From one timer to the next without coming up for air.
  avr_->run_cycle_limit = kClock_hz;
  load(elf_path);

  hooks_->mcu = this;
  hooks_->module.kind = "screed";
  hooks_->module.reset = &Hooks::reset;
  avr_register_io(avr_, &hooks_->module);

  for (avr_io_t* io = avr_->io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "uart") == 0) uart_ = reinterpret_cast<avr_uart_t*>(io);
  }
  if (uart_ == nullptr) throw RunError("simavr has no USART1");
  std::uint32_t flags = 0;
  avr_ioctl(avr_, AVR_IOCTL_UART_SET_FLAGS('1'), &flags);
  avr_irq_register_notify(avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_OUTPUT),
                          &Hooks::sent, this);
  for (const std::uint16_t address : {kUcsr1a, kUcsr1c, kUbrr1l, kUbrr1h}) {
    avr_irq_register_notify(avr_iomem_getirq(avr_, address, nullptr, AVR_IOMEM_IRQ_ALL),
                            &Hooks::character_time, this);
  }

  for (std::uint8_t vector = 1; vector < kVectors; ++vector) {
    VectorHook& hook = vector_hooks_.at(vector);
    hook = {this, vector, 0, {}};
    avr_irq_t* const irq = avr_get_interrupt_irq(avr_, vector);
    if (irq == nullptr) continue;
    avr_irq_register_notify(irq + AVR_INT_IRQ_RUNNING, &Hooks::interrupt, &hook);
  }

  paint_begin_ = static_cast<std::uint16_t>(kRamBegin + static_ram);
  std::fill(avr_->data + paint_begin_, avr_->data + kRamEnd, kPaint);
}

Mcu::~Mcu() {
  avr_terminate(avr_);
  std::free(avr_);  // simavr made it so
}

void Mcu::load(const std::string& elf_path) {
  check_elf(elf_path);
  elf_firmware_t image = {};
  if (elf_read_firmware(elf_path.c_str(), &image) != 0 || image.flashsize == 0) {
    throw InputError(elf_path + ": cannot be loaded");
  }
  if (image.flashbase + image.flashsize > avr_->flashend + 1U) {
    throw InputError(elf_path + ": larger than the flash of the ATmega32U4");
  }
  avr_load_firmware(avr_, &image);
  avr_->frequency = static_cast<std::uint32_t>(kClock_hz);
  avr_->vcc = avr_->avcc = avr_->aref = kSupply_mv;
  // simavr allocated them so.
  for (std::uint32_t i = 0; i < image.symbolcount; ++i) std::free(image.symbol[i]);
  std::free(static_cast<void*>(image.symbol));
  std::free(image.flash);
  std::free(image.eeprom);
}

// ---- running

std::uint64_t Mcu::cycle() const {
  return avr_->cycle;
}

double Mcu::time_ms() const {
  return static_cast<double>(avr_->cycle) / static_cast<double>(kCyclesPerMs);
}

bool Mcu::alive() const {
  // With a debugger the processor stops between two instructions, and is no less alive.
  const bool stopped =
      avr_->state == cpu_Stopped || avr_->state == cpu_Step || avr_->state == cpu_StepDone;
  return avr_->state == cpu_Running || avr_->state == cpu_Sleeping ||
         (stopped && avr_->gdb != nullptr);
}

void Mcu::wait_for_debugger(int port) {
  avr_->gdb_port = port;
  if (avr_gdb_init(avr_) != 0)
    throw RunError("--gdb " + std::to_string(port) + ": the port cannot be listened on");
  avr_->state = cpu_Stopped;
  avr_->run_cycle_limit = 1;  // a look for breakpoints before each instruction
}

void Mcu::request_stop() {
  stop_requested_ = true;
  avr_->run_cycle_count = 1;
}

bool Mcu::run_to(std::uint64_t cycle) {
  stop_requested_ = false;
  // A timer ends a sleep there, and a stretch of instructions.
  if (cycle > avr_->cycle) {
    avr_cycle_timer_register(avr_, cycle - avr_->cycle, &Hooks::end, this);
  }
  while (avr_->cycle < cycle && !stop_requested_ && alive()) avr_run(avr_);
  avr_cycle_timer_cancel(avr_, &Hooks::end, this);
  return !stop_requested_;
}

void Mcu::run_ms(double ms) {
  run_until_sent(SIZE_MAX, ms);
}

void Mcu::run_until_sent(std::size_t bytes, double ms) {
  // Ends are counted from the last end, so that many short runs are as long as one.
  end_ += static_cast<std::uint64_t>(ms * static_cast<double>(kCyclesPerMs));
  sent_limit_ = bytes;
  while (alive() && sent_.size() < bytes && avr_->cycle < end_) run_to(end_);
  sent_limit_ = SIZE_MAX;
  if (avr_->cycle < end_) end_ = avr_->cycle;
}

void Mcu::reset(std::uint8_t mcusr) {
  avr_reset(avr_);
  avr_->data[kMcusr] = mcusr;
}

void Mcu::on_reset(std::function<void()> callback) {
  reset_callbacks_.push_back(std::move(callback));
}

// ---- memory

std::uint8_t Mcu::memory(std::uint16_t address) const {
  return avr_->data[address];
}

std::uint16_t Mcu::word(std::uint16_t address) const {
  return static_cast<std::uint16_t>(memory(address) |
                                    (memory(static_cast<std::uint16_t>(address + 1)) << 8));
}

void Mcu::read_memory(std::uint16_t address, std::span<std::uint8_t> bytes) const {
  if (address + bytes.size() > kRamEnd) {
    throw RunError("the image shows an object at address " + std::to_string(address) +
                   ", beyond the end of its RAM");
  }
  std::copy_n(avr_->data + address, bytes.size(), bytes.begin());
}

void Mcu::watch_register(std::uint16_t address, std::function<void(std::uint8_t)> callback) {
  const SimavrAllocates simavr;
  byte_hooks_.push_back(std::move(callback));
  avr_irq_register_notify(avr_iomem_getirq(avr_, address, nullptr, AVR_IOMEM_IRQ_ALL), &Hooks::byte,
                          &byte_hooks_.back());
}

void Mcu::write_eeprom(std::uint16_t address, std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> copy(bytes.begin(), bytes.end());
  avr_eeprom_desc_t what = {copy.data(), address, static_cast<std::uint32_t>(copy.size())};
  // simavr's answer to success is "not mine"; -2 is failure.
  if (avr_ioctl(avr_, AVR_IOCTL_EEPROM_SET, &what) == -2) {
    throw RunError("the EEPROM has no room for " + std::to_string(copy.size()) + " bytes at " +
                   std::to_string(address));
  }
}

std::vector<std::uint8_t> Mcu::read_eeprom() const {
  std::vector<std::uint8_t> bytes(kEepromBytes);
  avr_eeprom_desc_t what = {bytes.data(), 0, kEepromBytes};
  avr_ioctl(avr_, AVR_IOCTL_EEPROM_GET, &what);
  return bytes;
}

unsigned Mcu::stack_used() const {
  const std::uint8_t* const end = avr_->data + kRamEnd;
  const std::uint8_t* const lowest = std::find_if(avr_->data + paint_begin_, avr_->data + kRamEnd,
                                                  [](std::uint8_t byte) { return byte != kPaint; });
  return static_cast<unsigned>(end - lowest);
}

// ---- pins

void Mcu::set_pin(PinName pin, bool high) {
  const SimavrAllocates simavr;
  // Else simavr falls back to the pull-up at the next write to the port.
  DrivenPins& pins = driven_pins_[pin.port];
  const auto bit = static_cast<std::uint8_t>(1U << pin.bit);
  pins.mask = static_cast<std::uint8_t>(pins.mask | bit);
  pins.value = static_cast<std::uint8_t>(high ? pins.value | bit : pins.value & ~bit);
  avr_ioport_external_t driven = {};
  driven.name = static_cast<unsigned char>(pin.port) & 0x7FU;
  driven.mask = pins.mask;
  driven.value = pins.value;
  avr_ioctl(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_SET_EXTERNAL(pin.port)), &driven);
  avr_raise_irq(port_irq(avr_, pin.port, pin.bit), high ? 1 : 0);
}

void Mcu::release_pin(PinName pin) {
  DrivenPins& pins = driven_pins_[pin.port];
  const auto bit = static_cast<std::uint8_t>(1U << pin.bit);
  const bool pulled_up = (memory(port_register(pin.port)) & bit) != 0;
  set_pin(pin, pulled_up);
  pins.mask = static_cast<std::uint8_t>(pins.mask & ~bit);
  pins.value = static_cast<std::uint8_t>(pins.value & ~bit);
  avr_ioport_external_t driven = {};
  driven.name = static_cast<unsigned char>(pin.port) & 0x7FU;
  driven.mask = pins.mask;
  driven.value = pins.value;
  avr_ioctl(avr_, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_SET_EXTERNAL(pin.port)), &driven);
}

/// After a reset simavr's pin registers are zero, and it does not hand on a level that it believes
/// to be there already.
void Mcu::apply_pins() {
  for (const auto& [port, pins] : driven_pins_) {
    std::uint8_t& levels = avr_->data[pin_register(port)];
    levels = static_cast<std::uint8_t>((levels & ~pins.mask) | (pins.value & pins.mask));
  }
}

bool Mcu::drives_high(PinName pin) const {
  return ((memory(direction_register(pin.port)) & memory(port_register(pin.port))) >> pin.bit &
          1) != 0;
}

bool Mcu::drives_low(PinName pin) const {
  return ((memory(direction_register(pin.port)) & ~memory(port_register(pin.port))) >> pin.bit &
          1) != 0;
}

void Mcu::watch_pin(PinName pin, std::function<void(bool)> callback) {
  const bool level = ((memory(port_register(pin.port)) >> pin.bit) & 1U) != 0;
  const SimavrAllocates simavr;
  pin_hooks_.push_back({this, std::move(callback), level});
  avr_irq_register_notify(port_irq(avr_, pin.port, pin.bit), &Hooks::pin, &pin_hooks_.back());
}

void Mcu::watch_direction(char port, std::function<void(std::uint8_t)> callback) {
  const SimavrAllocates simavr;
  byte_hooks_.push_back(std::move(callback));
  avr_irq_register_notify(port_irq(avr_, port, IOPORT_IRQ_DIRECTION_ALL), &Hooks::byte,
                          &byte_hooks_.back());
}

void Mcu::set_adc_mv(int channel, double mv) {
  // The chip counts in 1024ths of the reference, simavr in 1023rds.
  const double counts = std::clamp(std::floor(mv * 1024.0 / kSupply_mv), 0.0, 1023.0);
  avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + channel),
                static_cast<std::uint32_t>(std::ceil(counts * kSupply_mv / 1023.0)));
}

// ---- USART1

void Mcu::set_character_time() {
  // simavr computes it when the divider is written, U2X may come later, and it adds a parity bit.
  uart_->cycles_per_byte = cycles_per_character();
}

std::uint64_t Mcu::cycles_per_character() const {
  const unsigned divider = memory(kUbrr1l) | (memory(kUbrr1h) & 0x0FU) << 8;
  const unsigned cycles_per_bit = (divider + 1) * ((memory(kUcsr1a) & kU2x) != 0 ? 8U : 16U);
  const std::uint8_t frame = memory(kUcsr1c);
  const unsigned data_bits = 5 + (frame >> 1 & 3U);
  const unsigned parity_bits = (frame & 0x20U) != 0 ? 1 : 0;
  const unsigned stop_bits = 1 + (frame >> 3 & 1U);
  return std::uint64_t{cycles_per_bit} * (1 + data_bits + parity_bits + stop_bits);
}

bool Mcu::receive_byte(std::uint8_t byte) {
  ++received_;
  const unsigned unread =
      static_cast<unsigned>(uart_->input.write - uart_->input.read) % uart_fifo_fifo_size;
  if (unread >= kReceiverBytes) {
    ++overruns_;
    avr_->data[kUcsr1a] = static_cast<std::uint8_t>(avr_->data[kUcsr1a] | kDor);
    return false;
  }
  avr_raise_irq(avr_io_getirq(avr_, AVR_IOCTL_UART_GETIRQ('1'), UART_IRQ_INPUT), byte);
  return true;
}

void Mcu::receive(const std::vector<std::uint8_t>& bytes) {
  to_receive_.insert(to_receive_.end(), bytes.begin(), bytes.end());
  if (feeding_ || to_receive_.empty()) return;
  feeding_ = true;
  avr_cycle_timer_register(avr_, 1, &Hooks::feed, this);
}

void Mcu::send_on(std::uint8_t byte) {
  ++sent_bytes_;
  if (sent_callback_) {
    sent_callback_(byte);
    return;
  }
  sent_.push_back(byte);
  if (sent_.size() >= sent_limit_) request_stop();
}

// ---- time

void Mcu::on_interrupt(std::uint8_t vector, std::function<void()> callback) {
  vector_hooks_.at(vector).callback = std::move(callback);
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

void Mcu::break_tick() {
  constexpr std::uint32_t kTick = kTimer3CompaVector * 4U;
  avr_->flash[kTick] = 0x18;  // reti
  avr_->flash[kTick + 1] = 0x95;
}

}  // namespace screed::mcu
