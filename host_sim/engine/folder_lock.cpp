// A lock of the kernel on a file, which a killed process does not keep.
#include "host_sim/engine/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "host_sim/core/errors.h"
#include "host_sim/engine/host.h"

namespace screed {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& busy) {
  make_folder(folder);
  const std::filesystem::path path = folder / "lock";
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

}  // namespace screed
