// Plans, locks, folders for a while, fingerprints, calls of the operating system.
#include "host_sim/engine/task_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <system_error>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"

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

void read_plan_file(const fs::path& file, const PlanFormat& format,
                    const std::function<void(const Json&)>& take) {
  const auto refuse = [&](const std::string& why) { throw InputError(file.string() + ": " + why); };
  const std::string what = format.what;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse("no such file: this is no folder of a " + what);
  const Json json = Json::parse_or_null(stream);
  if (!json.is_object() || json.value("format", "") != format.format)
    refuse("is not the plan of a " + what + ", or is damaged");
  if (json.value("format_version", 0) != format.version) refuse("is of another version of Screed");
  try {
    take(json);
  } catch (const JsonError&) {
    refuse("the plan of the " + what + " is damaged");
  }
}

// A lock of the kernel on a file: a killed process does not keep it.
FolderLock::FolderLock(const fs::path& folder, const std::string& busy) {
  make_folder(folder);
  const fs::path path = folder / "lock";
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw RunError(path.string() + ": cannot be written: " + std::strerror(errno));
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  close(descriptor_);
  throw InputError(folder.string() + ": " + busy);
}

FolderLock::~FolderLock() {
  close(descriptor_);
}

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

std::string file_hash(const fs::path& path) {
  static std::map<fs::path, std::string> known;
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  const auto entry = known.find(path);
  if (entry != known.end()) return entry->second;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string() + ": cannot be read");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  ContentHash hash;
  hash.add(text);
  return known.emplace(path, hash.hex()).first->second;
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

double peak_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw RunError(folder.string() + ": cannot be made: " + error.message());
}

}  // namespace screed
