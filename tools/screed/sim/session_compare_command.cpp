// `screed session compare A B`: two recorded runs, as a table, JSON and one picture.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/run/comparison/comparison_picture.h"
#include "host_sim/run/comparison/session_comparison.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/run_report.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct CompareArguments {
  std::array<std::string, 2> runs;
  std::string out = "compare.png";
  bool no_picture = false;
  bool json = false;
  bool fail_if_different = false;
};

Json describe_end(const FinalState& end) {
  Json json;
  json["time_s"] = end.time_s;
  json["x_m"] = end.x_m;
  json["y_m"] = end.y_m;
  json["heading_deg"] = kDegPerRad * end.heading_rad;
  json["distance_m"] = end.distance_m;
  json["state"] = end.state;
  json["leveling_state"] = end.leveling_state;
  json["faults"] = end.faults;
  json["battery_v"] = end.battery_v;
  json["energy_j"] = end.energy_j;
  json["terrain_change"] = end.change.has_value() ? json_of(*end.change) : Json();
  return json;
}

Json describe_point(const DeviationPoint& point) {
  return {{"time_s", point.time_s},
          {"position_m", point.position_m},
          {"heading_deg", kDegPerRad * point.heading_rad}};
}

Json describe_terrain(const TerrainDifference& terrain) {
  if (!terrain.not_comparable.empty()) return {{"not_compared", terrain.not_comparable}};
  Json json = json_of(terrain.change);
  json["rms_m"] = terrain.rms_m;
  return json;
}

Json to_json(const SessionComparison& comparison, const CompareArguments& arguments) {
  Json json;
  json["identical"] = comparison.identical();
  for (std::size_t i = 0; i < 2; ++i) {
    const ComparedRun& run = comparison.runs.at(i);
    Json one;
    one["run"] = arguments.runs.at(i);
    one["experiment"] = run.name;
    one["program_version"] = run.program_version;
    one["seed"] = run.seed;
    one["frames"] = run.frames;
    one["complete"] = run.complete;
    one["content_hash"] = run.content_hash;
    one["end"] = run.frames > 0 ? describe_end(run.end) : Json();
    json[i == 0 ? "a" : "b"] = one;
  }
  json["configuration"] = Json::array();
  for (const KeyDifference& it : comparison.configuration) {
    json["configuration"].push_back({{"key", it.key},
                                     {"a", it.a.has_value() ? Json(*it.a) : Json()},
                                     {"b", it.b.has_value() ? Json(*it.b) : Json()}});
  }
  json["common_ticks"] = comparison.common_ticks;
  json["first_difference"] = nullptr;
  if (comparison.first.has_value()) {
    const FirstDifference& first = *comparison.first;
    json["first_difference"] = {{"tick", first.tick},     {"time_s", first.time_s},
                                {"column", first.column}, {"a", first.a},
                                {"b", first.b},           {"all_columns", first.all_columns}};
  }
  json["deviation"] = nullptr;
  if (comparison.summary.has_value()) {
    json["deviation"] = {{"last", describe_point(comparison.summary->last)},
                         {"largest_position", describe_point(comparison.summary->largest_position)},
                         {"largest_heading", describe_point(comparison.summary->largest_heading)}};
  }
  json["terrain"] = describe_terrain(comparison.terrain);
  json["same_terrain"] = comparison.same_terrain;
  return json;
}

void print_row(const std::string& name, const std::string& a, const std::string& b) {
  std::printf("  %-28s %20s %20s\n", name.c_str(), a.c_str(), b.c_str());
}

std::string number(double value, int decimals) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

void print_first_difference(const SessionComparison& comparison) {
  constexpr std::size_t kShown = 4;
  const std::array<std::uint64_t, 2> frames = {comparison.runs[0].frames,
                                               comparison.runs[1].frames};
  if (comparison.common_ticks == 0) {
    std::printf("ticks          none that both have\n");
  } else if (!comparison.first.has_value()) {
    std::printf("ticks          equal in all %llu that both have\n",
                static_cast<unsigned long long>(comparison.common_ticks));
  } else {
    const FirstDifference& first = *comparison.first;
    std::printf("ticks          first difference in tick %llu (%.2f s), %s: A %s, B %s\n",
                static_cast<unsigned long long>(first.tick), first.time_s, first.column.c_str(),
                first.a.c_str(), first.b.c_str());
    if (first.all_columns.size() > 1) {
      std::string others;
      for (std::size_t i = 1; i < std::min(kShown + 1, first.all_columns.size()); ++i) {
        others += (others.empty() ? "" : ", ") + first.all_columns[i];
      }
      if (first.all_columns.size() > kShown + 1) {
        others += " and " + std::to_string(first.all_columns.size() - kShown - 1) + " more";
      }
      std::printf("               in the same tick: %s\n", others.c_str());
    }
  }
  if (frames[0] != frames[1]) {
    std::printf("               A has %llu ticks, B %llu\n",
                static_cast<unsigned long long>(frames[0]),
                static_cast<unsigned long long>(frames[1]));
  }
}

void print_ends(const FinalState& a, const FinalState& b) {
  print_row("end", "A", "B");
  print_row("time [s]", number(a.time_s, 2), number(b.time_s, 2));
  print_row("x, y [m]", number(a.x_m, 3) + ", " + number(a.y_m, 3),
            number(b.x_m, 3) + ", " + number(b.y_m, 3));
  print_row("heading [deg]", number(kDegPerRad * a.heading_rad, 1),
            number(kDegPerRad * b.heading_rad, 1));
  print_row("driven [m]", number(a.distance_m, 2), number(b.distance_m, 2));
  print_row("state", a.state, b.state);
  print_row("leveling state", a.leveling_state, b.leveling_state);
  print_row("faults", a.faults, b.faults);
  print_row("battery [V]", number(a.battery_v, 2), number(b.battery_v, 2));
  print_row("energy [J]", number(a.energy_j, 1), number(b.energy_j, 1));
  const auto litres = [](const FinalState& end, double TerrainChange::*volume_m3) {
    return end.change.has_value() ? number(kLitresPerM3 * ((*end.change).*volume_m3), 3)
                                  : std::string("not recorded");
  };
  print_row("cut [L]", litres(a, &TerrainChange::cut_m3), litres(b, &TerrainChange::cut_m3));
  print_row("fill [L]", litres(a, &TerrainChange::fill_m3), litres(b, &TerrainChange::fill_m3));
}

void print_text(const SessionComparison& comparison, const CompareArguments& arguments) {
  std::printf("%s\n", comparison.identical() ? "identical" : "different");
  for (std::size_t i = 0; i < 2; ++i) {
    const ComparedRun& run = comparison.runs.at(i);
    std::printf("%c              %s: %s, seed %llu, %s%s\n", i == 0 ? 'A' : 'B',
                arguments.runs.at(i).c_str(), run.name.c_str(),
                static_cast<unsigned long long>(run.seed), run.program_version.c_str(),
                run.complete ? "" : ", did not end");
  }
  if (comparison.configuration.empty()) {
    std::printf("configuration  the same\n");
  } else {
    std::printf("configuration  %zu %s\n", comparison.configuration.size(),
                comparison.configuration.size() == 1 ? "key differs" : "keys differ");
    for (const KeyDifference& it : comparison.configuration) {
      print_row(it.key, it.a.value_or("not set"), it.b.value_or("not set"));
    }
  }
  print_first_difference(comparison);
  if (comparison.summary.has_value()) {
    const DeviationSummary& it = *comparison.summary;
    std::printf(
        "apart          %.4f m and %.2f degrees at %.2f s; most %.4f m at %.2f s, %.2f "
        "degrees at %.2f s\n",
        it.last.position_m, kDegPerRad * it.last.heading_rad, it.last.time_s,
        it.largest_position.position_m, it.largest_position.time_s,
        kDegPerRad * it.largest_heading.heading_rad, it.largest_heading.time_s);
  }
  const TerrainDifference& terrain = comparison.terrain;
  if (!terrain.not_comparable.empty()) {
    std::printf("terrain        not compared: %s\n", terrain.not_comparable.c_str());
  } else if (terrain.rms_m == 0.0) {
    std::printf("terrain        the same at the end\n");
  } else {
    std::printf(
        "terrain        B from A %+.2f to %+.2f mm, rms %.3f mm, %.3f L above and %.3f L "
        "below\n",
        -kMmPerM * terrain.change.deepest_cut_m, kMmPerM * terrain.change.deepest_fill_m,
        kMmPerM * terrain.rms_m, kLitresPerM3 * terrain.change.fill_m3,
        kLitresPerM3 * terrain.change.cut_m3);
  }
  if (comparison.runs[0].frames > 0 && comparison.runs[1].frames > 0) {
    print_ends(comparison.runs[0].end, comparison.runs[1].end);
  }
}

int run_compare(const CompareArguments& arguments) {
  if (!arguments.no_picture && fs::path(arguments.out).extension() != ".png") {
    throw InputError("--out " + arguments.out + ": the name ends in .png");
  }
  const SessionReader a(session_file(arguments.runs[0]));
  const SessionReader b(session_file(arguments.runs[1]));
  const SessionComparison comparison = compare_sessions(a, b);
  if (!arguments.no_picture) {
    write_comparison_picture(arguments.out, comparison, arguments.runs);
  }
  if (arguments.json) {
    Json json = to_json(comparison, arguments);
    json["picture"] = arguments.no_picture ? Json() : Json(arguments.out);
    // A path need not be UTF-8; JSON must.
    std::cout << json.dump(2, Json::BadText::kReplace) << "\n";
  } else {
    print_text(comparison, arguments);
    if (!arguments.no_picture) std::printf("picture        %s\n", arguments.out.c_str());
  }
  return arguments.fail_if_different && !comparison.identical() ? 1 : 0;
}

}  // namespace

void register_session_compare_command(Command& session, Program& program) {
  auto arguments = std::make_shared<CompareArguments>();
  Command* command = session.add_subcommand(
      "compare", "Compare two runs: configuration, ticks, paths, terrain and ends");
  command->add_option("A", arguments->runs[0], "Run folder or session file")->required();
  command->add_option("B", arguments->runs[1], "Run folder or session file")->required();
  Option* out =
      command->add_option("--out", arguments->out, "Output picture, .png; replaced where it exists")
          ->type_name("FILE")
          ->show_default();
  command->add_flag("--no-picture", arguments->no_picture, "Print the comparison alone")
      ->excludes(out);
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--fail-if-different", arguments->fail_if_different,
                    "Exit with 1 unless the runs are identical (default: 0 either way)");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_compare(*arguments); }; });
}

}  // namespace screed
