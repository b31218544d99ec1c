// A virtual serial port with this program in the place of the device behind it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/ground_station/link/file_descriptor.h"

namespace screed {

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
