// `screed record FILE...`: training sessions.
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

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

void print_session(const SimulationSummary& s) {
  const double megabytes =
      static_cast<double>(std::filesystem::file_size(s.folder / "session.h5")) * 1e-6;
  std::printf("  %-26s %12llu\n", "frames of Algorithm 5",
              static_cast<unsigned long long>(s.training_frames));
  std::printf("  %-26s %10.1f m\n", "distance driven", s.distance_m);
  std::printf("  %-26s %12llu\n", "changes of heights",
              static_cast<unsigned long long>(s.height_changes));
  std::printf("  %-26s %9.1f MB\n", "session", megabytes);
  std::printf("  %-26s %10.1f s  (%.2f ms a frame)\n", "recorded in", s.wall_s,
              s.time_s > 0.0 ? s.wall_s / s.time_s * 10.0 : 0.0);
  std::printf("  %-26s %12s%s\n", "robot", s.state.c_str(),
              s.faults != 0 ? (" (" + fault_names(s.faults) + ")").c_str() : "");
  std::printf("  %-26s %12s\n", "run folder", s.folder.c_str());
  std::printf("  %-26s %12s\n", "content hash", s.content_hash.c_str());
}

int run_record(const RecordArguments& arguments, const std::string& version) {
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
                          << summary.state
                          << (summary.faults != 0 ? " (" + fault_names(summary.faults) + ")" : "")
                          << (summary.left_bed ? ", it left the bed" : "") << "\n";
              }
              if (arguments.runs.json) return;
              if (arguments.runs.quiet) {
                std::printf("%s %s\n", summary.folder.c_str(), summary.content_hash.c_str());
              } else {
                std::printf("\n%s, seed %llu\n", experiment.experiment.name.c_str(),
                            static_cast<unsigned long long>(experiment.experiment.seed));
                print_session(summary);
              }
            });
  if (arguments.runs.json) std::cout << json_of(summaries, arguments.runs.several());
  if (const int code = interrupted_exit_code(); code != 0) return code;
  return short_of_frames ? 1 : 0;
}

}  // namespace

void register_record_command(Command& root, Program& program) {
  auto arguments = std::make_shared<RecordArguments>();
  Command* command = root.add_subcommand("record",
                                         "Record training sessions: run the training drive "
                                         "(Algorithm 5) and record the height map of every frame");
  add_batch_options(*command, arguments->runs);
  add_number(
      *command, "--seed", arguments->seed,
      "Seed of world and training drive; overrides [experiment] seed and [parameters] random_seed",
      kSeedRange);
  add_number(*command, "--frames", arguments->frames,
             "Number of frames of the training drive; overrides [experiment] frames",
             {.low = 8, .high = kMaxFrames, .multiple_of = 8});
  command->add_flag("--csv", arguments->csv, "Also write frames.csv");
  command->callback([arguments, &program] {
    if (arguments->runs.files.empty()) throw UsageError("FILE is required");
    program.action = [arguments, version = program.version] {
      return run_record(*arguments, version);
    };
  });
}

}  // namespace screed
