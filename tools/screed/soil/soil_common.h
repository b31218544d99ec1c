// What the subcommands of `screed soil` share: the options of soil and grid, and how results are
// shown beside what they should be.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include "tools/command_line/command.h"

#include "host_sim/core/json.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "tools/screed/cli/number_option.h"

namespace screed {

inline constexpr double kMilli = 1e3;

/// A number in printf's format.
std::string text(const char* format, double value);

/// One line of a result: a figure beside what it should be and what a peer's engine gives.
struct SoilLine {
  std::string where;  ///< "slip 0.2", "depth 5 mm"
  std::string name;   ///< for programs, unit included
  double value;
  const char* format;
  std::optional<double> limit = std::nullopt;  ///< closed form, limit or measurement
  enum class Error { kRelative, kAbsolute, kNone } error = Error::kNone;
  std::optional<double> peer = std::nullopt;
};

/// Help of the option that sets a soil parameter.
std::string option_help(const SoilParameterInfo& parameter);

/// Options that every test has.
struct SoilArguments {
  std::string preset = "viper";
  SoilOverrides overrides;
  std::string normal_stress = "radial";
  bool bulldozing = false;
  bool avalanches = false;
  bool follow_slopes = SoilOptions{}.follow_slopes;
  double sample_spacing_m = SoilOptions{}.sample_spacing_m;
  double cell_m = 0.005;
  double step_s = 1e-3;
  std::string charts;
  bool json = false;

  /// The preset with what was given in its place. Throws InputError.
  SoilParameters soil() const;
  SoilOptions options() const;
  /// The place of a chart; its folder is made.
  std::filesystem::path chart(const char* name) const;
  /// Whether the soil and its handling are those of the peer's figures.
  bool as_peer() const;
};

/// Of --cell and --step; a test may need others.
struct SoilGridRanges {
  NumberRange cell_m = {0.0005, 0.1};
  NumberRange step_s = {1e-5, 0.02};
};

void add_soil_options(Command& command, SoilArguments& arguments,
                      const SoilGridRanges& ranges = {});

void print_table(const std::string& heading, const char* limit_name,
                 const std::vector<SoilLine>& lines);
Json to_json(const std::vector<SoilLine>& lines);
Json soil_json(const SoilArguments& arguments);
/// Prints JSON, members in the order of their names.
void print_sorted(Json json);
/// Prints table or JSON; the exit code.
int finish(const SoilArguments& arguments, const char* test, const std::string& heading,
           const char* limit_name, const std::vector<SoilLine>& lines);

}  // namespace screed
