// Writing beside, then moving.
#include "host_sim/core/partial_folder.h"

#include <unistd.h>

#include <string>
#include <system_error>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {

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

}  // namespace screed
