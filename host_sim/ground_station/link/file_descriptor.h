// A file descriptor that is closed when its owner goes, and waiting for one.
#pragma once

#include <unistd.h>

#include <chrono>
#include <utility>

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

}  // namespace screed
