// Recorded drives of the slip watch as files.
#pragma once

#include <filesystem>
#include <optional>

#include "nn/slip/slip_drive.h"

namespace screed::nn {

/// Name of the file of a scenario's drive: kind, seed and a hash of its experiment's text.
std::string archive_name(const StuckScenario& scenario);

/// The drive of that file; nothing when there is no such file. Throws InputError when the file is
/// of another format or cut short.
std::optional<SlipDrive> read_drive(const std::filesystem::path& file,
                                    const StuckScenario& scenario);
/// The file appears complete or not at all. Throws RunError when it cannot be written.
void write_drive(const std::filesystem::path& file, const SlipDrive& drive);

}  // namespace screed::nn
