// Runs a command with a limit of processor time.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace screed::mutants {

struct Ended {
  bool good;  ///< with exit code 0
  bool out_of_time;
  std::string said;  ///< both streams, the last part of them
};

/// `limit_s` of processor time, 0 for none. Its children are ended with it. `output` is a file that
/// it may overwrite.
Ended run(const std::vector<std::string>& command,
          const std::map<std::string, std::string>& environment, double limit_s,
          const std::filesystem::path& output);

}  // namespace screed::mutants
