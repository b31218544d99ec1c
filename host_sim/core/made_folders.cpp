// Making and removing folders.
#include "host_sim/core/made_folders.h"

#include <system_error>

#include "host_sim/core/errors.h"

namespace screed {

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
