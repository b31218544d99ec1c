// Folders named after machine and process.
#include "host_sim/engine/scratch_folder.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <system_error>

#include "host_sim/engine/host.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// Removes the folders of processes of this machine that are gone.
void remove_left(const std::string& prefix) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::temp_directory_path(), error)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with(prefix)) continue;
    pid_t process = 0;
    const char* end = name.data() + name.size();
    const auto [stop, reason] = std::from_chars(name.data() + prefix.size(), end, process);
    if (reason != std::errc() || stop != end || process <= 0) continue;
    if (kill(process, 0) == 0 || errno != ESRCH) continue;
    std::error_code ignored;
    fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace

ScratchFolder::ScratchFolder(const std::string& purpose) {
  const std::string prefix = "screed-" + purpose + "-" + host_name() + "-";
  remove_left(prefix);
  path_ = fs::temp_directory_path() / (prefix + std::to_string(getpid()));
  clear();
}

void ScratchFolder::clear() const {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace screed
