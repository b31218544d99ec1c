// A file that appears under its name complete or not at all: written beside it and then renamed.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

/// The place of a file that is being made, for libraries that open files by their names: they write
/// to partial(), and commit() gives it the name `path`. What is not committed is removed at the end
/// of the object; whoever writes to it has closed it by then. Throws RunError, one line with the
/// path and the reason.
class PartialFile {
 public:
  explicit PartialFile(const std::filesystem::path& path);
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile();

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& partial() const { return partial_; }
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path partial_;
  bool committed_ = false;
};

/// A file of that name stays as it was until commit(), and for ever without it. Every function
/// throws RunError, one line with the path and the reason, when the file cannot be written: folder
/// missing, disk full, `path` is no regular file.
class AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  void write(std::string_view text);
  void write(std::span<const std::uint8_t> bytes);

  /// For libraries that write by themselves; what the stream refuses shows in commit() at the
  /// latest.
  std::FILE* stream() { return file_; }

  /// Gives the file its name.
  void commit();

 private:
  PartialFile partial_file_;
  std::FILE* file_ = nullptr;
};

/// A whole file at once.
void write_file(const std::filesystem::path& path, std::string_view text);

// A series of files that appears in its folder complete or not at all: written into a folder beside
// it and then moved.

/// Files of the same names in the folder stay as they were until commit(), and for ever without it.
/// Every function throws RunError, one line with the path and the reason.
class PartialFolder {
 public:
  /// `folder` exists. partial() lies in it, so that moving costs nothing.
  explicit PartialFolder(const std::filesystem::path& folder);
  PartialFolder(const PartialFolder&) = delete;
  PartialFolder& operator=(const PartialFolder&) = delete;
  ~PartialFolder();

  /// Where to write.
  const std::filesystem::path& partial() const { return partial_; }
  /// Moves every file that was written into the folder.
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path partial_;
};

// Folders that a task makes for its files: those that stay empty go again.

class MadeFolders {
 public:
  MadeFolders() = default;
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;
  /// Removes what was made and is empty.
  ~MadeFolders();

  /// Makes the folder, with the missing ones above it; one that exists stays as it is. Returns it.
  /// Throws RunError, one line with the path and the reason.
  std::filesystem::path make(const std::filesystem::path& folder);

 private:
  std::vector<std::filesystem::path> made_;  ///< outer ones first
};

}  // namespace screed
