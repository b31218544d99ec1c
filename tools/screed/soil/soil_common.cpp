// Options, tables and JSON of `screed soil`.
#include "tools/screed/soil/soil_common.h"

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

std::string error_of(const SoilLine& line) {
  if (!line.limit || line.error == SoilLine::Error::kNone) return "";
  if (line.error == SoilLine::Error::kAbsolute) return text("%+.5f", line.value - *line.limit);
  return *line.limit == 0.0 ? "" : text("%+.3f %%", 100.0 * (line.value / *line.limit - 1.0));
}

}  // namespace

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

void print_table(const std::string& heading, const char* limit_name,
                 const std::vector<SoilLine>& lines) {
  std::cout << heading << "\n\n";
  std::vector<std::vector<std::string>> rows = {{"", "", "result", limit_name, "error", "Chrono"}};
  for (const SoilLine& line : lines) {
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
}

nlohmann::json to_json(const std::vector<SoilLine>& lines) {
  nlohmann::json all = nlohmann::json::array();
  for (const SoilLine& line : lines) {
    nlohmann::json one = {{"where", line.where}, {"name", line.name}, {"value", line.value}};
    if (line.limit) one["limit"] = *line.limit;
    if (line.peer) one["chrono"] = *line.peer;
    all.push_back(one);
  }
  return all;
}

SoilParameters SoilArguments::soil() const {
  SoilParameters soil = soil_preset(preset);
  for (const auto& [option, member] : given) {
    if (option->count() == 0) continue;
    soil.*member = custom.*member;
    soil.name = preset + ", changed";
  }
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
  if (preset != "viper" || step_s != 1e-3) return false;
  return std::none_of(given.begin(), given.end(),
                      [](const auto& option) { return option.first->count() > 0; });
}

void add_soil_options(CLI::App& command, SoilArguments& common) {
  std::string names;
  for (const SoilParameters& preset : soil_presets()) {
    names += (names.empty() ? "" : ", ") + preset.name;
  }
  command.add_option("--soil", common.preset, "Soil preset: " + names);
  const auto parameter = [&](const char* name, double SoilParameters::*member, const char* what) {
    common.given.emplace_back(command.add_option(name, common.custom.*member, what), member);
  };
  parameter("--k-phi", &SoilParameters::k_phi,
            "Bekker frictional modulus [N/m^(n+2)]; overrides the preset, as do the following "
            "parameters");
  parameter("--k-c", &SoilParameters::k_c, "Bekker cohesive modulus [N/m^(n+1)]");
  parameter("--exponent", &SoilParameters::exponent, "Bekker sinkage exponent n");
  parameter("--cohesion", &SoilParameters::cohesion_pa, "Cohesion [Pa]");
  parameter("--friction", &SoilParameters::friction_deg, "Angle of internal friction [deg]");
  parameter("--shear-modulus", &SoilParameters::shear_modulus_m,
            "Janosi-Hanamoto shear modulus K [m]");
  parameter("--elastic", &SoilParameters::elastic_pa_per_m, "Stiffness E of unloading [Pa/m]");
  parameter("--damping", &SoilParameters::damping_pa_s_per_m, "Damping R of sinking [Pa s/m]");
  parameter("--shear-damping", &SoilParameters::shear_damping_s,
            "Damping of small shear over its stiffness [s]");
  parameter("--repose", &SoilParameters::repose_deg, "Angle of repose [deg]");
  parameter("--compaction", &SoilParameters::compaction,
            "Share of the sunk volume that is compacted, 0..1");
  parameter("--drag-depth", &SoilParameters::drag_depth_m,
            "Thickness of the layer that a slipping rim digs away [m]");
  parameter("--slip-sinkage", &SoilParameters::slip_sinkage,
            "Growth of the sinkage exponent with slip");
  command.add_option("--normal-stress", common.normal_stress,
                     "Direction of the normal stress: radial or vertical");
  command.add_flag("--bulldozing,!--no-bulldozing", common.bulldozing,
                   "Push sunk material aside; otherwise compact it");
  command.add_flag("--avalanches,!--no-avalanches", common.avalanches,
                   "Let slopes above the angle of repose slide");
  command.add_flag("--follow-slopes,!--no-follow-slopes", common.follow_slopes,
                   "Assume that bodies follow the slope of their path; otherwise a level path");
  command.add_option("--sample-spacing", common.sample_spacing_m,
                     "Spacing of sample points inside a cell [m]");
  command.add_option("--cell", common.cell_m, "Cell size of the grid [m]");
  command.add_option("--step", common.step_s, "Time step [s]");
  command.add_flag("--json", common.json, "Print JSON");
}

nlohmann::json soil_json(const SoilArguments& common) {
  const SoilParameters s = common.soil();
  return {{"name", s.name},
          {"k_phi", s.k_phi},
          {"k_c", s.k_c},
          {"exponent", s.exponent},
          {"cohesion_pa", s.cohesion_pa},
          {"friction_deg", s.friction_deg},
          {"shear_modulus_m", s.shear_modulus_m},
          {"elastic_pa_per_m", s.elastic_pa_per_m},
          {"damping_pa_s_per_m", s.damping_pa_s_per_m},
          {"shear_damping_s", s.shear_damping_s},
          {"repose_deg", s.repose_deg},
          {"compaction", s.compaction},
          {"drag_depth_m", s.drag_depth_m},
          {"slip_sinkage", s.slip_sinkage},
          {"normal_stress", common.normal_stress},
          {"bulldozing", common.bulldozing},
          {"avalanches", common.avalanches},
          {"follow_slopes", common.follow_slopes},
          {"cell_m", common.cell_m},
          {"step_s", common.step_s}};
}

int finish(const SoilArguments& common, const char* test, const std::string& heading,
           const char* limit_name, const std::vector<SoilLine>& lines) {
  if (common.json) {
    const nlohmann::json out = {
        {"test", test}, {"soil", soil_json(common)}, {"results", to_json(lines)}};
    std::cout << out.dump(2) << "\n";
  } else {
    print_table(heading, limit_name, lines);
  }
  return 0;
}

}  // namespace screed
