// The fingerprint of a file, as a part of the identity of what is made from it.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

/// Of its bytes: 32 hexadecimal digits. A file is read once in a process. Throws InputError when it
/// cannot be read.
std::string file_hash(const std::filesystem::path& path);

}  // namespace screed
