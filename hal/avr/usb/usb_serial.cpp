// The image's own USB: a serial line (CDC, abstract control model), served by polling once a tick.
//
// What a host may want of a control transfer is done in steps, of which the hardware keeps the
// host waiting in between (it answers NAK): take the request; then send a packet of the answer, or
// take the packet of data that it announced, a step when the host has been there. Nothing waits:
// a host that breaks off leaves a stage that the next request, a bus reset or nobody ends. USB 2.0
// allows 500 ms to the first packet of an answer and 50 ms to a status stage (9.2.6.4); a step
// takes at most a tick, 10 ms. One thing has to come sooner: 2 ms after the status stage of
// SET_ADDRESS the new address counts. So that one is an interrupt, of 30 cycles.
//
// Sources: ATmega16U4/32U4 data sheet 21 and 22; USB 2.0, 9.3 and 9.4; PSTN 1.2, 6.3.
#include "hal/avr/usb_serial.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>

#include "hal/avr/reset_cause.h"
#include "hal/avr/usb/descriptors.h"
#include "hal/avr/watchdog.h"

namespace screed {
namespace avr {
namespace {

using namespace usb;

constexpr uint32_t kTouchBaud = 1200;
// Where the bootloader looks for its key, and what it is (Caterina).
constexpr uint16_t kBootKeyAddress = 0x0800;
constexpr uint16_t kBootKey = 0x7777;

// bmRequestType
constexpr uint8_t kClassRequest = 0x20;
constexpr uint8_t kToEndpoint = 0x02;

enum Request : uint8_t {
  kGetStatus = 0,
  kClearFeature = 1,
  kSetFeature = 3,
  kSetAddress = 5,
  kGetDescriptor = 6,
  kGetConfiguration = 8,
  kSetConfiguration = 9,
  kGetInterface = 10,
  kSetLineCoding = 0x20,
  kGetLineCoding = 0x21,
  kSetControlLineState = 0x22,
};

struct Setup {
  uint8_t type;
  uint8_t request;
  uint16_t value;
  uint16_t index;
  uint16_t length;
};

struct LineCoding {
  uint32_t baud;
  uint8_t stop_bits;
  uint8_t parity;
  uint8_t data_bits;
};
constexpr uint8_t kLineCodingSize = 7;
static_assert(sizeof(LineCoding) == kLineCodingSize, "as it travels");

// UECFG1X: room for 64 bytes, one bank. The notification endpoint could do with less.
constexpr uint8_t k64Bytes = _BV(EPSIZE1) | _BV(EPSIZE0) | _BV(ALLOC);

/// What is still to be done of a control transfer.
enum Stage : uint8_t {
  kNothing,
  kSending,     // packets of an answer
  kLineCoding,  // the host sends one
};

struct State {
  Stage stage;
  Setup setup;            // the request
  const uint8_t* answer;  // what is left of it
  uint8_t answer_left;
  bool answer_in_flash;
  uint8_t status[2];      // answer to GET_STATUS and GET_INTERFACE
  uint8_t configuration;  // 0: none
  bool open;              // a program has opened the line
  bool upload;            // the bootloader starts once the host knows that its request was heard
  LineCoding coding;
};
State state;

// Flags of UEINTX are cleared by a zero; ones change nothing.
void clear_flags(uint8_t flags) {
  UEINTX = static_cast<uint8_t>(~flags);
}

/// The status stage of a request that has no answer: an empty packet.
bool acknowledge() {
  clear_flags(_BV(TXINI));
  return true;
}

__attribute__((noinline)) bool answer(const void* bytes, uint8_t size) {
  state.stage = kSending;
  state.answer = static_cast<const uint8_t*>(bytes);
  state.answer_left = state.setup.length < size ? static_cast<uint8_t>(state.setup.length) : size;
  state.answer_in_flash = false;
  return true;
}

void send_packet() {
  const uint8_t* from = state.answer;
  uint8_t left = state.answer_left;
  uint8_t room = kPacketSize;
  for (; room > 0 && left > 0; --room, --left, ++from) {
    UEDATX = state.answer_in_flash ? pgm_read_byte(from) : *from;
  }
  state.answer = from;
  state.answer_left = left;
  clear_flags(_BV(TXINI));
  if (room > 0) state.stage = kNothing;
}

bool send_descriptor() {
  const auto* at = reinterpret_cast<const uint8_t*>(&kDescriptors);
  for (;;) {
    const uint16_t value = pgm_read_word(at);
    const uint8_t size = pgm_read_byte(at + 2);
    at += sizeof(Label);
    if (size == 0) return false;
    if (value == state.setup.value) {
      answer(at, size);
      state.answer_in_flash = true;
      return true;
    }
    at += size;
  }
}

/// type: UECFG0X.
__attribute__((noinline)) void start_endpoint(uint8_t endpoint, uint8_t type) {
  UENUM = endpoint;
  UECONX = _BV(EPEN);
  UECFG0X = type;
  UECFG1X = k64Bytes;
}

bool configure() {
  const auto configuration = static_cast<uint8_t>(state.setup.value);
  if (configuration > 1) return false;
  state.configuration = configuration;
  for (uint8_t endpoint = kEndpoints; --endpoint > kControl;) {
    UENUM = endpoint;
    UECONX = 0;
  }
  UENUM = kControl;
  if (configuration == 0) return acknowledge();
  start_endpoint(kNotification, _BV(EPTYPE1) | _BV(EPTYPE0) | _BV(EPDIR));
  start_endpoint(kFromHost, _BV(EPTYPE1));
  start_endpoint(kToHost, _BV(EPTYPE1) | _BV(EPDIR));
  UENUM = kControl;
  return acknowledge();
}

/// Halts an endpoint, lets it go on, or asks whether it is halted. False: there is none.
bool endpoint_request() {
  const auto endpoint = static_cast<uint8_t>(state.setup.index & 0x7FU);
  if (endpoint == kControl || endpoint >= kEndpoints) return false;
  UENUM = endpoint;
  if (state.setup.request == kSetFeature) UECONX = _BV(STALLRQ) | _BV(EPEN);
  if (state.setup.request == kClearFeature) UECONX = _BV(STALLRQC) | _BV(RSTDT) | _BV(EPEN);
  if ((UECONX & _BV(STALLRQ)) != 0) state.status[0] = 1;
  UENUM = kControl;
  return true;
}

bool class_request() {
  switch (state.setup.request) {
    case kSetLineCoding:
      state.stage = kLineCoding;
      return true;
    case kGetLineCoding:
      return answer(&state.coding, kLineCodingSize);
    case kSetControlLineState:
      state.open = (state.setup.value & 1U) != 0;
      state.upload = !state.open && state.coding.baud == kTouchBaud;
      return acknowledge();
    default:
      return false;
  }
}

/// False: not understood, the host gets a STALL.
bool execute() {
  const uint8_t type = state.setup.type;
  if ((type & kClassRequest) != 0) return class_request();
  state.status[0] = 0;
  const bool to_endpoint = (type & kToEndpoint) != 0;
  if (to_endpoint && !endpoint_request()) return false;
  switch (state.setup.request) {
    case kGetStatus:
      return answer(state.status, 2);
    case kClearFeature:
    case kSetFeature:
      return to_endpoint && acknowledge();
    case kSetAddress:
      UDADDR = static_cast<uint8_t>(state.setup.value);
      // The mask first: simavr forgets an interrupt whose cause was there before it. The cause that
      // is there now ends before an interrupt can come.
      cli();
      UEIENX = _BV(TXINE);
      acknowledge();
      sei();
      return true;
    case kGetDescriptor:
      return send_descriptor();
    case kGetConfiguration:
      return answer(&state.configuration, 1);
    case kSetConfiguration:
      return configure();
    case kGetInterface:
      return answer(state.status, 1);
    default:  // also SET_INTERFACE, which a device without alternatives may refuse
      return false;
  }
}

void receive(void* to, uint8_t size) {
  auto* at = static_cast<uint8_t*>(to);
  for (; size > 0; --size) *at++ = UEDATX;
}

void take_request() {
  receive(&state.setup, sizeof(state.setup));
  UEIENX = 0;
  clear_flags(_BV(RXSTPI) | _BV(RXOUTI));
  state.stage = kNothing;
  if (!execute()) UECONX = _BV(STALLRQ) | _BV(EPEN);
}

void take_data() {
  const bool coding = state.stage == kLineCoding && UEBCLX == kLineCodingSize;
  if (coding) receive(&state.coding, kLineCodingSize);
  clear_flags(_BV(RXOUTI));
  if (coding) acknowledge();
  state.stage = kNothing;  // anything else ends an answer
}

void attach() {
  USBCON = _BV(USBE) | _BV(OTGPADE);
  start_endpoint(kControl, 0);
  UDCON = 0;  // full speed, with its pull-up
}

void forget_host() {
  UDINT = static_cast<uint8_t>(UDINT & ~_BV(EORSTI));
  UENUM = kControl;
  UEIENX = 0;
  state.stage = kNothing;
  state.configuration = 0;
  state.open = false;
  state.upload = false;
}

void start_bootloader() {
  set_next_reset_cause(ResetCause::kUpload);
  cli();
  *reinterpret_cast<volatile uint16_t*>(kBootKeyAddress) = kBootKey;
  watchdog_reset_now();
}

}  // namespace

/// The status stage of SET_ADDRESS is over.
ISR(USB_COM_vect) {
  const uint8_t selected = UENUM;
  UENUM = kControl;
  UEIENX = 0;
  UDADDR |= _BV(ADDEN);
  UENUM = selected;
}

void usb_serial_init() {
  // The bootloader may have left everything switched on.
  USBCON = 0;
  UHWCON = _BV(UVREGE);
  USBCON = _BV(USBE) | _BV(FRZCLK);
  UDCON = _BV(DETACH);
  PLLCSR = _BV(PINDIV) | _BV(PLLE);  // 48 MHz of 16
  state.coding.baud = 115200;
  state.coding.data_bits = 8;
}

__attribute__((noinline)) void usb_serial_step() {
  if ((UDCON & _BV(DETACH)) != 0) {
    if ((PLLCSR & _BV(PLOCK)) != 0) attach();
    return;
  }
  if ((UDINT & _BV(EORSTI)) != 0) forget_host();
  UENUM = kControl;
  const uint8_t flags = UEINTX;
  if ((flags & _BV(RXSTPI)) != 0) {
    take_request();
  } else if ((flags & _BV(RXOUTI)) != 0) {
    take_data();
  }
  if ((UEINTX & _BV(TXINI)) == 0) return;
  if (state.stage == kSending) send_packet();
  if (state.upload) start_bootloader();
}

bool usb_serial_get(uint8_t& byte) {
  UENUM = kFromHost;
  if ((UEINTX & _BV(RXOUTI)) == 0) return false;
  const bool some = UEBCLX != 0;
  if (some) byte = UEDATX;
  if (UEBCLX == 0) clear_flags(_BV(FIFOCON) | _BV(RXOUTI));
  return some;
}

bool usb_serial_put(const uint8_t* bytes, uint8_t count) {
  // A closed line would be full after one packet, for ever.
  if (!state.open) return true;
  UENUM = kToHost;
  if ((UEINTX & _BV(TXINI)) == 0) return false;
  for (; count > 0; --count) UEDATX = *bytes++;
  clear_flags(_BV(FIFOCON) | _BV(TXINI));
  return true;
}

}  // namespace avr
}  // namespace screed
