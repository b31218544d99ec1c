// A file descriptor that is closed when its owner goes, and waiting for one.
#pragma once

#include <unistd.h>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace screed {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
      reset();
      number_ = std::exchange(other.number_, -1);
    }
    return *this;
  }
  ~FileDescriptor() { reset(); }

  int get() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  void reset() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }

 private:
  int number_ = -1;
};

enum class Readiness { kNothing, kReadable, kBroken };

/// Waits until there is something to read. A descriptor of -1 is waited out.
Readiness wait_readable(int descriptor, std::chrono::milliseconds wait);

// A virtual serial port with this program in the place of the device behind it.

class PseudoTerminal {
 public:
  /// Makes the port; `link`, where given, is a symbolic link to it that is removed again. Throws
  /// InputError when the link cannot be made (a link to nothing is replaced, a file is not),
  /// RunError when the system has no pseudo terminals left.
  explicit PseudoTerminal(const std::optional<std::filesystem::path>& link = std::nullopt);
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal();

  /// "/dev/pts/3"
  const std::filesystem::path& device() const { return device_; }

  /// What the program at the port has written. Never waits.
  std::vector<uint8_t> read();
  /// Gives bytes to the program at the port. Never waits: where nobody reads, about 4 kB pile up
  /// and are then thrown away, so that a program that comes finds nothing old. Of a line (one ends
  /// with a carriage return) that loses its start or end this way the rest is left out, and what
  /// was already read of it is ended: the halves of two lines never make one.
  void write(std::span<const uint8_t> bytes);

 private:
  std::span<const uint8_t> after_line(std::span<const uint8_t> bytes);

  FileDescriptor master_;
  FileDescriptor slave_;  ///< held open, so that a reader may come and go
  std::filesystem::path device_;
  std::optional<std::filesystem::path> link_;
  bool mid_line_ = false;  ///< the last byte that was written is not the end of a line
  bool torn_ = false;      ///< the rest of a line is to be left out
};

}  // namespace screed
