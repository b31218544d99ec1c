// A USB host, on simavr's USB module.
#include "tests/mcu/usb_host.h"

extern "C" {
#include <simavr/avr_usb.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_interrupts.h>
}

#include <algorithm>

namespace screed::mcu {
namespace {

constexpr std::uint8_t kControl = 0;
constexpr std::uint8_t kToDevice = 2;    // CDC_ENDPOINT_OUT of the Arduino core
constexpr std::uint8_t kFromDevice = 3;  // CDC_ENDPOINT_IN
constexpr double kAnswerTimeout_ms = 20;
constexpr double kStep_ms = 0.05;

constexpr std::uint8_t kUsbGeneralVector = 10;
constexpr std::uint16_t kUdint = 0xE1;
constexpr std::uint16_t kUdien = 0xE2;
constexpr std::uint8_t kStartOfFrame = 1 << 2;

void start_frame(avr_t* avr) {
  avr->data[kUdint] |= kStartOfFrame;
  if ((avr->data[kUdien] & kStartOfFrame) == 0) return;
  const auto end = avr->interrupts.vector + avr->interrupts.vector_count;
  const auto general = std::find_if(avr->interrupts.vector, end, [](const avr_int_vector_t* it) {
    return it->vector == kUsbGeneralVector;
  });
  if (general != end) avr_raise_interrupt(avr, *general);
}

std::uint8_t byte_of(std::uint32_t value, int index) {
  return static_cast<std::uint8_t>(value >> 8 * index & 0xFF);
}

}  // namespace

void UsbHost::run_step() {
  mcu_.run_ms(kStep_ms);
  if (!plugged_ || mcu_.time_ms() < next_frame_ms_) return;
  next_frame_ms_ = mcu_.time_ms() + 1.0;
  start_frame(mcu_.simulator());
}

void UsbHost::run_ms(double ms) {
  const double end = mcu_.time_ms() + ms;
  while (mcu_.time_ms() < end) run_step();
}

bool UsbHost::setup(const Setup& request) {
  Setup bytes = request;
  avr_io_usb packet = {kControl, bytes.size(), bytes.data()};
  if (avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_SETUP, &packet) != AVR_IOCTL_USB_OK) return false;
  run_step();
  return mcu_.alive();
}

bool UsbHost::write(std::uint8_t endpoint, std::vector<std::uint8_t> bytes) {
  for (double waited = 0; waited < kAnswerTimeout_ms; waited += kStep_ms) {
    avr_io_usb packet = {endpoint, static_cast<std::uint32_t>(bytes.size()), bytes.data()};
    const int result = avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_WRITE, &packet);
    run_step();
    if (result == AVR_IOCTL_USB_OK) return true;
    if (result != AVR_IOCTL_USB_NAK) return false;
  }
  return false;
}

bool UsbHost::read(std::uint8_t endpoint, std::vector<std::uint8_t>& bytes, double patience_ms) {
  for (double waited = 0; waited < patience_ms; waited += kStep_ms) {
    std::array<std::uint8_t, 64> buffer{};
    avr_io_usb packet = {endpoint, buffer.size(), buffer.data()};
    const int result = avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_READ, &packet);
    run_step();
    if (result == AVR_IOCTL_USB_OK) {
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + packet.sz);
      return true;
    }
    if (result != AVR_IOCTL_USB_NAK) return false;
  }
  return false;
}

bool UsbHost::plug_in() {
  avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_RESET, nullptr);
  plugged_ = true;
  run_ms(5);
  std::vector<std::uint8_t> status;
  // SET_ADDRESS 1, SET_CONFIGURATION 1
  if (!setup({0x00, 5, 1, 0, 0, 0, 0, 0}) || !read(kControl, status, kAnswerTimeout_ms))
    return false;
  return setup({0x00, 9, 1, 0, 0, 0, 0, 0}) && read(kControl, status, kAnswerTimeout_ms);
}

std::vector<std::uint8_t> UsbHost::device_descriptor() {
  std::vector<std::uint8_t> bytes;
  // GET_DESCRIPTOR device, 18 bytes
  if (!setup({0x80, 6, 0, 1, 0, 0, 18, 0}) || !read(kControl, bytes, kAnswerTimeout_ms)) return {};
  write(kControl, {});
  return bytes;
}

bool UsbHost::set_line(std::uint32_t baud, bool open) {
  std::vector<std::uint8_t> status;
  // SET_LINE_CODING: baud, one stop bit, no parity, 8 bits; SET_CONTROL_LINE_STATE: DTR.
  const std::vector<std::uint8_t> coding = {
      byte_of(baud, 0), byte_of(baud, 1), byte_of(baud, 2), byte_of(baud, 3), 0, 0, 8};
  if (!setup({0x21, 0x20, 0, 0, 0, 0, 7, 0}) || !write(kControl, coding)) return false;
  read(kControl, status, kAnswerTimeout_ms);
  if (!setup({0x21, 0x22, static_cast<std::uint8_t>(open ? 1 : 0), 0, 0, 0, 0, 0})) return false;
  read(kControl, status, kAnswerTimeout_ms);
  return true;
}

bool UsbHost::send(const std::string& text) {
  return write(kToDevice, {text.begin(), text.end()});
}

std::string UsbHost::listen_ms(double ms) {
  std::vector<std::uint8_t> bytes;
  const double end = mcu_.time_ms() + ms;
  while (mcu_.time_ms() < end) read(kFromDevice, bytes, 1.0);
  return {bytes.begin(), bytes.end()};
}

}  // namespace screed::mcu
