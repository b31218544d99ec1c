// A stand-in for the board's bootloader: speaks avr109 on a pty as Caterina does, and fails on
// request.
//
// Behaviour after Atmel's application note AVR109 and what Caterina answers (Arduino AVR core,
// bootloaders/caterina): no command 'v', software id "CATERIN", device code 0x44, blocks of one
// page.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace screed::flash {

class CaterinaStandIn {
 public:
  static constexpr std::uint32_t kFlashSize = 32768;
  static constexpr std::uint32_t kBootSection = 0x7000;
  static constexpr std::uint32_t kPageSize = 128;

  struct Behaviour {
    std::array<std::uint8_t, 3> signature = {0x1E, 0x95, 0x87};  ///< ATmega32U4
    /// The bits of this byte of flash cannot be written.
    std::optional<std::uint32_t> worn_address;
    /// It answers this many blocks and then nothing any more.
    std::optional<unsigned> dies_after_blocks;
    std::uint8_t low_fuse = 0xFF;
    std::uint8_t high_fuse = 0xD0;
    std::uint8_t extended_fuse = 0xF8;  ///< bits 4 to 7 do not exist and read as 1
    std::uint8_t lock = 0xEF;
  };

  CaterinaStandIn();
  explicit CaterinaStandIn(const Behaviour& behaviour);
  ~CaterinaStandIn();
  CaterinaStandIn(const CaterinaStandIn&) = delete;
  CaterinaStandIn& operator=(const CaterinaStandIn&) = delete;

  /// The port to open.
  std::filesystem::path port() const { return port_; }

  /// Ends the bootloader, then what it holds can be looked at.
  void stop();
  const std::vector<std::uint8_t>& flash() const { return flash_; }
  const std::vector<std::uint8_t>& eeprom() const { return eeprom_; }
  /// Every command byte in the order of arrival.
  const std::string& commands() const { return commands_; }
  /// What a real one would have come to harm by; empty when all was well.
  const std::string& complaint() const { return complaint_; }

 private:
  struct Stopped {};

  void run();
  void answer_commands();
  void execute(std::uint8_t command);
  void read_block();
  void write_block();
  void write_flash_page(std::uint32_t start, const std::vector<std::uint8_t>& block);
  void erase_application();

  std::uint8_t next_byte();  // throws Stopped
  std::uint16_t next_word();
  void say(std::uint8_t byte);
  void say(const std::string& bytes);

  Behaviour behaviour_;
  int master_ = -1;
  int slave_ = -1;  // held open: without any opener a pty's other side reads errors
  int wake_[2] = {-1, -1};
  std::filesystem::path port_;
  std::vector<std::uint8_t> flash_;
  std::vector<std::uint8_t> eeprom_;
  std::uint32_t address_ = 0;  // in bytes of flash; twice the address in EEPROM
  unsigned blocks_ = 0;
  std::string commands_;
  std::string complaint_;
  std::thread thread_;
};

}  // namespace screed::flash
