// `screed sim FILE`: runs an experiment and shows what happened. With --from RUN: what would have
// happened had a parameter been another one from a moment on?
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/ground_station/link/external_port.h"
#include "host_sim/run/comparison/session_comparison.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/robot_sections.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/simulation.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/key_table.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/run_batch.h"
#include "tools/screed/cli/world_choice.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/run_viewers.h"
#include "tools/screed/viewer/view_command.h"

namespace screed {
namespace {

struct SimArguments {
  BatchArguments runs;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  std::optional<std::string> from;
  std::optional<double> changes_at_s;  ///< with from
  WorldChoice world;
  std::optional<std::string> can;
  std::optional<std::string> pty;
  bool realtime = false;
  bool heights = false;
  bool view = false;
  bool list_keys = false;
  ViewArguments viewer;
};

/// Viewer of a run, which may drive in it.
struct Watching {
  std::unique_ptr<viewer::KeyboardDriver> driver;
  std::unique_ptr<viewer::LiveViewer> viewer;
};

void print_row(const std::string& name, const std::string& before, const std::string& after,
               const std::string& change) {
  print("  {:-26s} {:12s}", name, before);
  if (!after.empty()) print(" {:12s}", after);
  print("{}{}\n", change.empty() ? "" : "  ", change);
}
void print_row(const std::string& name, const char* text, const Json& figures) {
  print_row(name, filled(text, figures), "", "");
}

void print_cycles(const CycleReport& c) {
  const auto cycles = [](double value) {
    return filled("{:.0f} ({:.1f} %)", value,
                  100.0 * value / static_cast<double>(CycleReport::kTickCycles));
  };
  const auto row = [](const char* name, const auto& value) {
    print("  {:-26s} {:20s}\n", name, value);
  };
  print("\n  microcontroller, cycles (% of a tick)\n");
  row("longest tick", cycles(static_cast<double>(c.longest_tick_cycles)));
  row("mean tick", cycles(c.mean_tick_cycles));
  row("load, all that is not slept", filled("{*100:.1f} %", c.load));
  row("ticks missed", c.missed_ticks);
  row("encoder edges", c.encoder_edges);
  row("encoder edges missed", c.encoder_missing);
  row("edge to its interrupt", c.encoder_latency_cycles);
  row("bytes received, lost", filled("{}, {}", c.uart_received, c.uart_overruns));
  row("resets", c.resets);
  print("  {:-26s} {:12s} {:12s} {:12s}\n", "interrupt", "count", "longest", "mean");
  for (const CycleReport::Interrupt& it : c.interrupts)
    print("  {:-26s} {:12s} {:12s} {:12.0f}\n", it.name, it.count, it.longest_cycles,
          it.mean_cycles);
}

/// What counts first: level, then flat to a robot, then single cells, which tracks roughen.
void print_terrain(const Json& run, double flatness_deg) {
  constexpr const char* kMillimetres = "{*1000:.1f} mm";
  constexpr const char* kPercent = "{*100:.1f} %";
  constexpr const char* kDegrees = "{:.2f} deg";
  const auto row = [](const std::string& name, const char* form, const Json& was, const Json& is,
                      std::string (*change)(double, double) = change_text) {
    print_row(name, filled(form, was), filled(form, is),
              change(was.get<double>(), is.get<double>()));
  };
  const Json& was = run["terrain_before"];
  const Json& is = run["terrain_after"];
  const auto figure = [&](const std::string& name, const char* member, const char* form,
                          std::string (*change)(double, double) = change_text) {
    row(name, form, was[member], is[member], change);
  };
  print_row("terrain", "before", "after", "");
  figure("height about level", "level_deviation_m", kMillimetres);
  const Json& leveling = run["leveling"];
  if (!std::isnan(leveling["transport_after_m4"].get<double>()))
    row("transport to level ground", "{*1000:.3f} L m", leveling["transport_before_m4"],
        leveling["transport_after_m4"]);
  if (!std::isnan(leveling["progress"].get<double>()))
    print_row("progress by W1, by W2", "{progress*100:.1f} %, {progress_w2*100:.1f} %", leveling);
  figure("flat at robot scale", "robot_scale_flatness", kPercent, share_change_text);
  figure("relief at robot scale", "relief_m", kMillimetres);
  figure("roughness", "roughness_m", kMillimetres);
  print_row("mean height", "", "",
            filled("{*1000:+.1f} mm",
                   is["mean_height_m"].get<double>() - was["mean_height_m"].get<double>()));
  figure(filled("flat cells, up to {:g} deg", flatness_deg), "flatness", kPercent,
         share_change_text);
  figure("mean slope of cells", "mean_slope_deg", kDegrees);
  figure("RMS slope of cells", "rms_slope_deg", kDegrees);
  figure("95 % of cells below", "p95_slope_deg", kDegrees);
  figure("steepest cell", "steepest_slope_deg", kDegrees);
  const Json& change = run["terrain_change"];
  if (change["cut_m3"] == 0.0 && change["fill_m3"] == 0.0) return;  // rigid ground
  print("\n");
  print_row("change of terrain", "volume", "deepest", "");
  print_row("cut", filled("{cut_m3*1000:.3f} L", change),
            filled("{deepest_cut_m*1000:.1f} mm", change), "");
  print_row("fill", filled("{fill_m3*1000:.3f} L", change),
            filled("{deepest_fill_m*1000:.1f} mm", change), "");
  print_row("moved", "{moved_m3*1000:.3f} L", change);
}

/// What was gained for what, and how the robot used its time and its site.
void print_work(const Json& leveling) {
  const auto is_known = [&](const char* name) { return !std::isnan(leveling[name].get<double>()); };
  print("\n");
  if (is_known("transport_per_joule_m4"))
    print_row("transport per energy", "{transport_per_joule_m4*1e6:.4f} cm3 m/J", leveling);
  print_row("slip", "{slip*100:.1f} %", leveling);
  if (is_known("visited")) print_row("visited of the site", "{visited*100:.1f} %", leveling);
  print_row("time on the way back", "{returning*100:.1f} %", leveling);
  print_row("time stuck", "{stuck*100:.1f} %", leveling);
  print_row("time tilted", "{tilted*100:.1f} %", leveling);
  print_row("time off the site", "{off_site*100:.1f} %", leveling);
}

/// A robot that did not drive: why, or that nothing but a command was missing.
void print_arming(const SimulationSummary& s) {
  if (s.state == state_name(RobotState::kDisarmed) && s.cannot_be_armed.empty())
    print_row("can be armed", "yes", "", "");
  const char* label = "cannot be armed:";
  for (const std::string& obstacle : s.cannot_be_armed) {
    print("  {:-26s} {}\n", label, obstacle);
    label = "";
  }
}

/// Of several robots; what is above is of all.
void print_robots(const Json& robots) {
  print("\n  {:-8s} {:12s} {:12s} {:7s} {:8s}  {:-12s} {}\n", "robot", "distance", "energy",
        "peaks", "battery", "state", "faults");
  for (size_t i = 0; i < robots.size(); ++i) {
    print("  {:-8s} ", i);
    print(
        "{distance_m:10.2f} m {energy_j:10.0f} J {peaks:7s} {battery_v:6.2f} V  {state:-12s} "
        "{faults}\n",
        robots[i]);
  }
}

void print_table(const Experiment& experiment, const SimulationSummary& s) {
  const Json run = summary_json_with_folder(s);
  print("\n{name}, {algorithm}, seed {seed}", run);
  print("{}\n", s.end == RunEnd::kDone ? "" : filled(" (ended: {})", end_text(s.end)));
  print_row("simulated time", "{time_s:.1f} s", run);
  print_row("distance driven", "{distance_m:.2f} m", run);
  print_row("energy from the battery", "{energy_j:.0f} J", run);
  print_row("battery left", "{battery_charge*100:.0f} %", run);
  if (s.charge_lasts_h.has_value()) print_row("a charge lasts", "{charge_lasts_h:.1f} h", run);
  print_row("peaks", "{peaks}", run);
  print_row(s.robots.empty() ? "robot" : "robots", "{state}", run);
  if (s.faults != 0) print_row("faults", "{faults}", run);
  print_arming(s);
  print_row("telemetry frames", "{telemetry_frames}", run);
  print_row("real-time factor", factor_text(s.real_time_factor()), "", "");
  print("\n");
  print_terrain(run, experiment.experiment.flatness_deg);
  print_work(run["leveling"]);
  if (!s.robots.empty()) print_robots(run["robots"]);
  if (s.cycles.has_value()) print_cycles(*s.cycles);
  print("\n  run folder    {}\n  content hash  {}\n", s.folder, s.content_hash);
}

// ---- from a moment of a recorded run on ----

/// A parameter that the user sets, as the key of [later] that the ground station follows.
std::string set_later(const std::string& text) {
  const IniEntry entry = parse_override(text);
  if (entry.section != "parameters") {
    throw InputError("--set " + text +
                     ": until --at the run is as it was recorded; allowed is parameters.KEY");
  }
  return "later." + entry.key + "=" + entry.value;
}

/// The recorded run from its start, in its world, with other parameters from --at on. Throws
/// UsageError, and InputError where RUN has no such moment.
SimArguments once_more(SimArguments arguments) {
  BatchArguments& runs = arguments.runs;
  if (!runs.files.empty() || runs.table.has_value() || runs.missing || arguments.seed.has_value())
    throw UsageError("--from RUN says what is run: without FILE, --table, --missing and --seed");
  // Elsewhere the time of a screenshot; here that one is made at the end.
  arguments.changes_at_s = std::exchange(arguments.viewer.options.screenshot_at, std::nullopt);
  if (!arguments.changes_at_s.has_value() || runs.sets.empty())
    throw UsageError("--from needs --at and --set parameters.KEY=VALUE");
  const std::filesystem::path file = session_files(*arguments.from).front();
  const SessionReader session(file);
  const double end_s = static_cast<double>(session.frames()) / kTickRate_hz;
  const std::string at = plain_text(*arguments.changes_at_s);
  if (*arguments.changes_at_s >= end_s) {
    throw InputError("--at " + at + ": " + *arguments.from + " lasts " + plain_text(end_s) + " s");
  }
  for (std::string& set : runs.sets) set = set_later(set);
  runs.sets.push_back("later.at=" + at);
  runs.files = {(file.parent_path() / "experiment.ini").string()};
  if (read_experiment(runs.files.front()).later.at_s.has_value())
    throw InputError(runs.files.front() + ": has a section [later] of its own; change it there");
  if (!arguments.world.board.has_value()) arguments.world.board = session.info().board_name;
  std::ifstream summary(file.parent_path() / "summary.json");
  if (arguments.world.hal == "native") {
    const Json was = Json::parse_or_null(summary);
    if (was.is_object()) arguments.world.hal = was["world"].value("hal", "native");
  }
  return arguments;
}

/// Where the robots of two runs part, the first of them; nothing where none does.
std::optional<FirstDifference> parting(const std::string& from, const std::filesystem::path& to) {
  const std::vector<std::filesystem::path> was = session_files(from);
  const std::vector<std::filesystem::path> is = session_files(to);
  std::optional<FirstDifference> first;
  for (size_t i = 0; i < std::min(was.size(), is.size()); ++i) {
    const SessionComparison both = compare_sessions(SessionReader(was[i]), SessionReader(is[i]));
    if (both.first.has_value() && (!first.has_value() || both.first->tick < first->tick))
      first = both.first;
  }
  return first;
}

/// What came of it, in a line and in `json`; false where the run is another one before --at.
bool tell_parting(const SimArguments& arguments, const std::filesystem::path& to, Json& json) {
  const std::optional<FirstDifference> first = parting(*arguments.from, to);
  json["parts_from"] = {{"run", *arguments.from}, {"time_s", nullptr}, {"column", nullptr}};
  std::string text = "never parts from " + *arguments.from;
  if (first.has_value()) {
    json["parts_from"]["time_s"] = first->time_s;
    json["parts_from"]["column"] = first->column;
    text = filled("parts from {} at {:.2f} s: {}", *arguments.from, first->time_s, first->column);
  }
  if (!arguments.runs.json && !arguments.runs.quiet) print("{}\n", text);
  if (!first.has_value() || first->time_s > *arguments.changes_at_s) return true;
  std::cerr
      << "note: they part before --at " << plain_text(*arguments.changes_at_s) << ": "
      << *arguments.from
      << " was recorded by another program, in another world, or with commands from outside\n";
  return false;
}

int run_sim(const SimArguments& given, const std::string& version) {
  if (given.list_keys) {
    print_key_table(experiment_key_table() + robot_section_table());
    return 0;
  }
  const SimArguments arguments = given.from.has_value() ? once_more(given) : given;
  if (arguments.runs.files.empty()) throw UsageError("FILE is required");
  std::vector<std::string> overrides;
  if (arguments.seed.has_value())
    overrides.push_back("experiment.seed=" + std::to_string(*arguments.seed));
  if (arguments.duration_s.has_value())
    overrides.push_back("experiment.duration=" + plain_text(*arguments.duration_s));

  SimulationOptions options;
  PortGroup ports;
  if (arguments.can.has_value()) ports.add(std::make_unique<CanPort>(*arguments.can));
  if (arguments.pty.has_value()) {
    auto terminal = std::make_unique<TerminalPort>(
        arguments.pty->empty() ? std::nullopt
                               : std::optional<std::filesystem::path>(*arguments.pty));
    std::cerr << "serial port " << terminal->device().string() << "\n";
    ports.add(std::move(terminal));
  }
  if (!ports.empty()) options.ground_port = &ports;
  // Other programs live by the clock.
  options.realtime = arguments.realtime || !ports.empty();
  options.program_version = version;
  options.heights = arguments.heights;
  choose_world(arguments.world, options);

  const std::optional<viewer::ViewerOptions> view =
      viewer_options(arguments.viewer, arguments.view);
  if (view.has_value() && view->window) viewer::require_screen();
  const bool several = arguments.runs.several();
  if (several && view.has_value() && !view->window)
    throw InputError("--screenshot and --frames-dir are for one experiment at a time");
  Watching watching;
  const Prepare prepare = [&](const Experiment& experiment, SimulationOptions& of_run) {
    if (!view.has_value()) return;
    watching.viewer.reset();  // refers to the driver: destroyed first
    watching.driver = std::make_unique<viewer::KeyboardDriver>(
        ground_key_of(experiment), algorithm_number(experiment.experiment.algorithm),
        of_run.ground_port);
    watching.viewer = std::make_unique<viewer::LiveViewer>(experiment, of_run.board, *view,
                                                           *watching.driver, interrupt);
    of_run.ground_port = watching.driver.get();
    of_run.observer = watching.viewer.get();
    // The viewer keeps the pace.
    of_run.realtime = of_run.realtime && !view->window;
  };

  std::vector<SimulationSummary> summaries;
  std::vector<std::string> failures;
  run_batch(
      arguments.runs, overrides, options,
      [&](const Experiment& experiment, const SimulationSummary& summary) {
        summaries.push_back(summary);
        if (const auto shortfall = shortfall_of(summary); shortfall.has_value())
          failures.push_back("note: " + experiment.experiment.name + ": " + *shortfall);
        if (watching.viewer && !watching.viewer->failure().empty()) {
          failures.push_back("screed: " + watching.viewer->failure() + "; the run is saved, in " +
                             summary.folder.string());
        }
        if (arguments.runs.json) return;
        if (!arguments.runs.quiet) {
          print_table(experiment, summary);
        } else {
          print("{} {}\n", summary.folder, summary.content_hash);
        }
      },
      prepare);
  bool parted_late = true;
  if (arguments.from.has_value() && !summaries.empty()) {
    Json json = summary_json_with_folder(summaries.front());
    parted_late = tell_parting(arguments, summaries.front().folder, json);
    if (arguments.runs.json) std::cout << json.dump(2) << "\n";
  } else if (arguments.runs.json) {
    std::cout << json_of(summaries, several);
  }
  std::cout << std::flush;
  for (const std::string& failure : failures) std::cerr << failure << "\n";
  if (watching.viewer) {
    if (!several) watching.viewer->hold("The run has ended and is saved. Q closes the window.");
    if (view->frames.has_value()) std::cerr << watching.viewer->times().text() << "\n";
  }
  if (const int code = interrupted_exit_code(); code != 0) return code;
  return failures.empty() && parted_late ? 0 : 1;
}

}  // namespace

void register_sim_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<SimArguments>(
      root, program, "sim", "Run an experiment: the firmware drives in a simulated world", run_sim);
  add_batch_options(command, arguments.runs);
  add_number(command, "--seed", arguments.seed,
             "Seed of the world; overrides [experiment] seed, leaves [parameters] random_seed",
             kSeedRange);
  add_number(command, "--duration", arguments.duration_s,
             "Simulated time [s]; overrides [experiment] duration", {0.01, 1e6});
  command
      .add_option("--from", arguments.from,
                  "In place of FILE: this recorded run once more, but from --at S on with what "
                  "--set parameters.KEY=VALUE says, which the ground station sets then")
      ->type_name("RUN");
  command
      .add_option("--hal", arguments.world.hal,
                  "How the firmware runs: native: compiled for this machine; mcu: the flash image "
                  "under a cycle-accurate simulation of the microcontroller, of several robots in "
                  "the first; surrogate: native, with a closed form or a network (--model) in "
                  "place of the physics")
      ->show_default()
      ->one_of({"native", "mcu", "surrogate"});
  command.add_option("--board", arguments.world.board,
                     std::string("Board: a folder in boards/ (default: ") + kDefaultBoard + ")");
  command
      .add_option("--elf", arguments.world.elf,
                  "ELF image for --hal mcu (default: the one of make firmware)")
      ->type_name("FILE");
  add_number(command, "--gdb", arguments.world.gdb_port,
             "Port at which the image of --hal mcu waits for avr-gdb (docs/development.md)",
             {1, 65535});
  command
      .add_option("--model", arguments.world.model,
                  "Motion network for --hal surrogate (default: none, the closed form)")
      ->type_name("FILE");
  command
      .add_option("--terrain-net", arguments.world.terrain_net,
                  "Network that changes the ground below wheels with --model (default: none, it "
                  "stays as it is)")
      ->type_name("FILE");
  command
      .add_option("--can", arguments.can,
                  "Publish the radio's frames on this CAN interface and receive commands from "
                  "it; implies --realtime")
      ->type_name("INTERFACE");
  command
      .add_option("--pty", arguments.pty,
                  "Offer the radio as a virtual serial port, like that of an XBee, with a "
                  "symbolic link LINK to it; implies --realtime")
      ->type_name("LINK")
      ->expected(0, 1);
  command.add_flag("--realtime", arguments.realtime, "Do not run faster than real time");
  command.add_flag("--heights", arguments.heights,
                   "Record the height map of every tick, for `screed view` and for training");
  command.add_flag("--view", arguments.view,
                   "Show the running simulation in a window; arrow keys drive (H: all keys)");
  add_view_options(command, arguments.viewer);
  command.add_flag("--keys", arguments.list_keys, "List all keys of an experiment file and exit");
}

}  // namespace screed
