// A pin of the ATmega32U4 as a type: every access becomes one sbi, cbi or sbis instruction.
#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace screed {
namespace avr {

/// Memory address of PINx; DDRx and PORTx follow it (data sheet, 31 "Register Summary").
enum Port : uint8_t { kPortB = 0x23, kPortC = 0x26, kPortD = 0x29, kPortE = 0x2C, kPortF = 0x2F };

template <Port kPort, uint8_t kBit>
struct Pin {
  static constexpr uint8_t kMask = static_cast<uint8_t>(1U << kBit);

  static void make_output() { _MMIO_BYTE(kPort + 1) |= kMask; }
  static void make_input() { _MMIO_BYTE(kPort + 1) &= static_cast<uint8_t>(~kMask); }
  /// As output: drives high. As input: pull-up on.
  static void set() { _MMIO_BYTE(kPort + 2) |= kMask; }
  /// As output: drives low. As input: pull-up off.
  static void clear() { _MMIO_BYTE(kPort + 2) &= static_cast<uint8_t>(~kMask); }
  static void write(bool high) {
    if (high) {
      set();
    } else {
      clear();
    }
  }
  /// What set() and clear() left.
  static bool is_driven_high() { return (_MMIO_BYTE(kPort + 2) & kMask) != 0; }
  static bool is_high() { return (_MMIO_BYTE(kPort) & kMask) != 0; }
};

}  // namespace avr
}  // namespace screed
