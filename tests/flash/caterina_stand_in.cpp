#include "tests/flash/caterina_stand_in.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

namespace screed::flash {
namespace {

constexpr std::uint8_t kEscape = 27;
constexpr std::size_t kEepromSize = 1024;

}  // namespace

CaterinaStandIn::CaterinaStandIn() : CaterinaStandIn(Behaviour{}) {}

// The flash is not blank at first: an old sketch fills it, the bootloader its own section.
CaterinaStandIn::CaterinaStandIn(const Behaviour& behaviour)
    : behaviour_(behaviour), flash_(kFlashSize, 0x5A), eeprom_(kEepromSize, 0xE7) {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0)
    throw std::runtime_error("no pty");
  port_ = ptsname(master_);
  slave_ = open(port_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) throw std::runtime_error("no pty");
  cfmakeraw(&settings);
  tcsetattr(slave_, TCSANOW, &settings);
  if (pipe2(wake_, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  thread_ = std::thread([this] { run(); });
}

CaterinaStandIn::~CaterinaStandIn() {
  stop();
  for (const int file : {master_, slave_, wake_[0], wake_[1]}) close(file);
}

void CaterinaStandIn::stop() {
  if (!thread_.joinable()) return;
  [[maybe_unused]] const auto written = write(wake_[1], "", 1);
  thread_.join();
}

void CaterinaStandIn::run() {
  try {
    answer_commands();
  } catch (const Stopped&) {
  }
}

void CaterinaStandIn::answer_commands() {
  while (true) {
    const std::uint8_t command = next_byte();
    commands_ += static_cast<char>(command);
    if (behaviour_.dies_after_blocks && blocks_ >= *behaviour_.dies_after_blocks) continue;
    execute(command);
  }
}

void CaterinaStandIn::execute(std::uint8_t command) {
  switch (command) {
    case kEscape:
      return;
    case 'S':
      return say("CATERIN");
    case 'V':
      return say("10");
    case 'p':
      return say('S');
    case 'a':
      return say('Y');
    case 'b':
      say('Y');
      say(kPageSize >> 8);
      return say(kPageSize & 0xFF);
    case 't':
      say(0x44);
      return say(0x00);
    case 'T':
      next_byte();
      return say('\r');
    case 'P':
    case 'L':
    case 'E':
      return say('\r');
    case 's':
      for (std::size_t i = 3; i > 0; --i) say(behaviour_.signature[i - 1]);
      return;
    case 'A':
      address_ = std::uint32_t{next_word()} * 2;
      return say('\r');
    case 'e':
      erase_application();
      return say('\r');
    case 'g':
      return read_block();
    case 'B':
      return write_block();
    case 'F':
      return say(behaviour_.low_fuse);
    case 'N':
      return say(behaviour_.high_fuse);
    case 'Q':
      return say(behaviour_.extended_fuse);
    case 'r':
      return say(behaviour_.lock);
    default:
      return say('?');
  }
}

void CaterinaStandIn::erase_application() {
  std::fill_n(flash_.begin(), kBootSection, std::uint8_t{0xFF});
}

void CaterinaStandIn::read_block() {
  const std::uint16_t size = next_word();
  const std::uint8_t memory = next_byte();
  ++blocks_;
  if (memory == 'F') {
    for (unsigned i = 0; i < size; ++i) say(flash_[(address_ + i) % kFlashSize]);
    address_ += size;
  } else if (memory == 'E') {
    for (unsigned i = 0; i < size; ++i) say(eeprom_[(address_ / 2 + i) % kEepromSize]);
    address_ += size * 2U;
  } else {
    say('?');
  }
}

void CaterinaStandIn::write_block() {
  const std::uint16_t size = next_word();
  const std::uint8_t memory = next_byte();
  ++blocks_;
  if (memory != 'F' && memory != 'E') return say('?');
  std::vector<std::uint8_t> block(size);
  for (auto& byte : block) byte = next_byte();
  if (memory == 'F') {
    write_flash_page(address_, block);
    address_ += size;
  } else {
    for (unsigned i = 0; i < size; ++i) eeprom_[(address_ / 2 + i) % kEepromSize] = block[i];
    address_ += size * 2U;
  }
  say('\r');
}

// The page is erased and written as a whole; the lock bits keep the boot section as it is.
void CaterinaStandIn::write_flash_page(std::uint32_t start,
                                       const std::vector<std::uint8_t>& block) {
  if (start % kPageSize != 0 || block.size() > kPageSize) complaint_ = "a block is not one page";
  if (start >= kBootSection) {
    complaint_ = "a block for the boot section";
    return;
  }
  std::fill_n(flash_.begin() + start, kPageSize, std::uint8_t{0xFF});
  std::copy(block.begin(), block.end(), flash_.begin() + start);
  const auto worn = behaviour_.worn_address;
  if (worn && *worn >= start && *worn < start + kPageSize) flash_[*worn] = 0xFF;
}

std::uint8_t CaterinaStandIn::next_byte() {
  pollfd waits[2] = {{master_, POLLIN, 0}, {wake_[0], POLLIN, 0}};
  while (poll(waits, 2, -1) < 0) {
  }
  std::uint8_t byte = 0;
  // What has arrived is answered before the end.
  if ((waits[0].revents & POLLIN) == 0 || read(master_, &byte, 1) != 1) throw Stopped{};
  return byte;
}

std::uint16_t CaterinaStandIn::next_word() {
  const unsigned high = next_byte();
  return static_cast<std::uint16_t>(high << 8 | next_byte());
}

void CaterinaStandIn::say(std::uint8_t byte) {
  if (write(master_, &byte, 1) != 1) throw Stopped{};
}

void CaterinaStandIn::say(const std::string& bytes) {
  for (const char byte : bytes) say(static_cast<std::uint8_t>(byte));
}

}  // namespace screed::flash
