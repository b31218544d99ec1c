// A USB host, on simavr's USB module.
#include "tests/mcu/usb_host.h"

extern "C" {
#include <simavr/avr_usb.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_interrupts.h>
}

#include <algorithm>
#include <utility>

namespace screed::mcu {
namespace {

constexpr std::uint8_t kControl = 0;
constexpr std::uint8_t kToDevice = 2;
constexpr std::uint8_t kFromDevice = 3;
constexpr std::size_t kPacketSize = 64;
constexpr std::uint8_t kToHost = 0x80;
// USB 2.0, 9.2.6.4
constexpr double kDataTimeout_ms = 500;
constexpr double kStatusTimeout_ms = 50;
constexpr double kStep_ms = 0.05;

constexpr std::uint8_t kUsbGeneralVector = 10;
constexpr double kResetRecovery_ms = 10;  // USB 2.0, 7.1.7.5
constexpr std::uint16_t kUdaddr = 0xE3;
constexpr std::uint16_t kUdint = 0xE1;
constexpr std::uint16_t kUdien = 0xE2;
constexpr std::uint16_t kUeintx = 0xE8;
constexpr std::uint16_t kUenum = 0xE9;
constexpr std::uint8_t kSetupReceived = 1 << 3;
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

/// The device has not taken the last request yet. Until then the chip answers NAK at endpoint 0;
/// simavr 1.6 lets data overwrite the request.
bool request_is_pending(avr_t* avr) {
  const std::uint8_t selected = std::exchange(avr->data[kUenum], kControl);
  const auto& reader = avr->io[AVR_DATA_TO_IO(kUeintx)].r;
  const std::uint8_t flags = reader.c(avr, kUeintx, reader.param);
  avr->data[kUenum] = selected;
  return (flags & kSetupReceived) != 0;
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

UsbHost::Outcome UsbHost::write(std::uint8_t endpoint, std::vector<std::uint8_t> bytes,
                                double patience_ms) {
  for (double waited = 0; waited < patience_ms; waited += kStep_ms) {
    if (endpoint == kControl && request_is_pending(mcu_.simulator())) {
      run_step();
      continue;
    }
    avr_io_usb packet = {endpoint, static_cast<std::uint32_t>(bytes.size()), bytes.data()};
    const int result = avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_WRITE, &packet);
    run_step();
    if (result == AVR_IOCTL_USB_OK) return Outcome::kDone;
    if (result != AVR_IOCTL_USB_NAK) return Outcome::kStalled;
  }
  return Outcome::kNoAnswer;
}

UsbHost::Outcome UsbHost::read(std::uint8_t endpoint, std::vector<std::uint8_t>& bytes,
                               double patience_ms) {
  for (double waited = 0; waited < patience_ms; waited += kStep_ms) {
    if (endpoint == kControl && request_is_pending(mcu_.simulator())) {
      run_step();
      continue;
    }
    std::array<std::uint8_t, kPacketSize> buffer{};
    avr_io_usb packet = {endpoint, buffer.size(), buffer.data()};
    const int result = avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_READ, &packet);
    run_step();
    if (result == AVR_IOCTL_USB_OK) {
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + packet.sz);
      return Outcome::kDone;
    }
    if (result != AVR_IOCTL_USB_NAK) return Outcome::kStalled;
  }
  return Outcome::kNoAnswer;
}

/// Packets of an answer, until a short one or as many bytes as were asked for.
UsbHost::Outcome UsbHost::receive_data(const UsbRequest& request, std::vector<std::uint8_t>& data,
                                       Until until) {
  while (data.size() < request.length) {
    const std::size_t before = data.size();
    const Outcome outcome = read(kControl, data, kDataTimeout_ms);
    if (outcome != Outcome::kDone || until == Until::kFirstPacket) return outcome;
    if (data.size() - before < kPacketSize) break;
  }
  return Outcome::kDone;
}

UsbHost::Outcome UsbHost::transfer(const UsbRequest& request, std::vector<std::uint8_t>& data,
                                   Until until) {
  std::array<std::uint8_t, 8> bytes = {request.type,
                                       request.request,
                                       byte_of(request.value, 0),
                                       byte_of(request.value, 1),
                                       byte_of(request.index, 0),
                                       byte_of(request.index, 1),
                                       byte_of(request.length, 0),
                                       byte_of(request.length, 1)};
  avr_io_usb packet = {kControl, bytes.size(), bytes.data()};
  if (avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_SETUP, &packet) != AVR_IOCTL_USB_OK) {
    return Outcome::kNoAnswer;
  }
  run_step();
  if (until == Until::kSetup) return Outcome::kDone;
  const bool to_host = (request.type & kToHost) != 0 && request.length != 0;
  if (to_host) {
    data.clear();
    const Outcome outcome = receive_data(request, data, until);
    if (outcome != Outcome::kDone) return outcome;
  } else if (request.length != 0) {
    const Outcome outcome = write(kControl, data, kDataTimeout_ms);
    if (outcome != Outcome::kDone) return outcome;
  }
  if (until != Until::kEnd) return Outcome::kDone;
  std::vector<std::uint8_t> status;
  return to_host ? write(kControl, {}, kStatusTimeout_ms)
                 : read(kControl, status, kStatusTimeout_ms);
}

std::vector<std::uint8_t> UsbHost::ask(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                                       std::uint16_t length) {
  std::vector<std::uint8_t> bytes;
  if (transfer({type, request, value, 0, length}, bytes) != Outcome::kDone) return {};
  return bytes;
}

std::vector<std::uint8_t> UsbHost::descriptor(std::uint8_t type, std::uint8_t index,
                                              std::uint16_t length) {
  return ask(kToHost, 6, static_cast<std::uint16_t>(type << 8 | index), length);
}

UsbHost::Outcome UsbHost::tell(std::uint8_t type, std::uint8_t request, std::uint16_t value,
                               std::uint16_t index) {
  std::vector<std::uint8_t> none;
  return transfer({type, request, value, index, 0}, none);
}

void UsbHost::reset() {
  avr_ioctl(mcu_.simulator(), AVR_IOCTL_USB_RESET, nullptr);
  mcu_.simulator()->data[kUdaddr] = 0;  // by hardware (data sheet 22.7)
  plugged_ = true;
  run_ms(kResetRecovery_ms);
}

bool UsbHost::plug_in() {
  reset();
  // SET_ADDRESS, SET_CONFIGURATION
  return tell(0x00, 5, 1) == Outcome::kDone && tell(0x00, 9, 1) == Outcome::kDone;
}

bool UsbHost::set_line(std::uint32_t baud, bool open) {
  // SET_LINE_CODING: baud, one stop bit, no parity, 8 bits; SET_CONTROL_LINE_STATE: DTR.
  std::vector<std::uint8_t> coding = {
      byte_of(baud, 0), byte_of(baud, 1), byte_of(baud, 2), byte_of(baud, 3), 0, 0, 8};
  return transfer({0x21, 0x20, 0, 0, 7}, coding) == Outcome::kDone &&
         tell(0x21, 0x22, open ? 1 : 0) == Outcome::kDone;
}

bool UsbHost::send(const std::string& text) {
  return write(kToDevice, {text.begin(), text.end()}, kDataTimeout_ms) == Outcome::kDone;
}

std::string UsbHost::listen_ms(double ms) {
  std::vector<std::uint8_t> bytes;
  const double end = mcu_.time_ms() + ms;
  while (mcu_.time_ms() < end) read(kFromDevice, bytes, 1.0);
  return {bytes.begin(), bytes.end()};
}

}  // namespace screed::mcu
