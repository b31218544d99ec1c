// Fingerprints of files, remembered, since many tasks share a file.
#include "host_sim/engine/file_hash.h"

#include <fstream>
#include <iterator>
#include <map>
#include <mutex>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"

namespace screed {

std::string file_hash(const std::filesystem::path& path) {
  static std::map<std::filesystem::path, std::string> known;
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

}  // namespace screed
