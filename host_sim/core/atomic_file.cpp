// Writing beside, then renaming.
#include "host_sim/core/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_write(const fs::path& path, const std::string& reason) {
  throw RunError(path.string() + ": cannot be written: " + reason);
}

}  // namespace

// The process number keeps two programs that write the same file apart.
PartialFile::PartialFile(const fs::path& path)
    : path_(path), partial_(path.string() + "." + std::to_string(getpid()) + ".partial") {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    cannot_write(path, "is not a regular file");
  }
}

PartialFile::~PartialFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(partial_, ignored);
}

void PartialFile::commit() {
  std::error_code error;
  fs::rename(partial_, path_, error);
  if (error) cannot_write(path_, error.message());
  committed_ = true;
}

AtomicFile::AtomicFile(const fs::path& path)
    : partial_file_(path), file_(std::fopen(partial_file_.partial().c_str(), "wb")) {
  if (file_ == nullptr) cannot_write(path, std::strerror(errno));
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) static_cast<void>(std::fclose(file_));
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    cannot_write(partial_file_.path(), std::strerror(errno));
  }
}

void AtomicFile::write(std::span<const std::uint8_t> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) {
    cannot_write(partial_file_.path(), std::strerror(errno));
  }
}

void AtomicFile::commit() {
  const bool refused = std::ferror(file_) != 0;
  const int closed = std::fclose(file_);  // also flushes: a full disk may show only here
  const int reason = errno;
  file_ = nullptr;
  if (closed != 0) cannot_write(partial_file_.path(), std::strerror(reason));
  if (refused) cannot_write(partial_file_.path(), "the disk did not take all of it");
  partial_file_.commit();
}

void write_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace screed
