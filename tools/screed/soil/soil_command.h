// What the subcommands of `screed soil` share: the options of soil and grid, and how what a test
// found is shown beside what it should be.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "tools/screed/cli/command.h"

#include "host_sim/core/json.h"
#include "host_sim/physics/particles/sphere_law.h"
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
  /// Puts soil, its handling and the grid into a test.
  template <class Test>
  void set(Test& test) const {
    test.soil = soil();
    test.options = options();
    test.cell_m = cell_m;
    test.step_s = step_s;
  }
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
/// Of a bed of particles: what they are made of, its depth, the layout's seed.
void add_particle_options(Command& command, ParticleMaterial& particle, double& depth_m,
                          uint64_t& seed);
Json particles_json(const ParticleMaterial& particle, double depth_m, uint64_t seed, int beds);
Json soil_json(const SoilArguments& arguments);
/// Prints JSON, members in the order of their names.
void print_sorted(Json json);

/// What a test found.
struct SoilReport {
  const char* test;  ///< for programs
  std::string heading;
  std::string limit_name;  ///< what the column of limits is called
  std::vector<SoilLine> lines;
  Json more = Json::object();  ///< further members for programs; "particles": there is no soil
  std::string below = "";      ///< text under the table
};
/// Prints table or JSON; the exit code.
int print(const SoilArguments& arguments, SoilReport report);

/// A subcommand that runs one test. `Arguments` are SoilArguments with what it adds to them; the
/// caller adds the options of those.
template <class Arguments>
Command* add_soil_test(Command& soil, Program& program, const char* name, const char* help,
                       const std::shared_ptr<Arguments>& arguments, SoilReport (*run)(Arguments),
                       const SoilGridRanges& ranges = {}) {
  Command* command = soil.add_subcommand(name, help);
  add_soil_options(*command, *arguments, ranges);
  command->callback([arguments, run, &program] {
    program.action = [arguments, run] { return print(*arguments, run(*arguments)); };
  });
  return command;
}

}  // namespace screed
