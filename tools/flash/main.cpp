// screed_flash: brings an image onto the robot's board over USB, and checks the board's fuses. A
// program of its own, not a part of `screed`: it needs neither the simulator nor its libraries, so
// a machine beside the robot builds it in seconds.
#include <iostream>
#include <string>

#include "host_sim/core/errors.h"
#include "tools/command_line/program.h"
#include "tools/flash/avrdude.h"
#include "tools/flash/board_port.h"
#include "tools/flash/clock.h"
#include "tools/flash/fuses.h"
#include "tools/flash/usb_serial.h"

namespace {

using screed::InputError;
using screed::RunError;
namespace flash = screed::flash;

struct Options {
  std::string sketch_usb = "1ffb:2300";
  std::string bootloader_usb = "1ffb:0101";
  std::string port;
  std::string image;
  std::string low = "0xFF";
  std::string high = "0xD0";
  std::string extended = "0xC8";
  std::string lock = "0xEF";
  bool write_fuses = false;
  double idle_timeout_s = 8.0;
  double touch_s = 5.0;
  flash::SystemRoots roots;
  flash::Avrdude avrdude;
};

flash::BoardUsb board_usb(const Options& options) {
  return {flash::parse_usb_id(options.sketch_usb), flash::parse_usb_id(options.bootloader_usb)};
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::chrono::milliseconds::rep>(seconds * 1e3));
}

/// Finds the board and brings it into its bootloader; `avrdude` then talks to it there.
void connect_to_bootloader(const Options& options, flash::Avrdude& avrdude) {
  const auto usb = board_usb(options);
  const auto board = flash::find_board(options.roots, usb, options.port);
  flash::Timeouts timeouts;
  timeouts.after_touch = milliseconds(options.touch_s);
  const auto tell = [](const std::string& line) { std::cout << line << std::endl; };
  const auto port =
      flash::bootloader_port(board, options.roots, usb, timeouts, flash::machine_clock(), tell);
  avrdude.programmer = flash::kBootloaderProtocol;
  avrdude.port = port.string();
}

void write_image(const Options& options) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.image, error))
    throw InputError("no image " + options.image + ": make firmware builds it");
  flash::Avrdude avrdude = options.avrdude;
  connect_to_bootloader(options, avrdude);
  std::cout << "writing " << options.image << " through " << avrdude.port << std::endl;
  const unsigned bytes = flash::write_flash(avrdude, options.image);
  std::cout << bytes << " bytes written and verified; the board starts them now\n";
}

void print_port(const Options& options) {
  std::cout << flash::find_board(options.roots, board_usb(options), options.port).device.string()
            << "\n";
}

void compare_fuses(const flash::Fuses& wanted, const flash::Fuses& found) {
  std::string wrong;
  for (const auto& fuse : flash::kFuseBytes) {
    const auto value = [&](const flash::Fuses& fuses) {
      return flash::hex_byte(fuses.*fuse.member);
    };
    std::cout << fuse.name << " fuse: should be " << value(wanted) << ", is " << value(found)
              << "\n";
    if (!flash::same(fuse, wanted, found))
      wrong += (wrong.empty() ? "" : ", ") + std::string(fuse.name);
  }
  if (!wrong.empty()) throw RunError("the board's fuses differ from what they should be: " + wrong);
  std::cout << "the fuses are right (bits that do not exist read as 1)\n";
}

void fuses(const Options& options) {
  const flash::Fuses wanted = {flash::parse_hex_byte(options.low, "low fuse"),
                               flash::parse_hex_byte(options.high, "high fuse"),
                               flash::parse_hex_byte(options.extended, "extended fuse"),
                               flash::parse_hex_byte(options.lock, "lock byte")};
  flash::Avrdude avrdude = options.avrdude;
  const bool through_bootloader = avrdude.programmer == flash::kBootloaderProtocol;
  if (options.write_fuses && avrdude.programmer.empty())
    throw InputError("WRITE=yes needs PROGRAMMER=..., an ISP programmer that avrdude knows");
  if (options.write_fuses && through_bootloader)
    throw InputError(
        "PROGRAMMER=avr109, the bootloader, can read fuses but not write them: that takes "
        "an ISP programmer");
  if (avrdude.programmer.empty()) {
    avrdude.programmer = "PROGRAMMER";
    std::cout << flash::explanation(wanted) << "\nto write them with an ISP programmer:\n  "
              << flash::fuse_command(avrdude, wanted)
              << "\nto compare them with the board's, which writes nothing: PROGRAMMER=avr109 (the "
                 "bootloader, over USB) or an ISP programmer's name\n";
    return;
  }
  if (through_bootloader) {
    connect_to_bootloader(options, avrdude);
  } else {
    avrdude.port = options.port;
  }
  if (options.write_fuses) flash::write_fuses(avrdude, wanted);
  compare_fuses(wanted, flash::read_fuses(avrdude));
}

void add_usb_options(screed::Command& command, Options& options) {
  command
      .add_option("--sketch-usb", options.sketch_usb, "USB id of the board while its sketch runs")
      ->show_default();
  command
      .add_option("--bootloader-usb", options.bootloader_usb, "USB id of the board's bootloader")
      ->show_default();
  command.add_option("--port", options.port, "Serial port (default: search for the board on USB)");
  command.add_option("--sys", options.roots.sys, "Directory of the kernel's devices")
      ->show_default();
  command.add_option("--dev", options.roots.dev, "Directory of the device files")->show_default();
}

void add_avrdude_options(screed::Command& command, Options& options) {
  add_usb_options(command, options);
  command.add_option("--mcu", options.avrdude.mcu, "avrdude's name of the microcontroller")
      ->required();
  command.add_option("--avrdude", options.avrdude.program, "Path of the avrdude program")
      ->show_default();
  command
      .add_option("--idle-timeout", options.idle_timeout_s,
                  "Time without output after which avrdude is terminated [s]")
      ->range(0.1, 600.0)
      ->show_default();
  command
      .add_option("--touch-wait", options.touch_s,
                  "Time to wait for the bootloader after each 1200 baud touch [s]")
      ->range(0.1, 600.0)
      ->show_default();
  command.add_flag("--verbose", options.avrdude.show_output, "Show avrdude's output");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  screed::Command app("Flashes the robot's board over USB", "screed_flash");

  auto* write = app.add_subcommand(
      "write", "Find the board, start its bootloader, write and verify an image");
  write->add_option("image", options.image, "Intel HEX file to write")->required();
  add_avrdude_options(*write, options);

  auto* port = app.add_subcommand("port", "Print the board's serial port");
  add_usb_options(*port, options);

  auto* fuse =
      app.add_subcommand("fuses", "Print the board's fuses, or compare them with given values");
  add_avrdude_options(*fuse, options);
  fuse->add_option("--low", options.low, "Expected low fuse byte (hexadecimal)")->show_default();
  fuse->add_option("--high", options.high, "Expected high fuse byte (hexadecimal)")->show_default();
  fuse->add_option("--extended", options.extended, "Expected extended fuse byte (hexadecimal)")
      ->show_default();
  fuse->add_option("--lock", options.lock, "Expected lock byte (hexadecimal)")->show_default();
  fuse->add_option("--programmer", options.avrdude.programmer,
                   "avrdude's name of an ISP programmer, or avr109 for the bootloader");
  fuse->add_flag("--write", options.write_fuses, "Write the fuses before comparing");

  void (*action)(const Options&) = nullptr;
  write->callback([&] { action = write_image; });
  port->callback([&] { action = print_port; });
  fuse->callback([&] { action = fuses; });
  return screed::run_program(app, argc, argv, [&] {
    options.avrdude.idle_timeout = milliseconds(options.idle_timeout_s);
    action(options);
    return 0;
  });
}
