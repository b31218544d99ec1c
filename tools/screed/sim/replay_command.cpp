// `screed replay RUN`: does this build still compute what was recorded? Exit codes: 0 the outputs
// are identical, 1 they differ, 2 wrong RUN. With --set: what would the robot have answered with
// other parameters? Exit codes: 0, 2 wrong RUN or key.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/json.h"
#include "host_sim/core/record.h"
#include "host_sim/render/chart/stacked_chart.h"
#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/outcome.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

// ---- replay ----

struct ReplayArguments {
  std::string run;
  std::vector<std::string> sets;
  std::optional<std::string> picture;
  bool json = false;
};

Json json_of(const std::string& run, const ReplayResult& result) {
  const bool differs = result.first_difference_tick.has_value();
  return {{"run", run},
          {"ticks", result.ticks},
          {"identical", !differs},
          {"first_difference_tick", differs ? Json(*result.first_difference_tick) : Json()},
          {"first_difference", differs ? Json(result.first_difference) : Json()},
          {"output_hash", result.output_hash},
          {"complete", result.complete},
          {"unchanged", result.unchanged}};
}

/// The first robot of a run, with the others, if there are any, as a list.
void print_robots(const std::vector<Json>& robots) {
  Json json = robots.front();
  for (size_t i = 1; i < robots.size(); ++i) json["further_robots"].push_back(robots[i]);
  print_json(json, -1);
}

/// What a user calls the run of a robot.
std::string run_of_robot(const std::string& run, size_t robot) {
  return robot == 0 ? run : folder_of_robot(run, robot).string();
}

void print_text(const std::string& of, const ReplayResult& result) {
  std::cout << of << result.ticks << " ticks replayed, ";
  if (result.first_difference_tick) {
    std::cout << "first difference at tick " << *result.first_difference_tick << ": "
              << result.first_difference << "\n";
  } else {
    std::cout << "outputs identical\n";
  }
}

void print_notes(const std::string& of, const ReplayResult& result) {
  if (!result.complete) {
    std::cerr << "note: " << of
              << (result.running ? "the run goes on" : "the recorded run did not end")
              << "; only its saved ticks were replayed\n";
  }
  if (result.arithmetic != arithmetic()) {
    std::cerr << "note: " << of << "the world was computed with arithmetic '" << result.arithmetic
              << "', not this program's '" << arithmetic()
              << "': its experiment run again gives other bits\n";
  }
  if (!result.unchanged) {
    std::cerr << "note: " << of << "the session does not have the content it was saved with\n";
  }
}

// ---- what if ----

/// The recorded parameters with what the user sets on top.
Parameters changed_parameters(const SessionInfo& info, const std::vector<std::string>& sets) {
  Experiment experiment;
  experiment.parameters = info.parameters;
  for (const std::string& text : sets) {
    const IniEntry entry = parse_override(text);
    const bool algorithm = entry.section == "experiment" && entry.key == "algorithm";
    if (entry.section != "parameters" && !algorithm) {
      throw InputError("--set " + text +
                       ": a recorded drive is what it was; allowed are parameters.KEY and "
                       "experiment.algorithm");
    }
    apply_override(experiment, text);
    if (algorithm) {
      if (experiment.experiment.algorithm == kTrainingDriveName) {
        throw InputError("--set " + text + ": its legs follow from a run's duration; sim runs it");
      }
      experiment.parameters.algorithm() = algorithm_number(experiment.experiment.algorithm);
    }
  }
  if (!experiment.parameters.valid()) {
    throw InputError("--set: a robot refuses these parameters, which do not fit together");
  }
  return experiment.parameters;
}

/// As the column "time" of frames.
double time_after(std::uint64_t tick) {
  return static_cast<double>(tick + 1) / kTickRate_hz;
}

/// Recorded and replayed outputs side by side.
class OutputChanges {
 public:
  struct Change {
    const Column* column;
    std::uint64_t ticks = 0;
    std::uint64_t first = 0;
    std::optional<int> largest;  ///< difference, of a duty
  };

  OutputChanges() {
    for (const Column& column : kOutputColumns) changes_.push_back({&column, 0, 0, {}});
    of("duty_left").largest = of("duty_right").largest = 0;
  }

  void add(std::uint64_t tick, const RobotOutput& recorded, const RobotOutput& replayed,
           const Robot& robot) {
    std::array<std::uint8_t, kOutputBytes> was{};
    std::array<std::uint8_t, kOutputBytes> is{};
    pack(recorded, OutputRow(was));
    pack(replayed, OutputRow(is));
    for (Change& it : changes_) {
      const std::size_t size = std::size_t{element_bytes(it.column->type)} * it.column->count;
      const auto begin = was.begin() + it.column->offset;
      if (std::equal(begin, begin + static_cast<std::ptrdiff_t>(size),
                     is.begin() + it.column->offset)) {
        continue;
      }
      if (it.ticks == 0) it.first = tick;
      ++it.ticks;
    }
    note(of("duty_left"), replayed.duty_left - recorded.duty_left);
    note(of("duty_right"), replayed.duty_right - recorded.duty_right);
    const double time_s = time_after(tick);
    const auto percent = [](int duty) { return 100.0 * duty / kDutyMax; };
    // Ten a second are enough to see where the two part.
    if (tick % 10 == 0) {
      left_[0].push_back({time_s, percent(recorded.duty_left)});
      left_[1].push_back({time_s, percent(replayed.duty_left)});
      right_[0].push_back({time_s, percent(recorded.duty_right)});
      right_[1].push_back({time_s, percent(replayed.duty_right)});
    }
    extend(replayed_states_, time_s, robot.supervisor().state(), robot.leveling().state());
  }

  /// Of the columns that differ somewhere.
  std::vector<Change> changes() const {
    std::vector<Change> some;
    for (const Change& it : changes_) {
      if (it.ticks > 0) some.push_back(it);
    }
    return some;
  }

  /// Duty and states over time, as recorded and with the changed parameters.
  std::string picture(const SessionReader& session, const std::string& title,
                      const std::string& subtitle) const {
    std::vector<ChartBand> recorded_states;
    for_each_frame(session, session.frames(), [&](std::uint64_t tick, const SimFrame& frame) {
      extend(recorded_states, time_after(tick), static_cast<RobotState>(frame.state),
             static_cast<message::LevelingState>(frame.leveling_state));
    });
    StackedChart chart;
    chart.title = title;
    chart.subtitle = subtitle;
    chart.x_label = "time [s]";
    for (const auto& [side, series] : {std::pair("left", &left_), std::pair("right", &right_)}) {
      ChartPanel& panel = chart.panels.emplace_back();
      panel.title = std::string("duty, ") + side + " [%]";
      panel.series.push_back({"recorded", (*series)[0], false});
      panel.series.push_back({"what if", (*series)[1], false});
      panel.series.back().dashed = true;
    }
    chart.panels.push_back({});
    chart.panels.back().rows = {{"recorded", recorded_states}, {"what if", replayed_states_}};
    return stacked_chart_svg(chart);
  }

 private:
  Change& of(std::string_view name) {
    return *std::ranges::find(changes_, name, [](const Change& it) { return it.column->name; });
  }

  static void note(Change& change, int difference) {
    change.largest = std::max(*change.largest, std::abs(difference));
  }

  /// What the algorithm does while it runs, otherwise why it does not.
  static void extend(std::vector<ChartBand>& bands, double time_s, RobotState state,
                     message::LevelingState leveling) {
    const bool running = state == RobotState::kRunning;
    const std::string name = running ? leveling_state_name(leveling) : state_name(state);
    if (!bands.empty()) bands.back().end = time_s;
    if (bands.empty() || bands.back().name != name) {
      const Color color = state_color(running ? static_cast<std::size_t>(leveling) : 0);
      bands.push_back({time_s, time_s, name, color});
    }
  }

  std::vector<Change> changes_;
  std::array<std::vector<ChartPoint>, 2> left_;
  std::array<std::vector<ChartPoint>, 2> right_;
  std::vector<ChartBand> replayed_states_;
};

Json json_of(const std::vector<OutputChanges::Change>& changes) {
  Json list = Json::array();
  for (const OutputChanges::Change& it : changes) {
    list.push_back({{"column", it.column->name},
                    {"ticks", it.ticks},
                    {"first_tick", it.first},
                    {"largest", it.largest.has_value() ? Json(*it.largest) : Json()}});
  }
  return list;
}

void print_changes(const ReplayResult& result, const std::vector<OutputChanges::Change>& changes) {
  if (changes.empty()) return;
  print("  {:-18s} {:12s} {:12s} {:12s}\n", "output", "ticks", "first at", "differs by");
  for (const OutputChanges::Change& it : changes) {
    const double share = static_cast<double>(it.ticks) / static_cast<double>(result.ticks);
    print("  {:-18s} {:12s} {:12s} {:12s}\n", it.column->name, filled("{*100:.1f} %", share),
          filled("{:.2f} s", time_after(it.first)),
          it.largest.has_value() ? "up to " + std::to_string(*it.largest) : std::string());
  }
}

/// The picture of one robot: beside those of others, with its number.
std::string picture_path(const std::string& path, std::size_t robot, std::size_t robots) {
  if (robots == 1) return path;
  const std::filesystem::path name(path);
  return (name.parent_path() /
          (name.stem().string() + "_robot_" + std::to_string(robot) + name.extension().string()))
      .string();
}

/// Draws what changed and says where.
void draw(const ReplayArguments& arguments, const SessionReader& session,
          const OutputChanges& outputs, const std::string& path, const std::string& of) {
  std::string changed;
  for (const std::string& set : arguments.sets) changed += (changed.empty() ? "" : ", ") + set;
  write_picture(
      path, outputs.picture(session, session.info().experiment_name + ": " + of + changed,
                            "open loop: what the robot would have answered to what it sensed on "
                            "the recorded drive"));
  if (!arguments.json) print("  picture            {}\n", path);
}

int replay_run(const ReplayArguments& arguments) {
  const bool what_if = !arguments.sets.empty();
  if (arguments.picture.has_value()) {
    if (!what_if) throw UsageError("--picture needs --set");
    check_picture_name("--picture", *arguments.picture);
  }
  const std::vector<std::filesystem::path> files = session_files(arguments.run);
  std::vector<Json> robots;
  bool identical = true;
  TaskBar bar(arguments.json);
  for (std::size_t i = 0; i < files.size(); ++i) {
    OutputChanges outputs;
    ReplayOptions options;
    options.progress = bar.progress();
    if (what_if) {
      options.parameters = changed_parameters(SessionReader(files[i]).info(), arguments.sets);
      options.on_tick = [&](const auto&... of_tick) { outputs.add(of_tick...); };
    }
    const ReplayResult result = replay_session(files[i], options);
    identical = identical && !result.first_difference_tick;
    bar.clear();
    const std::string of = files.size() > 1 ? "robot " + std::to_string(i) + ": " : "";
    print_notes(of, result);
    Json& json = robots.emplace_back(json_of(run_of_robot(arguments.run, i), result));
    if (!arguments.json) print_text(of, result);
    if (!what_if) continue;
    json["open_loop"] = true;
    json["changes"] = json_of(outputs.changes());
    if (!arguments.json) print_changes(result, outputs.changes());
    if (!arguments.picture.has_value()) continue;
    const std::string path = picture_path(*arguments.picture, i, files.size());
    json["picture"] = path;
    draw(arguments, SessionReader(files[i]), outputs, path, of);
  }
  if (arguments.json) {
    print_robots(robots);
  } else if (what_if) {
    print(
        "open loop: the robot sensed what it did on the recorded drive; it does not go where these "
        "outputs would take it\n");
  }
  return identical || what_if ? 0 : 1;
}

}  // namespace

void register_replay_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<ReplayArguments>(
      root, program, "replay",
      "Feed a recorded run to the firmware again and compare its outputs byte for byte",
      replay_run);
  command.add_option("RUN", arguments.run, "Run folder or session.h5")->required();
  command
      .add_option("--set", arguments.sets,
                  "What if: replay with another parameter, parameters.key=value or "
                  "experiment.algorithm=name, and show which outputs change")
      ->type_name("KEY=VALUE")
      ->one_value_each();
  command
      .add_option(
          "--picture", arguments.picture,
          "Draw duty and states as recorded and with --set: .svg or .png; of several robots "
          "one for each, NAME_robot_0 and so on")
      ->type_name("FILE");
  command.add_flag("--json", arguments.json, "Print the result as JSON");
}

}  // namespace screed
