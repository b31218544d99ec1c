// An ATmega32U4 with an image, simulated cycle by cycle by simavr: runs it, feeds and reads its
// pins and its serial line.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

struct avr_t;
struct avr_irq_t;

namespace screed::mcu {

constexpr std::uint64_t kClock_hz = 16'000'000;
constexpr std::uint16_t kRamBegin = 0x100;
constexpr std::uint16_t kRamEnd = 0xB00;  // one past the last byte

class Mcu {
 public:
  /// Throws std::runtime_error when the image cannot be read. RAM above `static_ram` bytes is
  /// painted to measure the stack.
  explicit Mcu(const std::string& elf_path, std::uint16_t static_ram = 0);
  ~Mcu();
  Mcu(const Mcu&) = delete;
  Mcu& operator=(const Mcu&) = delete;

  /// Runs for a time of the simulated clock, or until the program crashes or stops.
  void run_ms(double ms);
  /// Runs until the program has sent `bytes` bytes in all, has stopped, or `ms` have passed.
  void run_until_sent(std::size_t bytes, double ms);

  /// Neither crashed nor stopped.
  bool alive() const;
  /// Starts from the reset vector so far; 1 when all is well.
  int starts() const { return starts_; }
  double time_ms() const;

  /// Bytes sent over USART1 so far.
  const std::vector<std::uint8_t>& sent() const { return sent_; }
  /// Queues bytes for USART1; they arrive one character time apart.
  void receive(const std::vector<std::uint8_t>& bytes);
  std::size_t unreceived() const { return to_receive_.size(); }

  /// Level of an input pin.
  void set_pin(char port, int bit, bool high);
  /// Calls back at every change of an output pin.
  void watch_pin(char port, int bit, void (*on_change)(void* context), void* context);
  /// Voltage at an ADC channel.
  void set_adc_mv(int channel, int mv);

  /// The I2C transfer that runs goes no further: takes its interrupt away.
  void silence_twi();
  /// How often the program has driven the I2C clock low by hand.
  unsigned scl_pulses() const { return scl_pulses_; }

  /// Makes the program's main loop hang: the tick's interrupt returns without doing anything.
  void break_tick();

  std::uint8_t memory(std::uint16_t address) const;
  std::uint16_t word(std::uint16_t address) const;

  /// Bytes between the end of RAM and the lowest painted byte that was written.
  unsigned stack_used() const;

  /// Cycles not slept in the busiest control tick, and in all, since the last clear_load().
  std::uint64_t busiest_tick_cycles() const { return busiest_; }
  std::uint64_t ticks() const { return ticks_; }
  void clear_load();
  /// Cycles between two ticks, the least and the most.
  std::uint64_t shortest_tick() const { return shortest_; }
  std::uint64_t longest_tick() const { return longest_; }

  avr_t* simulator() { return avr_; }

 private:
  void step();
  void feed();
  void count_tick();
  static void on_sent(avr_irq_t* irq, std::uint32_t value, void* self);
  static void on_ready(avr_irq_t* irq, std::uint32_t value, void* self);
  static void on_full(avr_irq_t* irq, std::uint32_t value, void* self);
  static void on_direction(avr_irq_t* irq, std::uint32_t value, void* self);
  static void on_sleep(avr_t* avr, std::uint64_t cycles);
  static std::uint64_t on_end(avr_t* avr, std::uint64_t when, void* self);

  struct Watch {
    void (*on_change)(void* context);
    void* context;
    std::uint32_t level;
  };
  static void on_watched(avr_irq_t* irq, std::uint32_t value, void* watch);

  struct DrivenPins {
    std::uint8_t mask = 0;
    std::uint8_t value = 0;
  };

  avr_t* avr_ = nullptr;
  std::map<char, DrivenPins> driven_pins_;
  std::deque<Watch> watches_;  // elements stay in place when it grows
  bool scl_driven_ = false;
  unsigned scl_pulses_ = 0;
  avr_irq_t* uart_input_ = nullptr;
  std::vector<std::uint8_t> sent_;
  std::deque<std::uint8_t> to_receive_;
  bool uart_ready_ = true;
  int starts_ = 0;
  std::uint64_t end_ = 0;
  std::uint64_t slept_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint64_t busiest_ = 0;
  std::uint64_t shortest_ = UINT64_MAX;
  std::uint64_t longest_ = 0;
  std::uint64_t tick_cycle_ = 0;
  std::uint64_t tick_slept_ = 0;
  std::uint16_t paint_begin_ = 0;
};

}  // namespace screed::mcu
