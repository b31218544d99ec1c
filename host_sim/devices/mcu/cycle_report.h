// What was measured of the microcontroller's time while it ran. Plain data; needs no simavr.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace screed {

struct CycleReport {
  static constexpr std::uint64_t kTickCycles = 160'000;  ///< 10 ms at 16 MHz

  struct Interrupt {
    std::string name;
    std::uint64_t count = 0;
    std::uint64_t longest_cycles = 0;  ///< from the beginning of the response to the end of RETI
    double mean_cycles = 0.0;
  };

  std::uint64_t ticks = 0;
  /// From the timer event that wakes the program to its going to sleep, interrupts included.
  std::uint64_t longest_tick_cycles = 0;
  double mean_tick_cycles = 0.0;
  std::uint64_t missed_ticks = 0;  ///< timer events that met a tick still going on
  double load = 0.0;               ///< share of cycles not slept, 0..1
  std::vector<Interrupt> interrupts;
  /// From an edge at a pin to the first instruction of the interrupt's handler, worst case.
  std::uint64_t encoder_latency_cycles = 0;
  std::uint64_t encoder_edges = 0;   ///< that the tracks made, both sides
  std::int64_t encoder_missing = 0;  ///< counts the program is short of, both sides
  std::uint64_t uart_received = 0;
  std::uint64_t uart_overruns = 0;  ///< bytes lost by the receiver
  std::uint64_t uart_sent = 0;
  int resets = 0;
};

}  // namespace screed
