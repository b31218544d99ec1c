// `screed session compare A B`: two recorded runs, as a table, JSON and one picture.
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
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
  return {{"time_s", end.time_s},
          {"x_m", end.x_m},
          {"y_m", end.y_m},
          {"heading_deg", kDegPerRad * end.heading_rad},
          {"distance_m", end.distance_m},
          {"state", end.state},
          {"leveling_state", end.leveling_state},
          {"faults", end.faults},
          {"battery_v", end.battery_v},
          {"energy_j", end.energy_j},
          {"terrain_change", end.change.has_value() ? json_of(*end.change) : Json()}};
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
  Json json = {{"identical", comparison.identical()}};
  for (std::size_t i = 0; i < 2; ++i) {
    const ComparedRun& run = comparison.runs.at(i);
    json[i == 0 ? "a" : "b"] = {{"run", arguments.runs.at(i)},
                                {"experiment", run.name},
                                {"program_version", run.program_version},
                                {"seed", run.seed},
                                {"frames", run.frames},
                                {"complete", run.complete},
                                {"content_hash", run.content_hash},
                                {"end", run.frames > 0 ? describe_end(run.end) : Json()}};
  }
  json["configuration"] = Json::array();
  for (const KeyDifference& it : comparison.configuration) {
    json["configuration"].push_back({{"key", it.key},
                                     {"a", it.a.has_value() ? Json(*it.a) : Json()},
                                     {"b", it.b.has_value() ? Json(*it.b) : Json()}});
  }
  json["common_ticks"] = comparison.common_ticks;
  json["first_difference"] = nullptr;
  if (const auto& first = comparison.first; first.has_value()) {
    json["first_difference"] = {{"tick", first->tick},     {"time_s", first->time_s},
                                {"column", first->column}, {"a", first->a},
                                {"b", first->b},           {"all_columns", first->all_columns}};
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

void print_both(const std::string& name, const std::string& a, const std::string& b) {
  print("  {:-28s} {:20s} {:20s}\n", name, a, b);
}

/// The columns that differ in the tick of the first difference, beside the first of them.
std::string other_columns(const Json& columns) {
  constexpr std::size_t kShown = 4;
  std::string others;
  for (std::size_t i = 1; i < std::min(kShown + 1, columns.size()); ++i)
    others += (others.empty() ? "" : ", ") + columns[i].text();
  if (columns.size() > kShown + 1)
    others += " and " + std::to_string(columns.size() - kShown - 1) + " more";
  return others;
}

void print_first_difference(const Json& json) {
  const Json& first = json["first_difference"];
  if (json["common_ticks"] == 0) {
    print("ticks          none that both have\n");
  } else if (first.is_null()) {
    print("ticks          equal in all {common_ticks} that both have\n", json);
  } else {
    print(
        "ticks          first difference in tick {tick} ({time_s:.2f} s), {column}: A {a}, B {b}\n",
        first);
    const Json& columns = first["all_columns"];
    if (columns.size() > 1) print("               in the same tick: {}\n", other_columns(columns));
  }
  if (json["a"]["frames"] != json["b"]["frames"])
    print("               A has {a.frames} ticks, B {b.frames}\n", json);
}

void print_ends(const Json& a, const Json& b) {
  const auto row = [&](const char* name, const char* text) {
    print_both(name, filled(text, a), filled(text, b));
  };
  print_both("end", "A", "B");
  row("time [s]", "{time_s:.2f}");
  row("x, y [m]", "{x_m:.3f}, {y_m:.3f}");
  row("heading [deg]", "{heading_deg:.1f}");
  row("driven [m]", "{distance_m:.2f}");
  row("state", "{state}");
  row("leveling state", "{leveling_state}");
  row("faults", "{faults}");
  row("battery [V]", "{battery_v:.2f}");
  row("energy [J]", "{energy_j:.1f}");
  const auto litres = [](const Json& end, const char* text) {
    const Json& change = end["terrain_change"];
    return change.is_null() ? "not recorded" : filled(text, change);
  };
  for (const auto& [name, text] :
       {std::pair("cut [L]", "{cut_m3*1000:.3f}"), std::pair("fill [L]", "{fill_m3*1000:.3f}")})
    print_both(name, litres(a, text), litres(b, text));
}

void print_comparison(const Json& json) {
  print("{}\n", json["identical"].get<bool>() ? "identical" : "different");
  for (const char* run : {"a", "b"}) {
    print("{}              ", run == std::string("a") ? "A" : "B");
    print("{run}: {experiment}, seed {seed}, {program_version}", json[run]);
    print(json[run]["complete"].get<bool>() ? "\n" : ", did not end\n");
  }
  const Json& configuration = json["configuration"];
  if (configuration.empty()) {
    print("configuration  the same\n");
  } else {
    print("configuration  {} {}\n", configuration.size(),
          configuration.size() == 1 ? "key differs" : "keys differ");
    for (const Json& it : configuration)
      print_both(it["key"].text(), it["a"].is_null() ? "not set" : it["a"].text(),
                 it["b"].is_null() ? "not set" : it["b"].text());
  }
  print_first_difference(json);
  if (const Json& apart = json["deviation"]; !apart.is_null()) {
    print(
        "apart          {last.position_m:.4f} m and {last.heading_deg:.2f} degrees at "
        "{last.time_s:.2f} s; most {largest_position.position_m:.4f} m at "
        "{largest_position.time_s:.2f} s, {largest_heading.heading_deg:.2f} degrees at "
        "{largest_heading.time_s:.2f} s\n",
        apart);
  }
  const Json& terrain = json["terrain"];
  if (terrain.contains("not_compared")) {
    print("terrain        not compared: {not_compared}\n", terrain);
  } else if (terrain["rms_m"] == 0.0) {
    print("terrain        the same at the end\n");
  } else {
    print(
        "terrain        B from A {deepest_cut_m*-1000:+.2f} to {deepest_fill_m*1000:+.2f} mm, rms "
        "{rms_m*1000:.3f} mm, {fill_m3*1000:.3f} L above and {cut_m3*1000:.3f} L below\n",
        terrain);
  }
  if (!json["a"]["end"].is_null() && !json["b"]["end"].is_null())
    print_ends(json["a"]["end"], json["b"]["end"]);
  if (!json["picture"].is_null()) print("picture        {picture}\n", json);
}

int compare_runs(const CompareArguments& arguments) {
  if (!arguments.no_picture && fs::path(arguments.out).extension() != ".png") {
    throw InputError("--out " + arguments.out + ": the name ends in .png");
  }
  const SessionReader a(session_file(arguments.runs[0]));
  const SessionReader b(session_file(arguments.runs[1]));
  const SessionComparison comparison = compare_sessions(a, b);
  if (!arguments.no_picture) {
    write_comparison_picture(arguments.out, comparison, arguments.runs);
  }
  Json json = to_json(comparison, arguments);
  json["picture"] = arguments.no_picture ? Json() : Json(arguments.out);
  arguments.json ? print_json(json) : print_comparison(json);
  return arguments.fail_if_different && !comparison.identical() ? 1 : 0;
}

}  // namespace

void register_session_compare_command(Command& session, Program& program) {
  auto [command, arguments] = add_subcommand<CompareArguments>(
      session, program, "compare",
      "Compare two runs: configuration, ticks, paths, terrain and ends", compare_runs);
  command.add_option("A", arguments.runs[0], "Run folder or session file")->required();
  command.add_option("B", arguments.runs[1], "Run folder or session file")->required();
  Option* out =
      command.add_option("--out", arguments.out, "Output picture, .png; replaced where it exists")
          ->type_name("FILE")
          ->show_default();
  command.add_flag("--no-picture", arguments.no_picture, "Print the comparison alone")
      ->excludes(out);
  command.add_flag("--json", arguments.json, "Print JSON");
  command.add_flag("--fail-if-different", arguments.fail_if_different,
                   "Exit with 1 unless the runs are identical (default: 0 either way)");
}

}  // namespace screed
