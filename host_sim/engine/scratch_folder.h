// A folder for what is not kept, beside all others' temporary files; gone with its owner.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

class ScratchFolder {
 public:
  /// `purpose` is part of the name: letters and -. One of each purpose in a process. Removes those
  /// of the same purpose whose processes of this machine were killed. Makes no folder yet.
  explicit ScratchFolder(const std::string& purpose);
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  /// Removes it with everything in it.
  ~ScratchFolder() { clear(); }

  const std::filesystem::path& path() const { return path_; }
  void clear() const;

 private:
  std::filesystem::path path_;
};

}  // namespace screed
