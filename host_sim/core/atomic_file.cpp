// Writing beside, then renaming.
#include "host_sim/core/atomic_file.h"

#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

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

// Writing beside, then moving.

namespace fs = std::filesystem;

// The process number keeps two programs that write the same series apart.
PartialFolder::PartialFolder(const fs::path& folder)
    : folder_(folder), partial_(folder / (std::to_string(getpid()) + ".partial")) {
  std::error_code error;
  fs::create_directory(partial_, error);
  if (error) throw RunError(partial_.string() + ": cannot create the folder: " + error.message());
}

PartialFolder::~PartialFolder() {
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void PartialFolder::commit() {
  std::error_code error;
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(partial_))
    files.push_back(entry.path());
  for (const fs::path& file : files) {
    const fs::path to = folder_ / file.filename();
    fs::rename(file, to, error);
    if (error) throw RunError(to.string() + ": cannot be written: " + error.message());
  }
}

// Making and removing folders.

namespace fs = std::filesystem;

MadeFolders::~MadeFolders() {
  std::error_code not_empty;
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) {
    fs::remove(*folder, not_empty);
  }
}

fs::path MadeFolders::make(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path it = folder; !it.empty() && !fs::exists(it, error); it = it.parent_path()) {
    missing.push_back(it);
  }
  for (auto it = missing.rbegin(); it != missing.rend(); ++it) {
    if (fs::create_directory(*it, error)) made_.push_back(*it);
  }
  if (std::error_code unreadable; !fs::is_directory(folder, unreadable)) {
    throw RunError(folder.string() + ": cannot create the folder" +
                   (error ? ": " + error.message() : ""));
  }
  return folder;
}

}  // namespace screed
