// An ATmega32U4 with an image, simulated cycle by cycle by simavr: runs it, feeds and reads its
// pins and its serial line. Knows no board.
//
// Only simavr's public headers are used. What simavr 1.6 leaves out is added here: the five cycles
// that entering an interrupt takes, the length of a character (simavr adds a parity bit that is not
// sent), a receiver that can lose bytes, and pins that keep their level over a reset.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct avr_t;
struct avr_irq_t;
struct avr_uart_t;

namespace screed::mcu {

constexpr std::uint64_t kClock_hz = 16'000'000;
constexpr std::uint64_t kCyclesPerUs = kClock_hz / 1'000'000;
constexpr std::uint16_t kRamBegin = 0x100;
constexpr std::uint16_t kRamEnd = 0xB00;  // one past the last byte
constexpr std::uint8_t kVectors = 43;     // of the ATmega32U4, reset included

// Memory addresses of registers (data sheet, 31 "Register Summary").
constexpr std::uint16_t kPinB = 0x23;  // DDRB and PORTB follow, then PINC and so on
constexpr std::uint16_t kGpior0 = 0x3E;
constexpr std::uint16_t kGpior1 = 0x4A;
constexpr std::uint16_t kGpior2 = 0x4B;
constexpr std::uint16_t kMcusr = 0x54;
constexpr std::uint16_t kTccr1a = 0x80;
constexpr std::uint16_t kTccr1b = 0x81;
constexpr std::uint16_t kIcr1 = 0x86;
constexpr std::uint16_t kOcr1a = 0x88;
constexpr std::uint16_t kOcr1b = 0x8A;

// Vectors (data sheet, 9.1 "Interrupt Vectors"), counted from 0 = reset.
constexpr std::uint8_t kInt6Vector = 7;
constexpr std::uint8_t kPcint0Vector = 9;
constexpr std::uint8_t kTimer3CompaVector = 32;
constexpr std::uint8_t kTwiVector = 36;

/// "PCINT0" and so on; "vector 12" for those without a common name.
std::string vector_name(std::uint8_t vector);

/// The leveling algorithms that an image lists, a bit each (hal/avr/hal.cpp); nothing for one that
/// lists none. Throws InputError for a file that is no image.
std::optional<std::uint16_t> image_algorithms(const std::string& elf_path);

/// A pin of the package by its port.
struct PinName {
  char port = '\0';  ///< 'B'..'F'
  std::uint8_t bit = 0;
  bool operator==(const PinName&) const = default;
};

/// What was measured of one interrupt. Cycles count from the beginning of the response to the end
/// of RETI.
struct InterruptTimes {
  std::uint64_t count = 0;
  std::uint64_t longest_cycles = 0;
  std::uint64_t all_cycles = 0;
};

class Mcu {
 public:
  /// Throws InputError when the file is no image of an AVR. RAM above `static_ram` bytes is painted
  /// to measure the stack.
  explicit Mcu(const std::string& elf_path, std::uint16_t static_ram = 0);
  ~Mcu();
  Mcu(const Mcu&) = delete;
  Mcu& operator=(const Mcu&) = delete;

  // ---- running

  std::uint64_t cycle() const;
  double time_ms() const;
  /// Runs until the clock shows `cycle` (a few cycles later when an instruction takes so long), the
  /// program has crashed or stopped, or request_stop() is called. Returns false after
  /// request_stop().
  bool run_to(std::uint64_t cycle);
  /// Before the next instruction the program waits for a debugger (avr-gdb, target remote :PORT),
  /// which from then on stops and continues it. Throws RunError when the port is taken.
  void wait_for_debugger(int port);
  /// To be called from a callback: run_to() returns after the present instruction.
  void request_stop();
  /// Runs for a time of the simulated clock.
  void run_ms(double ms);
  /// Runs until the program has sent `bytes` bytes in all, has stopped, or `ms` have passed.
  void run_until_sent(std::size_t bytes, double ms);
  /// Neither crashed nor stopped.
  bool alive() const;
  /// simavr's last message, for an error message.
  const std::string& last_message() const { return last_message_; }
  /// Starts from the reset vector so far; 1 when all is well.
  int starts() const { return starts_; }
  /// A reset from outside, with the flags that MCUSR shows afterwards (PORF 1, EXTRF 2, BORF 4).
  void reset(std::uint8_t mcusr);
  /// Called after every reset; cycle timers are gone then.
  void on_reset(std::function<void()> callback);

  // ---- memory

  std::uint8_t memory(std::uint16_t address) const;
  std::uint16_t word(std::uint16_t address) const;
  void read_memory(std::uint16_t address, std::span<std::uint8_t> bytes) const;
  /// Calls back when the program writes a register.
  void watch_register(std::uint16_t address, std::function<void(std::uint8_t)> callback);
  void write_eeprom(std::uint16_t address, std::span<const std::uint8_t> bytes);
  std::vector<std::uint8_t> read_eeprom() const;
  /// Bytes between the end of RAM and the lowest painted byte that was written.
  unsigned stack_used() const;

  // ---- pins

  /// Level of an input pin, as something outside drives it.
  void set_pin(PinName pin, bool high);
  /// Nothing outside drives the pin any more: the pull-up decides, and low without one.
  void release_pin(PinName pin);
  /// The program drives this pin high, or low.
  bool drives_high(PinName pin) const;
  bool drives_low(PinName pin) const;
  /// Calls back at every change of a pin's level.
  void watch_pin(PinName pin, std::function<void(bool)> callback);
  /// Calls back when the direction register of a port is written.
  void watch_direction(char port, std::function<void(std::uint8_t)> callback);
  /// Voltage at an ADC channel.
  void set_adc_mv(int channel, double mv);

  // ---- USART1

  /// Bytes sent so far, and what becomes of the next ones instead.
  const std::vector<std::uint8_t>& sent() const { return sent_; }
  void on_sent(std::function<void(std::uint8_t)> callback) { sent_callback_ = std::move(callback); }
  /// The start bit of a byte begins now. Returns false, and the byte is lost as on the chip, when
  /// the receiver still holds three unread ones.
  bool receive_byte(std::uint8_t byte);
  std::uint64_t cycles_per_character() const;
  /// Queues bytes; they arrive one character time apart.
  void receive(const std::vector<std::uint8_t>& bytes);
  std::size_t unreceived() const { return to_receive_.size(); }
  std::uint64_t overruns() const { return overruns_; }
  std::uint64_t received_bytes() const { return received_; }
  std::uint64_t sent_bytes() const { return sent_bytes_; }

  // ---- time

  std::uint64_t slept_cycles() const { return slept_; }
  /// Called when the program goes to sleep.
  void on_sleep(std::function<void()> callback) { sleep_callback_ = std::move(callback); }
  const std::array<InterruptTimes, kVectors>& interrupts() const { return interrupts_; }
  /// Called when an interrupt's handler begins, before its five cycles are counted.
  void on_interrupt(std::uint8_t vector, std::function<void()> callback);

  /// Cycles not slept in the busiest control tick, and ticks, since the last clear_load().
  std::uint64_t busiest_tick_cycles() const { return busiest_; }
  std::uint64_t ticks() const { return ticks_; }
  void clear_load();
  /// Cycles between two ticks, the least and the most.
  std::uint64_t shortest_tick() const { return shortest_; }
  std::uint64_t longest_tick() const { return longest_; }

  /// Makes the program's main loop hang: the tick's interrupt returns without doing anything.
  void break_tick();

  avr_t* simulator() const { return avr_; }

 private:
  struct Hooks;  // callbacks in simavr's signatures
  struct VectorHook {
    Mcu* mcu;
    std::uint8_t vector;
    std::uint64_t begun;
    std::function<void()> callback;
  };
  struct PinHook {
    Mcu* mcu;
    std::function<void(bool)> callback;
    bool level;
  };
  struct DrivenPins {
    std::uint8_t mask = 0;
    std::uint8_t value = 0;
  };

  void load(const std::string& elf_path);
  void apply_pins();
  void set_character_time();
  void send_on(std::uint8_t byte);
  void count_tick();

  avr_t* avr_ = nullptr;
  std::unique_ptr<Hooks> hooks_;
  avr_uart_t* uart_ = nullptr;
  std::map<char, DrivenPins> driven_pins_;
  std::deque<PinHook> pin_hooks_;  // elements stay in place when it grows
  std::deque<std::function<void(std::uint8_t)>> byte_hooks_;
  std::array<VectorHook, kVectors> vector_hooks_{};
  std::vector<std::function<void()>> reset_callbacks_;
  std::function<void(std::uint8_t)> sent_callback_;
  std::function<void()> sleep_callback_;
  std::vector<std::uint8_t> sent_;
  std::deque<std::uint8_t> to_receive_;
  bool feeding_ = false;
  std::size_t sent_limit_ = SIZE_MAX;
  std::uint64_t overruns_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t sent_bytes_ = 0;
  bool stop_requested_ = false;
  std::string last_message_;
  int starts_ = 1;
  std::uint64_t end_ = 0;
  std::uint64_t slept_ = 0;
  bool asleep_ = false;
  std::array<InterruptTimes, kVectors> interrupts_{};
  std::uint64_t ticks_ = 0;
  std::uint64_t busiest_ = 0;
  std::uint64_t shortest_ = UINT64_MAX;
  std::uint64_t longest_ = 0;
  std::uint64_t tick_cycle_ = 0;
  std::uint64_t tick_slept_ = 0;
  std::uint16_t paint_begin_ = 0;
};

}  // namespace screed::mcu
