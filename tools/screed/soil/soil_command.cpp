// `screed soil`: the reference tests of the deformable soil. Their options, tables and JSON.
#include "tools/screed/soil/soil_command.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iostream>

#include "commands.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/name_list.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

std::string error_of(const SoilLine& line) {
  if (!line.limit || line.error == SoilLine::Error::kNone) return "";
  if (line.error == SoilLine::Error::kAbsolute) return text("%+.5f", line.value - *line.limit);
  return *line.limit == 0.0 ? "" : text("%+.3f %%", 100.0 * (line.value / *line.limit - 1.0));
}

/// Of a flag that can be switched off.
std::string by_default(bool on) {
  return on ? " (default: on)" : " (default: off)";
}

void print_table(const SoilReport& report) {
  std::cout << report.heading << "\n\n";
  std::vector<std::vector<std::string>> rows = {
      {"", "", "result", report.limit_name, "error", "Chrono"}};
  for (const SoilLine& line : report.lines) {
    rows.push_back({line.where, line.name, text(line.format, line.value),
                    line.limit ? text(line.format, *line.limit) : "", error_of(line),
                    line.peer ? text(line.format, *line.peer) : ""});
  }
  // Columns that say nothing stay away.
  std::vector<size_t> widths(rows[0].size(), 0);
  for (size_t column = 0; column < widths.size(); ++column) {
    bool any = false;
    for (size_t i = 0; i < rows.size(); ++i) {
      any = any || (i > 0 && !rows[i][column].empty());
      widths[column] = std::max(widths[column], rows[i][column].size());
    }
    if (!any) widths[column] = 0;
  }
  for (const std::vector<std::string>& row : rows) {
    std::string out;
    for (size_t column = 0; column < row.size(); ++column) {
      if (widths[column] == 0) continue;
      const std::string fill(widths[column] - row[column].size() + 2, ' ');
      out += column < 2 ? row[column] + fill : fill + row[column];
    }
    out.erase(out.find_last_not_of(' ') + 1);
    std::cout << out << "\n";
  }
  std::cout << report.below;
}

Json to_json(const std::vector<SoilLine>& lines) {
  Json all = Json::array();
  for (const SoilLine& line : lines) {
    Json one = {{"where", line.where}, {"name", line.name}, {"value", line.value}};
    if (line.limit) one["limit"] = *line.limit;
    if (line.peer) one["chrono"] = *line.peer;
    all.push_back(one);
  }
  return all;
}

}  // namespace

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

/// The meaning as a sentence; before what it adds behind a semicolon the symbol, where the option's
/// name does not say it, and the unit.
std::string option_help(const SoilParameterInfo& parameter) {
  std::string help = parameter.meaning;
  help[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(help[0])));
  std::string named = parameter.option + 2;
  std::replace(named.begin(), named.end(), '-', '_');
  const std::string symbol = named == parameter.key ? "" : std::string(" ") + parameter.key;
  const std::string unit = *parameter.unit != '\0' ? std::string(" [") + parameter.unit + "]" : "";
  return help.insert(std::min(help.find(';'), help.size()), symbol + unit);
}

SoilParameters SoilArguments::soil() const {
  SoilParameters soil = soil_preset(preset);
  overrides.apply_to(soil);
  if (!overrides.empty()) soil.name = preset + ", changed";
  check_soil(soil);
  return soil;
}

SoilOptions SoilArguments::options() const {
  if (normal_stress != "radial" && normal_stress != "vertical") {
    throw InputError("soil: normal-stress = " + normal_stress + "; allowed is radial or vertical");
  }
  check_range("soil", "sample-spacing", sample_spacing_m, 1e-4, 0.1);
  SoilOptions options;
  options.normal_stress =
      normal_stress == "radial" ? NormalStress::kRadial : NormalStress::kVertical;
  options.bulldozing = bulldozing;
  options.avalanches = avalanches;
  options.follow_slopes = follow_slopes;
  options.sample_spacing_m = sample_spacing_m;
  return options;
}

std::filesystem::path SoilArguments::chart(const char* name) const {
  std::error_code error;
  std::filesystem::create_directories(charts, error);
  if (error) throw RunError(charts + ": the folder cannot be made");
  return std::filesystem::path(charts) / name;
}

bool SoilArguments::as_peer() const {
  return preset == "viper" && step_s == 1e-3 && overrides.empty();
}

void add_soil_options(Command& command, SoilArguments& common, const SoilGridRanges& ranges) {
  command.add_option("--soil", common.preset, "Soil preset: " + name_list(soil_preset_names()))
      ->show_default();
  for (const SoilParameterInfo& parameter : kSoilParameters) {
    add_number(command, parameter.option, common.overrides.*parameter.override_member,
               option_help(parameter), {parameter.min, parameter.max});
  }
  command
      .add_option("--normal-stress", common.normal_stress,
                  "Direction of the normal stress: radial or vertical")
      ->show_default();
  command.add_flag(
      "--bulldozing,!--no-bulldozing", common.bulldozing,
      "Push sunk material aside; otherwise compact it" + by_default(common.bulldozing));
  command.add_flag("--avalanches,!--no-avalanches", common.avalanches,
                   "Let slopes above the angle of repose slide" + by_default(common.avalanches));
  command.add_flag("--follow-slopes,!--no-follow-slopes", common.follow_slopes,
                   "Assume that bodies follow the slope of their path; otherwise a level path" +
                       by_default(common.follow_slopes));
  add_number(command, "--sample-spacing", common.sample_spacing_m,
             "Spacing of sample points inside a cell [m]", {1e-4, 0.1});
  add_number(command, "--cell", common.cell_m, "Cell size of the grid [m]", ranges.cell_m);
  add_number(command, "--step", common.step_s, "Time step [s]", ranges.step_s);
  command.add_flag("--json", common.json, "Print JSON");
}

void add_particle_options(Command& command, ParticleMaterial& particle, double& depth_m,
                          uint64_t& seed) {
  add_number(command, "--particle-radius", particle.radius_m, "Particle radius [m]", {0.002, 0.1});
  add_number(command, "--particle-friction", particle.friction,
             "Friction coefficient of the particles", {0.0, 2.0});
  add_number(command, "--depth", depth_m, "Depth of the particle bed [m]", {0.02, 1.0});
  add_number(command, "--seed", seed, "Seed of the particle layout", kSeedRange);
}

Json particles_json(const ParticleMaterial& particle, double depth_m, uint64_t seed, int beds) {
  return {{"radius_m", particle.radius_m},
          {"friction", particle.friction},
          {"depth_m", depth_m},
          {"seed", seed},
          {"beds", beds}};
}

Json soil_json(const SoilArguments& common) {
  const SoilParameters soil = common.soil();
  Json json = {{"name", soil.name},
               {"normal_stress", common.normal_stress},
               {"bulldozing", common.bulldozing},
               {"avalanches", common.avalanches},
               {"follow_slopes", common.follow_slopes},
               {"cell_m", common.cell_m},
               {"step_s", common.step_s}};
  for (const SoilParameterInfo& parameter : kSoilParameters)
    json[parameter.member_name] = soil.*parameter.member;
  return json;
}

void print_sorted(Json json) {
  json.sort_members();
  std::cout << json.dump(2) << "\n";
}

int print(const SoilArguments& common, SoilReport report) {
  if (common.json) {
    report.more["test"] = report.test;
    if (!report.more.contains("particles")) report.more["soil"] = soil_json(common);
    report.more["results"] = to_json(report.lines);
    print_sorted(std::move(report.more));
  } else {
    print_table(report);
  }
  return 0;
}

void register_soil_command(Command& root, Program& program) {
  Command* command = root.add_subcommand("soil", "Run reference tests of the deformable soil");
  register_soil_subcommands(*command, program);
}

}  // namespace screed
