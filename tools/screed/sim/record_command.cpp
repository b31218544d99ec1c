// `screed record FILE...`: training sessions.
#include <iostream>
#include <optional>

#include "host_sim/core/figures.h"
#include "host_sim/run/experiment/vehicle_sections.h"
#include "host_sim/run/simulation/outcome.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/run_batch.h"

namespace screed {
namespace {

struct RecordArguments {
  BatchArguments runs;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> frames;
  bool csv = false;
};

/// The seed of the world, and that of the drive: a parameter of the robot, of 15 bits.
void add_seed(std::uint64_t seed, std::vector<std::string>& overrides) {
  overrides.push_back("experiment.seed=" + std::to_string(seed));
  overrides.push_back("parameters.random_seed=" + std::to_string(seed % 32768U));
}

/// " (FAULT)"; empty without one.
std::string with_faults(const SimulationSummary& s) {
  return s.faults != 0 ? " (" + fault_names(s.faults) + ")" : "";
}

void print_session(const SimulationSummary& s) {
  const auto session_bytes = std::filesystem::file_size(s.folder / "session.h5");
  print("  {:-26s} {:12s}\n", "frames of Algorithm 5", s.training_frames);
  print("  {:-26s} {:10.1f} m\n", "distance driven", s.distance_m);
  print("  {:-26s} {:12s}\n", "changes of heights", s.height_changes);
  print("  {:-26s} {*1e-6:9.1f} MB\n", "session", session_bytes);
  print("  {:-26s} {:10.1f} s  ({:.2f} ms a frame)\n", "recorded in", s.wall_s,
        s.time_s > 0.0 ? s.wall_s / s.time_s * 10.0 : 0.0);
  print("  {:-26s} {:12s}{}\n", "robot", s.state, with_faults(s));
  print("  {:-26s} {:12s}\n", "run folder", s.folder);
  print("  {:-26s} {:12s}\n", "content hash", s.content_hash);
}

int run_record(const RecordArguments& arguments, const std::string& version) {
  if (arguments.runs.files.empty()) throw UsageError("FILE is required");
  std::vector<std::string> overrides = {std::string("experiment.algorithm=") + kTrainingDriveName};
  if (arguments.seed.has_value()) add_seed(*arguments.seed, overrides);
  if (arguments.frames.has_value())
    overrides.push_back("experiment.frames=" + std::to_string(*arguments.frames));

  SimulationOptions options;
  options.program_version = version;
  options.heights = true;
  options.table = arguments.csv;
  bool short_of_frames = false;
  std::vector<SimulationSummary> summaries;
  run_batch(arguments.runs, overrides, options,
            [&](const Experiment& experiment, const SimulationSummary& summary) {
              summaries.push_back(summary);
              const uint64_t wanted = frames_to_drive(experiment);
              if (summary.training_frames < wanted) {
                short_of_frames = true;
                std::cerr << "note: " << experiment.experiment.name << ": "
                          << summary.training_frames << " of " << wanted << " frames; the robot is "
                          << summary.state << with_faults(summary)
                          << (summary.left_bed ? ", it left the bed" : "") << "\n";
              }
              if (arguments.runs.json) return;
              if (arguments.runs.quiet) {
                print("{} {}\n", summary.folder, summary.content_hash);
              } else {
                print("\n{}, seed {}\n", experiment.experiment.name, experiment.experiment.seed);
                print_session(summary);
              }
            });
  if (arguments.runs.json) std::cout << json_of(summaries, arguments.runs.several());
  if (const int code = interrupted_exit_code(); code != 0) return code;
  return short_of_frames ? 1 : 0;
}

}  // namespace

void register_record_command(Command& root, Program& program) {
  auto [command, arguments] =
      add_subcommand<RecordArguments>(root, program, "record",
                                      "Record training sessions: run the training drive "
                                      "(Algorithm 5) and record the height map of every frame",
                                      run_record);
  add_batch_options(command, arguments.runs);
  add_number(
      command, "--seed", arguments.seed,
      "Seed of world and training drive; overrides [experiment] seed and [parameters] random_seed",
      kSeedRange);
  add_number(command, "--frames", arguments.frames,
             "Number of frames of the training drive; overrides [experiment] frames",
             {.low = 8, .high = kMaxFrames, .multiple_of = 8});
  command.add_flag("--csv", arguments.csv, "Also write frames.csv");
}

}  // namespace screed
