// A series of files that appears in its folder complete or not at all: written into a folder beside
// it and then moved.
#pragma once

#include <filesystem>

namespace screed {

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

}  // namespace screed
