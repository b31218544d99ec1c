// What the device says of itself, in flash: a composite USB device with one function, a serial line
// (CDC, abstract control model). Class, interfaces and endpoints are those of the Arduino core, so
// that a host's driver does not notice which of the two is flashed.
//
// Sources: USB 2.0, 9.6; "Interface Association Descriptor" ECN; CDC 1.2, 5.2.3; PSTN 1.2, 5.3.
#pragma once

#include <avr/pgmspace.h>
#include <stdint.h>

#include "build_info.h"

namespace screed {
namespace avr {
namespace usb {

enum DescriptorType : uint8_t {
  kDeviceDescriptor = 1,
  kConfigurationDescriptor = 2,
  kStringDescriptor = 3,
};

// Endpoints by their number.
constexpr uint8_t kControl = 0;
constexpr uint8_t kNotification = 1;  // interrupt IN; nothing is ever sent
constexpr uint8_t kFromHost = 2;      // bulk OUT
constexpr uint8_t kToHost = 3;        // bulk IN
constexpr uint8_t kEndpoints = 4;

constexpr uint8_t kIn = 0x80;  // direction in an endpoint's address
constexpr uint8_t kPacketSize = 64;
constexpr uint8_t kNotificationSize = 16;

constexpr uint8_t kManufacturerIndex = 1;
constexpr uint8_t kProductIndex = 2;

constexpr uint8_t low(uint16_t value) {
  return static_cast<uint8_t>(value & 0xFFU);
}
constexpr uint8_t high(uint16_t value) {
  return static_cast<uint8_t>(value >> 8);
}

/// A string descriptor, without the zero behind the characters.
template <uint8_t kCharacters>
struct Text {
  uint8_t size;
  uint8_t type;
  char16_t characters[kCharacters];
};
template <uint8_t kSize>
constexpr Text<kSize - 1> text_of(const char16_t (&literal)[kSize]) {
  Text<kSize - 1> text = {sizeof(text), kStringDescriptor, {}};
  for (uint8_t i = 0; i < kSize - 1; ++i) text.characters[i] = literal[i];
  return text;
}

/// What GET_DESCRIPTOR finds in front of a descriptor.
struct Label {
  uint8_t index;  ///< index and type are the request's wValue
  uint8_t type;
  uint8_t size;  ///< bytes; 0: the end of all
};

/// All descriptors, one behind the other, each behind its label.
// clang-format off
const struct Descriptors {
  Label device_label;
  uint8_t device[18];
  Label configuration_label;
  uint8_t configuration[75];
  Label languages_label;
  uint8_t languages[4];
  Label manufacturer_label;
  decltype(text_of(u"" SCREED_USB_MANUFACTURER)) manufacturer;
  Label product_label;
  decltype(text_of(u"" SCREED_USB_PRODUCT)) product;
  Label end;
} kDescriptors PROGMEM = {
  {0, kDeviceDescriptor, sizeof(kDescriptors.device)},
  {
    sizeof(kDescriptors.device), kDeviceDescriptor,
    0x00, 0x02,        // USB 2.0
    0xEF, 0x02, 0x01,  // the function is described by an interface association
    kPacketSize,       // of endpoint 0
    low(SCREED_USB_VID), high(SCREED_USB_VID), low(SCREED_USB_PID), high(SCREED_USB_PID),
    0x00, 0x01,        // release 1.00
    kManufacturerIndex, kProductIndex, 0,  // no serial number
    1,                 // configuration
  },
  {0, kConfigurationDescriptor, sizeof(kDescriptors.configuration)},
  {
    9, kConfigurationDescriptor, sizeof(kDescriptors.configuration), 0,
    2, 1, 0,           // interfaces, number, no name
    0x80, 250,         // powered by the bus, 500 mA
    8, 11, 0, 2, 0x02, 0x02, 0x00, 0,    // interface association: interfaces 0 and 1
    9, 4, 0, 0, 1, 0x02, 0x02, 0x00, 0,  // interface 0: communication, abstract control model
    5, 0x24, 0x00, 0x10, 0x01,           // header: CDC 1.10
    5, 0x24, 0x01, 0x00, 1,              // call management: none
    4, 0x24, 0x02, 0x02,                 // abstract control: line coding and control line state
    5, 0x24, 0x06, 0, 1,                 // union: interface 0 controls 1
    7, 5, kIn | kNotification, 0x03, kNotificationSize, 0, 64,
    9, 4, 1, 0, 2, 0x0A, 0x00, 0x00, 0,  // interface 1: data
    7, 5, kFromHost, 0x02, kPacketSize, 0, 0,
    7, 5, kIn | kToHost, 0x02, kPacketSize, 0, 0,
  },
  {0, kStringDescriptor, sizeof(kDescriptors.languages)},
  {sizeof(kDescriptors.languages), kStringDescriptor, 0x09, 0x04},  // English
  {kManufacturerIndex, kStringDescriptor, sizeof(kDescriptors.manufacturer)},
  text_of(u"" SCREED_USB_MANUFACTURER),
  {kProductIndex, kStringDescriptor, sizeof(kDescriptors.product)},
  text_of(u"" SCREED_USB_PRODUCT),
  {0, 0, 0},
};
// clang-format on
static_assert(sizeof(kDescriptors.configuration) % kPacketSize != 0 &&
                  sizeof(kDescriptors.manufacturer) % kPacketSize != 0 &&
                  sizeof(kDescriptors.product) % kPacketSize != 0,
              "an answer of whole packets would need an empty one behind it");

}  // namespace usb
}  // namespace avr
}  // namespace screed
