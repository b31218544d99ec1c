#include "host_sim/ground_station/station/key_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "host_sim/core/errors.h"

namespace screed {

CommandKey read_key_file(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) {
    throw InputError(file.string() + ": " + std::strerror(errno) +
                     "; screed key makes a key and gives it to the robot");
  }
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw InputError(file.string() + ": cannot be read, or empty");
  const CommandKey key = parse_key(line, file.string() + ":1");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw InputError(file.string() + ": others may use this key; run chmod 600 " + file.string());
  }
  return key;
}

void write_key_file(const std::filesystem::path& file, const CommandKey& key) {
  const std::string text = key_text(key) + "\n";
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL, S_IRUSR | S_IWUSR);
  if (descriptor < 0) {
    throw InputError(file.string() + ": " + std::strerror(errno) +
                     (errno == EEXIST ? "; a key is never overwritten" : ""));
  }
  const bool written =
      write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
      fsync(descriptor) == 0;
  if (close(descriptor) != 0 || !written) {
    unlink(file.c_str());
    throw RunError(file.string() + ": cannot be written completely");
  }
}

}  // namespace screed
