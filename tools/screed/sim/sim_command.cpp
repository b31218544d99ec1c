// `screed sim FILE`: runs an experiment and shows what happened.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/external_port.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/robot_sections.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/simulation.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/number_text.h"
#include "tools/screed/cli/run_batch.h"
#include "tools/screed/cli/world_choice.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/live_viewer.h"
#include "tools/screed/viewer/view_options.h"

namespace screed {
namespace {

struct SimArguments {
  BatchArguments runs;
  std::optional<std::uint64_t> seed;
  std::optional<double> duration_s;
  WorldChoice world;
  std::optional<std::string> can;
  std::optional<std::string> pty;
  bool realtime = false;
  bool heights = false;
  bool view = false;
  ViewArguments viewer;
};

/// Viewer of a run, which may drive in it.
struct Watching {
  std::unique_ptr<viewer::KeyboardDriver> driver;
  std::unique_ptr<viewer::LiveViewer> viewer;
};

void print_row(const char* name, const std::string& before, const std::string& after,
               const std::string& change) {
  std::printf("  %-26s %12s", name, before.c_str());
  if (!after.empty()) std::printf(" %12s", after.c_str());
  std::printf("%s%s\n", change.empty() ? "" : "  ", change.c_str());
}

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

void print_cycles(const CycleReport& c) {
  const auto number = [](auto value) { return std::to_string(value); };
  const auto cycles = [](double value) {
    return format("%.0f", value) +
           format(" (%.1f %%)", 100.0 * value / static_cast<double>(CycleReport::kTickCycles));
  };
  const auto row = [](const char* name, const std::string& value) {
    std::printf("  %-26s %20s\n", name, value.c_str());
  };
  std::printf("\n  microcontroller, cycles (%% of a tick)\n");
  row("longest tick", cycles(static_cast<double>(c.longest_tick_cycles)));
  row("mean tick", cycles(c.mean_tick_cycles));
  row("load, all that is not slept", format("%.1f %%", c.load * 100.0));
  row("ticks missed", number(c.missed_ticks));
  row("encoder edges", number(c.encoder_edges));
  row("encoder edges missed", number(c.encoder_missing));
  row("edge to its interrupt", number(c.encoder_latency_cycles));
  row("bytes received, lost", number(c.uart_received) + ", " + number(c.uart_overruns));
  row("resets", number(c.resets));
  std::printf("  %-26s %12s %12s %12s\n", "interrupt", "count", "longest", "mean");
  for (const CycleReport::Interrupt& it : c.interrupts) {
    std::printf("  %-26s %12llu %12llu %12.0f\n", it.name.c_str(),
                static_cast<unsigned long long>(it.count),
                static_cast<unsigned long long>(it.longest_cycles), it.mean_cycles);
  }
}

/// What counts first: level, then flat to a robot, then single cells, which tracks roughen.
void print_terrain(const TerrainOutcome& terrain, const LevelingOutcome& leveling,
                   double flatness_deg) {
  const TerrainFigures& before = terrain.before;
  const TerrainFigures& after = terrain.after;
  const auto millimetres = [](double metres) { return format("%.1f mm", metres * 1e3); };
  const auto percent = [](double share) { return format("%.1f %%", share * 100.0); };
  const auto litres = [](double m3) { return format("%.3f L", m3 * 1e3); };
  const auto height = [&](const char* name, double was, double is) {
    print_row(name, millimetres(was), millimetres(is), change_text(was, is));
  };
  const auto slope = [](const char* name, double was, double is) {
    print_row(name, format("%.2f deg", was), format("%.2f deg", is), change_text(was, is));
  };
  const auto share = [&](const char* name, double was, double is) {
    print_row(name, percent(was), percent(is), share_change_text(was, is));
  };
  const RobotScaleFigures& was = before.robot_scale;
  const RobotScaleFigures& is = after.robot_scale;
  print_row("terrain", "before", "after", "");
  height("height about level", was.level_deviation_m, is.level_deviation_m);
  if (!std::isnan(leveling.after.transport)) {
    const auto litre_metres = [](double m4) { return format("%.3f L m", m4 * 1e3); };
    print_row("transport to level ground", litre_metres(leveling.before.transport),
              litre_metres(leveling.after.transport),
              change_text(leveling.before.transport, leveling.after.transport));
  }
  share("flat at robot scale", was.flatness, is.flatness);
  height("relief at robot scale", was.relief_m, is.relief_m);
  height("roughness", was.roughness_m, is.roughness_m);
  share(("flat cells, up to " + format("%g", flatness_deg) + " deg").c_str(), before.flatness,
        after.flatness);
  slope("mean slope of cells", before.heights.mean_slope_deg, after.heights.mean_slope_deg);
  slope("RMS slope of cells", before.heights.rms_slope_deg, after.heights.rms_slope_deg);
  slope("95 % of cells below", before.heights.p95_slope_deg, after.heights.p95_slope_deg);
  slope("steepest cell", before.heights.steepest_slope_deg, after.heights.steepest_slope_deg);
  const TerrainChange& change = terrain.change;
  if (change.cut_m3 == 0.0 && change.fill_m3 == 0.0) return;  // rigid ground
  std::printf("\n");
  print_row("change of terrain", "volume", "deepest", "");
  print_row("cut", litres(change.cut_m3), millimetres(change.deepest_cut_m), "");
  print_row("fill", litres(change.fill_m3), millimetres(change.deepest_fill_m), "");
  print_row("moved", litres(change.moved_m3()), "", "");
}

/// What was gained for what, and how the robot used its time and its site.
void print_work(const LevelingPoint& after) {
  const auto percent = [](double share) { return format("%.1f %%", share * 100.0); };
  const auto row = [](const char* name, const std::string& value) {
    print_row(name, value, "", "");
  };
  std::printf("\n");
  if (!std::isnan(after.transport_per_joule))
    row("transport per energy", format("%.4f cm3 m/J", after.transport_per_joule * 1e6));
  row("slip", percent(after.slip));
  if (!std::isnan(after.visited)) row("visited of the site", percent(after.visited));
  row("time on the way back", percent(after.returning));
  row("time stuck", percent(after.stuck));
  row("time tilted", percent(after.tilted));
  row("time off the site", percent(after.off_site));
}

/// A robot that did not drive: why, or that nothing but a command was missing.
void print_arming(const SimulationSummary& s) {
  if (s.state == state_name(RobotState::kDisarmed) && s.cannot_be_armed.empty())
    std::printf("  %-26s %12s\n", "can be armed", "yes");
  const char* label = "cannot be armed:";
  for (const std::string& obstacle : s.cannot_be_armed) {
    std::printf("  %-26s %s\n", label, obstacle.c_str());
    label = "";
  }
}

/// Of several robots; what is above is of all.
void print_robots(const std::vector<RobotSummary>& robots) {
  if (robots.empty()) return;
  std::printf("\n  %-8s %12s %12s %7s %8s  %-12s %s\n", "robot", "distance", "energy", "peaks",
              "battery", "state", "faults");
  for (size_t i = 0; i < robots.size(); ++i) {
    const RobotSummary& robot = robots[i];
    std::printf("  %-8zu %12s %12s %7d %8s  %-12s %s\n", i,
                format("%.2f m", robot.distance_m).c_str(),
                format("%.0f J", robot.energy_j).c_str(), robot.peaks,
                format("%.2f V", robot.battery_v).c_str(), robot.state.c_str(),
                fault_names(robot.faults).c_str());
  }
}

void print_table(const Experiment& experiment, const SimulationSummary& s) {
  const std::string ended =
      s.end == RunEnd::kDone ? "" : std::string(" (ended: ") + end_text(s.end) + ")";
  std::printf("\n%s, %s, seed %llu%s\n", experiment.experiment.name.c_str(),
              experiment.experiment.algorithm.c_str(),
              static_cast<unsigned long long>(experiment.experiment.seed), ended.c_str());
  std::printf("  %-26s %12s\n", "simulated time", format("%.1f s", s.time_s).c_str());
  std::printf("  %-26s %12s\n", "distance driven", format("%.2f m", s.distance_m).c_str());
  std::printf("  %-26s %12s\n", "energy from the battery", format("%.0f J", s.energy_j).c_str());
  std::printf("  %-26s %12s\n", "battery left",
              format("%.0f %%", 100.0 * s.battery_charge).c_str());
  if (s.charge_lasts_h.has_value())
    std::printf("  %-26s %12s\n", "a charge lasts", format("%.1f h", *s.charge_lasts_h).c_str());
  std::printf("  %-26s %12d\n", "peaks", s.peaks);
  std::printf("  %-26s %12s\n", s.robots.empty() ? "robot" : "robots", s.state.c_str());
  if (s.faults != 0) std::printf("  %-26s %12s\n", "faults", fault_names(s.faults).c_str());
  print_arming(s);
  std::printf("  %-26s %12llu\n", "telemetry frames",
              static_cast<unsigned long long>(s.telemetry_frames));
  std::printf("  %-26s %12s\n", "real-time factor", factor_text(s.real_time_factor()).c_str());
  std::printf("\n");
  print_terrain(s.terrain, s.leveling, experiment.experiment.flatness_deg);
  print_work(s.leveling.after);
  print_robots(s.robots);
  if (s.cycles.has_value()) print_cycles(*s.cycles);
  std::printf("\n  run folder    %s\n  content hash  %s\n", s.folder.c_str(),
              s.content_hash.c_str());
}

int run_sim(const SimArguments& arguments, const std::string& version) {
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
          std::printf("%s %s\n", summary.folder.c_str(), summary.content_hash.c_str());
        }
      },
      prepare);
  if (arguments.runs.json) std::cout << json_of(summaries, several);
  std::cout << std::flush;
  for (const std::string& failure : failures) std::cerr << failure << "\n";
  if (watching.viewer) {
    if (!several) watching.viewer->hold("The run has ended and is saved. Q closes the window.");
    if (view->frames.has_value()) std::cerr << watching.viewer->times().text() << "\n";
  }
  if (const int code = interrupted_exit_code(); code != 0) return code;
  return failures.empty() ? 0 : 1;
}

}  // namespace

void register_sim_command(Command& root, Program& program) {
  auto arguments = std::make_shared<SimArguments>();
  Command* command =
      root.add_subcommand("sim", "Run an experiment: the firmware drives in a simulated world");
  add_batch_options(*command, arguments->runs);
  add_number(*command, "--seed", arguments->seed, "Seed of the world; overrides [experiment] seed",
             kSeedRange);
  add_number(*command, "--duration", arguments->duration_s,
             "Simulated time [s]; overrides [experiment] duration", {0.01, 1e6});
  command
      ->add_option("--hal", arguments->world.hal,
                   "How the firmware runs: native: compiled for this machine; mcu: the flash image "
                   "under a cycle-accurate simulation of the microcontroller, of several robots in "
                   "the first; surrogate: native, with a closed form or a network (--model) in "
                   "place of the physics")
      ->show_default()
      ->one_of({"native", "mcu", "surrogate"});
  command->add_option("--board", arguments->world.board,
                      std::string("Board: a folder in boards/ (default: ") + kDefaultBoard + ")");
  command
      ->add_option("--elf", arguments->world.elf,
                   "ELF image for --hal mcu (default: the one of make firmware)")
      ->type_name("FILE");
  command
      ->add_option("--model", arguments->world.model,
                   "Motion network for --hal surrogate (default: none, the closed form)")
      ->type_name("FILE");
  command
      ->add_option("--terrain-net", arguments->world.terrain_net,
                   "Network that changes the ground below wheels with --model (default: none, it "
                   "stays as it is)")
      ->type_name("FILE");
  command
      ->add_option("--can", arguments->can,
                   "Publish the radio's frames on this CAN interface and receive commands from "
                   "it; implies --realtime")
      ->type_name("INTERFACE");
  command
      ->add_option("--pty", arguments->pty,
                   "Offer the radio as a virtual serial port, like that of an XBee, with a "
                   "symbolic link LINK to it; implies --realtime")
      ->type_name("LINK")
      ->expected(0, 1);
  command->add_flag("--realtime", arguments->realtime, "Do not run faster than real time");
  command->add_flag("--heights", arguments->heights,
                    "Record the height map of every tick, for `screed view` and for training");
  command->add_flag("--view", arguments->view,
                    "Show the running simulation in a window; arrow keys drive (H: all keys)");
  add_view_options(*command, arguments->viewer);
  auto list_keys = std::make_shared<bool>(false);
  command->add_flag("--keys", *list_keys, "List all keys of an experiment file and exit");
  command->callback([arguments, list_keys, &program] {
    if (*list_keys) {
      program.action = [] {
        std::cout
            << "| key | unit | default | allowed | meaning |\n| --- | --- | --- | --- | --- |\n"
            << experiment_key_table() << robot_section_table();
        return 0;
      };
      return;
    }
    if (arguments->runs.files.empty()) throw UsageError("FILE is required");
    program.action = [arguments, version = program.version] {
      return run_sim(*arguments, version);
    };
  });
}

}  // namespace screed
