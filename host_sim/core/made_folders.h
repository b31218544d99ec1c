// Folders that a task makes for its files: those that stay empty go again.
#pragma once

#include <filesystem>
#include <vector>

namespace screed {

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
