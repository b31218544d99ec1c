// The run folder, filled.
#include "host_sim/run/simulation/run_files.h"

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/session/csv_export.h"
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
    : folder_(make_folder(experiment, options)) {
  write_file(folder() / "experiment.ini", experiment.text());
}

void RunFiles::write_tables() const {
  const SessionReader session_file(session());
  export_frames_csv(session_file, folder() / "frames.csv");
  export_leveling_csv(session_file.leveling(), folder() / "leveling.csv");
}

void RunFiles::write_summary(std::string_view json) const {
  write_file(folder() / "summary.json", json);
}

}  // namespace screed
