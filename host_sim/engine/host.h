// What the engine asks the machine and the operating system.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

/// The name of this machine; empty when it has none.
std::string host_name();
/// Time of a processor that this process has used, s.
double processor_s();
/// Most memory that this process had so far, MB.
double peak_memory_mb();

/// Makes a folder with those above it; it may be there. Throws RunError.
void make_folder(const std::filesystem::path& folder);

}  // namespace screed
