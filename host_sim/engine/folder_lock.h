// Only one process at a time executes the tasks of a folder on one machine.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

class FolderLock {
 public:
  /// Makes the folder, and the file `lock` in it. Throws InputError, "FOLDER: `busy`", when another
  /// process has the lock, RunError when the folder cannot be written.
  FolderLock(const std::filesystem::path& folder, const std::string& busy);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  /// The end of the process, however it comes, gives the lock back as well.
  ~FolderLock();

 private:
  int descriptor_ = -1;
};

}  // namespace screed
