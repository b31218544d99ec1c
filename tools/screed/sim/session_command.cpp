// `screed session info|export|odometry RUN`: what a recorded run holds, its content as files that
// other programs read, and how far dead reckoning was off.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/run/comparison/odometry_errors.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/report/run_mcap.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/run_pictures.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// ---- info ----

struct InfoArguments {
  std::string run;
  bool json = false;
};

struct ExportArguments {
  std::string run;
  bool csv = false;
  bool all = false;
  bool heights = false;
  bool leveling = false;
  bool pictures = false;
  bool mcap = false;
  std::optional<std::uint64_t> every;
  std::optional<std::uint64_t> first;
  std::optional<std::uint64_t> count;
  std::optional<std::string> out;
};

Json describe(const fs::path& file, const SessionReader& session) {
  const SessionInfo& info = session.info();
  const FrameRange training = training_frames(session);
  Json json = {{"file", file.string()},
               {"bytes", fs::file_size(file)},
               {"experiment", info.experiment_name},
               {"program_version", info.program_version},
               {"arithmetic", info.arithmetic},
               {"board", info.board_name},
               {"seed", info.seed},
               {"random_seed", info.parameters.random_seed()},
               {"frames", session.frames()},
               {"duration_s", static_cast<double>(session.frames()) / info.tick_rate_hz},
               {"training_first", training.first},
               {"training_frames", training.count},
               {"complete", session.complete()},
               {"running", session.running()},
               {"content_hash", session.content_hash()},
               {"missing_columns", session.missing_columns()}};
  if (session.frames() > 0) {
    std::vector<SimFrame> last(1);
    session.read(session.frames() - 1, std::span(last));
    json["faults"] = last[0].faults;
  }
  json["heights"] = nullptr;
  if (session.has_heights()) {
    const HeightMapGeometry g = session.heights_after(0).geometry;
    json["heights"] = {{"nx", g.nx},     {"ny", g.ny},       {"spacing_m", g.spacing_m},
                       {"wrap", g.wrap}, {"walls", g.walls}, {"changes", session.height_changes()}};
  }
  return json;
}

void print_info(const Json& json) {
  const auto row = [](const char* name, const char* text, const Json& figures) {
    print("{:-18s} {}\n", name, filled(text, figures));
  };
  row("file", "{file}", json);
  row("size", "{bytes*1e-6:.1f} MB", json);
  row("experiment", "{experiment}", json);
  row("program", "{program_version}", json);
  row("arithmetic", "{arithmetic}", json);
  row("board", "{board}", json);
  row("seed", "{seed}, of the drive {random_seed}", json);
  row("frames", "{frames} ({duration_s} s)", json);
  if (json["training_frames"].get<std::uint64_t>() > 0)
    row("training frames", "{training_frames} from frame {training_first}", json);
  const Json& heights = json["heights"];
  if (heights.is_null()) {
    row("height map", "not recorded frame by frame", json);
  } else {
    row("height map",
        heights["wrap"].get<bool>() ? "{nx} x {ny}, {spacing_m} m, {changes} changes, wraps around"
        : heights["walls"].get<bool>() ? "{nx} x {ny}, {spacing_m} m, {changes} changes, walled"
                                       : "{nx} x {ny}, {spacing_m} m, {changes} changes",
        heights);
  }
  row("content hash",
      json["running"].get<bool>()    ? "none: the run goes on"
      : json["complete"].get<bool>() ? "{content_hash}"
                                     : "none: the run did not end",
      json);
  for (const Json& column : json["missing_columns"]) row("missing column", "{}", column);
}

int run_info(const InfoArguments& arguments) {
  const fs::path file = session_file(arguments.run);
  const Json json = describe(file, SessionReader(file));
  arguments.json ? print_json(json) : print_info(json);
  return 0;
}

/// The frames the user asks for: of the training drive, or all when there was none.
FrameRange chosen_range(const ExportArguments& arguments, const SessionReader& session, bool all) {
  FrameRange range = training_frames(session);
  if (all || range.count == 0) range = {0, session.frames()};
  const std::uint64_t end = range.first + range.count;
  if (arguments.first.has_value()) {
    if (*arguments.first >= session.frames()) {
      throw InputError("--first = " + std::to_string(*arguments.first) + ": the session has " +
                       std::to_string(session.frames()) + " frames, from 0");
    }
    range.first = *arguments.first;
    range.count = end > range.first ? end - range.first : session.frames() - range.first;
  }
  if (arguments.count.has_value()) {
    if (*arguments.count > session.frames() - range.first) {
      throw InputError("--count = " + std::to_string(*arguments.count) + ": from frame " +
                       std::to_string(range.first) + " the session has " +
                       std::to_string(session.frames() - range.first));
    }
    range.count = *arguments.count;
  }
  if (range.count == 0) throw InputError("the session has no frame to export");
  return range;
}

/// The robot of a recorded run; none, and a note about what lacks it ("the pictures are"), when its
/// model is gone by now.
std::optional<Assembly> robot_of_run(const SessionReader& session, const fs::path& file,
                                     const char* what_is) {
  const RunSetup setup = setup_of(session.info(), fs::absolute(file).parent_path());
  try {
    return robot_model(setup, session.info().board_name);
  } catch (const InputError& error) {
    std::cerr << "note: " << what_is << " without the robot: " << error.what() << "\n";
    return std::nullopt;
  }
}

/// From the session file to the folder of its pictures.
struct PicturePaths {
  fs::path file;
  fs::path folder;
};

/// The run's own pictures, and where heights were recorded a series.
void export_all_pictures(const ExportArguments& arguments, std::span<const SessionReader> sessions,
                         const FrameRange& range, const PicturePaths& paths, TaskBar& bar) {
  const SessionReader& session = sessions.front();
  PictureSeries series;
  series.state_names = leveling_state_names();
  const RunSetup setup = setup_of(session.info(), {});
  if (const auto robot = robot_of_run(session, paths.file, "the pictures are"); robot.has_value()) {
    series.shape = shape_of(*robot, setup.experiment.vehicle.tracks);
  }
  std::size_t count = export_run_pictures(paths.folder, sessions, series.shape).size();
  if (session.has_heights()) {
    const TerrainMeasure measure(setup.experiment);
    series.surface = [&](const HeightField& terrain) { return measure.surface(terrain); };
    const std::uint64_t tenth = std::max<std::uint64_t>(1, (range.count + 9) / 10);
    count += export_pictures(sessions, range, arguments.every.value_or(tenth), paths.folder, series,
                             bar.progress())
                 .size();
    bar.clear();
  } else if (count > 0) {
    std::cerr << "note: pictures of start and end alone: the run has no recorded heights; sim "
                 "--heights and record keep them\n";
  } else {
    throw InputError(paths.file.string() +
                     ": nothing to draw: the run has no end yet, and no recorded heights");
  }
  print("{}: {} pictures\n", paths.folder, count);
}

/// The whole run, or the frames that the user names, of all robots.
void export_run_mcap(const ExportArguments& arguments, const fs::path& file, const fs::path& mcap,
                     TaskBar& bar) {
  const std::vector<SessionReader> sessions = open_robots(arguments.run);
  RunMcapOptions options;
  options.range = chosen_range(arguments, sessions.front(), true);
  if (arguments.every.has_value()) options.terrain_every = *arguments.every;
  if (!sessions.front().has_heights()) {
    std::cerr << "note: the ground of start and end alone: the run has no recorded heights; sim "
                 "--heights and record keep them\n";
  }
  options.robot = robot_of_run(sessions.front(), file, "the MCAP file is");
  std::ifstream summary(fs::absolute(file).parent_path() / "summary.json");
  options.summary.assign(std::istreambuf_iterator<char>(summary), {});  // empty where there is none
  options.progress = bar.progress();
  export_mcap(sessions, mcap, options);
  bar.clear();
  print("{}: {}, {:.1f} MB\n", mcap, counted(options.range->count, "frame"),
        static_cast<double>(fs::file_size(mcap)) * 1e-6);
}

int export_session(const ExportArguments& arguments) {
  if (!arguments.csv && !arguments.heights && !arguments.leveling && !arguments.pictures &&
      !arguments.mcap) {
    throw InputError(
        "session export: say what: --csv, --heights, --leveling, --mcap, --pictures or several of "
        "them");
  }
  const fs::path file = session_file(arguments.run);
  const SessionReader session(file);
  if (arguments.heights && !session.has_heights()) {
    throw InputError(file.string() +
                     ": has no recorded heights; sim --heights and record keep them");
  }
  const std::vector<LevelingPoint> leveling = session.leveling();
  if (arguments.leveling && leveling.empty())
    throw InputError(file.string() +
                     ": has no leveling curve; it is of a program before there were");
  const FrameRange range = chosen_range(arguments, session, arguments.all);
  MadeFolders folders;
  const fs::path out =
      folders.make(arguments.out.has_value() ? fs::path(*arguments.out)
                                             : fs::absolute(file).parent_path() / "export");
  if (!session.complete()) {
    std::cerr << (session.running() ? "note: the run goes on; this is what is saved so far\n"
                                    : "note: the recorded run did not end\n");
  }

  TaskBar bar(false);
  if (arguments.csv) {
    const fs::path csv = out / (arguments.all ? "frames.csv" : "table_5_1.csv");
    export_columns_csv(session,
                       arguments.all ? std::span<const Column>(kFrameColumns) : table_5_1_columns(),
                       range, csv, bar.progress());
    bar.clear();
    print("{}: {}\n", csv, counted(range.count, "frame"));
  }
  if (arguments.leveling) {
    export_leveling_csv(leveling, out / "leveling.csv");
    print("{}: {} points\n", out / "leveling.csv", leveling.size());
  }
  if (arguments.heights) {
    constexpr std::uint64_t kEverySecond = 100;
    const HeightExport done =
        export_heights_png(session, range, arguments.every.value_or(kEverySecond),
                           folders.make(out / "heights"), bar.progress());
    bar.clear();
    print("{}: {} height maps, black {:.6f} m, white {:.6f} m (scale.json)\n", out / "heights",
          done.files.size(), done.scale.black_m, done.scale.white_m);
  }
  if (arguments.mcap) export_run_mcap(arguments, file, out / "run.mcap", bar);
  if (arguments.pictures) {
    export_all_pictures(arguments, open_robots(arguments.run), range,
                        {file, folders.make(out / "pictures")}, bar);
  }
  return 0;
}

// ---- odometry ----

struct OdometryArguments {
  std::vector<std::string> runs;
  double length_m = 10.0;
  bool json = false;
};

Json json_of(const OdometrySummary& summary, double length_m) {
  Json json;
  json["leg_m"] = length_m;
  json["legs"] = summary.legs;
  for (std::size_t way = 0; way < kReckonings; ++way) {
    const OdometrySummary::Errors& errors = summary.errors[way];
    json["errors"][name_of(static_cast<Reckoning>(way))] = {
        {"median_m", errors.median_m},
        {"median_95_m", {errors.median_95_m.low, errors.median_95_m.high}},
        {"ninety_percent_m", errors.ninety_percent_m}};
  }
  json["consistency"] = summary.consistency;
  json["consistent_95"] = {summary.consistent.low, summary.consistent.high};
  return json;
}

void print_errors(const Json& json) {
  print("{legs} legs of {leg_m:g} m of the true path, error at their end [m]:\n", json);
  print("{:-30s} {:8s} {:16s} {:8s}\n", "", "median", "95 % of it", "90 %");
  for (const auto& [way, errors] : json["errors"].items()) {
    print("{:-30s}", way);
    print(" {median_m:8.2f} {median_95_m.0:7.2f} to {median_95_m.1:5.2f} {ninety_percent_m:8.2f}\n",
          errors);
  }
  print(
      "squared error over the variance that the firmware states: {consistency:.2f}; consistent "
      "from {consistent_95.0:.2f} to {consistent_95.1:.2f}\n",
      json);
}

int run_odometry(const OdometryArguments& arguments) {
  TaskBar bar(arguments.json);
  std::vector<OdometryLeg> legs;
  for (const std::string& run : arguments.runs) {
    const auto of_run = odometry_legs(session_file(run), arguments.length_m, bar.progress());
    legs.insert(legs.end(), of_run.begin(), of_run.end());
  }
  bar.clear();
  if (legs.empty()) {
    throw InputError("no run is as long as one leg; --length must be shorter than what they drove");
  }
  const Json json = json_of(summarize(legs), arguments.length_m);
  arguments.json ? print_json(json) : print_errors(json);
  return 0;
}

}  // namespace

void register_session_command(Command& root, Program& program) {
  Command* session = root.add_subcommand("session", "Inspect, export or compare recorded runs");

  auto [info_command, info] = add_subcommand<InfoArguments>(
      *session, program, "info", "Show the content of a session", run_info);
  info_command.add_option("RUN", info.run, "Run folder or session file")->required();
  info_command.add_flag("--json", info.json, "Print JSON");

  auto [command, exported] = add_subcommand<ExportArguments>(
      *session, program, "export", "Export tables, height maps, pictures and MCAP", export_session);
  command.add_option("RUN", exported.run, "Run folder or session file")->required();
  command.add_flag("--csv", exported.csv,
                   "Export thesis Table 5.1 as CSV, with units in the header");
  command.add_flag("--all", exported.all,
                   "Export all frames, and with --csv all columns (default: the training drive's)");
  command.add_flag("--heights", exported.heights,
                   "Export height maps as 16-bit PNGs, with their scale in scale.json");
  command.add_flag("--leveling", exported.leveling,
                   "Export the leveling curve as CSV, with units in the header");
  command.add_flag(
      "--mcap", exported.mcap,
      "Export all robots, and the whole run where no frames are named, as an MCAP file "
      "for Foxglove, Lichtblick and PlotJuggler");
  command.add_flag("--pictures", exported.pictures,
                   "Export shaded height maps with the driven path: of the start, the end and what "
                   "changed, and of frames between where heights were recorded");
  add_number(
      command, "--every", exported.every,
      "Frames between two terrains (default: 100 for --heights, 500 for --mcap, a tenth of all for "
      "--pictures)",
      kCountRange);
  add_number(command, "--first", exported.first, "First frame, counted from 0 in the session",
             {0, 1e9});
  add_number(command, "--count", exported.count, "Number of frames", kCountRange);
  command.add_option("--out", exported.out, "Output folder (default: RUN/export)")
      ->type_name("FOLDER");
  register_session_subcommands(*session, program);
}

void register_session_odometry_command(Command& session, Program& program) {
  auto [command, arguments] = add_subcommand<OdometryArguments>(
      session, program, "odometry",
      "Compare dead reckoning with the truth, over all legs of one or more runs", run_odometry);
  command.add_option("RUN", arguments.runs, "Run folders or session files")->required();
  add_number(command, "--length", arguments.length_m, "Length of a leg along the true path [m]",
             {0.1, 1e6});
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
