// Open file description locks (fcntl): of another kind than HDF5's own (flock), so that the two do
// not meet, and one that can be asked about without taking it.
#include "host_sim/run/session/session_turns.h"

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

// Bytes of the file that the locks are on: whoever has the turn, and the writer for its life.
constexpr off_t kTurn = 0;
constexpr off_t kWriting = 1;

struct flock lock_of(off_t byte, short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte;
  lock.l_len = 1;
  return lock;
}

void set_lock(int file, off_t byte, short type) {
  struct flock lock = lock_of(byte, type);
  while (fcntl(file, F_OFD_SETLKW, &lock) != 0 && errno == EINTR) {
  }
}

}  // namespace

bool is_being_written(const std::filesystem::path& file) {
  const int opened = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (opened < 0) return false;
  struct flock lock = lock_of(kWriting, F_WRLCK);
  const bool asked = fcntl(opened, F_OFD_GETLK, &lock) == 0;
  close(opened);
  return asked && lock.l_type != F_UNLCK;
}

SessionTurns::SessionTurns(const std::filesystem::path& file, bool writes)
    : path_(file),
      writes_(writes),
      file_(open(file.c_str(), (writes ? O_RDWR : O_RDONLY) | O_CLOEXEC)) {
  if (file_ < 0) throw RunError(path_.string() + ": cannot be opened: " + std::strerror(errno));
  if (writes) set_lock(file_, kWriting, F_WRLCK);
}

SessionTurns::~SessionTurns() {
  close(file_);
}

void SessionTurns::lock() {
  set_lock(file_, kTurn, writes_ ? F_WRLCK : F_RDLCK);
}

void SessionTurns::unlock() {
  set_lock(file_, kTurn, F_UNLCK);
}

std::vector<char> SessionTurns::bytes() const {
  std::vector<char> all(std::filesystem::file_size(path_));
  std::ifstream(path_, std::ios::binary).read(all.data(), static_cast<std::streamsize>(all.size()));
  return all;
}

}  // namespace screed
