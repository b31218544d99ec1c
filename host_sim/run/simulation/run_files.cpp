// The run folder, filled.
#include "host_sim/run/simulation/run_files.h"

#include <system_error>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {
namespace {

RunFolder make_folder(const Experiment& experiment, const SimulationOptions& options) {
  if (options.out.has_value()) return RunFolder::at(*options.out);
  return RunFolder::numbered(options.root.value_or(experiment.output_directory_prefix),
                             experiment.experiment.name);
}

}  // namespace

void TelemetryLog::open(const std::filesystem::path& path) {
  path_ = path;
  file_.open(path);
  if (!file_) throw RunError(path.string() + ": cannot be written");
}

void TelemetryLog::close() {
  file_.close();
  if (!file_) throw RunError(path_.string() + ": cannot be written completely; is the disk full?");
}

RunFiles::RunFiles(const Experiment& experiment, const SimulationOptions& options)
    : folder_(make_folder(experiment, options)), robots_(experiment.robots.count) {
  write_file(folder() / "experiment.ini", experiment.text());
  for (std::size_t robot = 1; robot < robots_; ++robot) {
    const std::filesystem::path own = folder_of_robot(folder(), robot);
    std::error_code error;
    std::filesystem::create_directory(own, error);
    if (error) throw RunError(own.string() + ": cannot be made: " + error.message());
  }
}

void RunFiles::write_tables() const {
  for (std::size_t robot = 0; robot < robots_; ++robot) {
    const SessionReader session_file(session(robot));
    export_frames_csv(session_file, folder_of_robot(folder(), robot) / "frames.csv");
    if (robot == 0) export_leveling_csv(session_file.leveling(), folder() / "leveling.csv");
  }
}

void RunFiles::write_summary(std::string_view json) const {
  write_file(folder() / "summary.json", json);
}

}  // namespace screed
