// The files of a run beside its session: their names, and who makes them when.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed {

/// The log of the telemetry (candump -L text). A world is built with its stream before any file may
/// exist; what is written before open() is lost.
class TelemetryLog {
 public:
  std::ostream& stream() { return file_; }
  /// Throws RunError when the file cannot be made.
  void open(const std::filesystem::path& path);
  /// Throws RunError when not everything written has reached the file.
  void close();

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

/// A run's folder. Without commit() it disappears with this object, and all files in it.
class RunFiles {
 public:
  /// Makes the folder that the options ask for, with experiment.ini and the folders of its robots
  /// in it. Throws as RunFolder.
  RunFiles(const Experiment& experiment, const SimulationOptions& options);

  /// Where to write now.
  const std::filesystem::path& folder() const { return folder_.path(); }
  std::filesystem::path session(std::size_t robot = 0) const {
    return folder_of_robot(folder(), robot) / "session.h5";
  }
  std::filesystem::path telemetry_log(std::size_t robot = 0) const {
    return folder_of_robot(folder(), robot) / "telemetry.log";
  }
  /// Where the run will stand after commit().
  const std::filesystem::path& final_folder() const { return folder_.final_path(); }
  /// Folders of interrupted runs that were passed over, for a note to the user.
  const std::vector<std::filesystem::path>& leftovers() const { return folder_.leftovers(); }

  /// Exports leveling.csv, and of each robot frames.csv, from the sessions, which are closed.
  /// Throws RunError.
  void write_tables() const;
  /// Writes summary.json. Throws RunError.
  void write_summary(std::string_view json) const;
  /// The run is complete: gives the folder its name. Throws RunError.
  void commit() { folder_.commit(); }

 private:
  RunFolder folder_;
  std::size_t robots_;
};

}  // namespace screed
