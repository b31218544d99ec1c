// `screed soil fit`: the parameters of a soil from measurements on wheels or plates.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <memory>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/core/name_list.h"
#include "host_sim/soil_validation/soil_fit.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

struct FitArguments {
  std::vector<std::string> files;
  std::string cases;
  std::string preset = "viper";
  SoilOverrides overrides;
  std::vector<std::string> free;
  double rim_friction_deg = 90.0;
  double rim_adhesion_pa = 0.0;
  bool json = false;
};

double tangent_of(double friction_deg) {
  return friction_deg >= 90.0 ? std::numeric_limits<double>::infinity()
                              : portable::tan(friction_deg * std::numbers::pi / 180.0);
}

/// Mean errors of the wheels, as docs state them: forces over the load, sinkage over its value.
struct MeanErrors {
  double pull = 0.0;
  double side = 0.0;
  double sinkage = 0.0;
  int wheels = 0;
};

MeanErrors mean_errors(const SoilFit& fit, const SoilMeasurements& measured) {
  MeanErrors mean;
  double pulls = 0.0;
  double sides = 0.0;
  double depths = 0.0;
  const auto add = [](double& sum, double& count, double error) {
    sum += std::abs(error);
    count += 1.0;
  };
  for (const MeasuredWheel& row : measured.wheels) {
    const WheelReaction r = predicted_wheel(row.wheel, fit.soil, fit.rim);
    const double load = row.wheel.load_n;
    if (row.drawbar_pull_n) add(mean.pull, pulls, (r.drawbar_pull_n - *row.drawbar_pull_n) / load);
    if (row.side_force_n) add(mean.side, sides, (r.side_force_n - *row.side_force_n) / load);
    if (row.sinkage_m) add(mean.sinkage, depths, r.sinkage_m / *row.sinkage_m - 1.0);
    ++mean.wheels;
  }
  mean.pull /= std::max(pulls, 1.0);
  mean.side /= std::max(sides, 1.0);
  mean.sinkage /= std::max(depths, 1.0);
  return mean;
}

void print_json(const SoilFit& fit, const MeanErrors& mean) {
  Json parameters = Json::array();
  for (const FittedParameter& p : fit.parameters) {
    Json one = {{"key", p.key}, {"start", p.start}, {"value", p.value}};
    one["at_bound"] = p.at_bound;
    one["determined"] = p.determined;
    if (std::isfinite(p.standard_error)) one["standard_error"] = p.standard_error;
    parameters.push_back(one);
  }
  Json out = {{"parameters", parameters},
              {"spread", fit.spread},
              {"spreads", fit.spreads},
              {"measurements", fit.residuals},
              {"evaluations", fit.evaluations}};
  if (mean.wheels > 0) {
    out["mean_error"] = {{"pull_over_load", mean.pull},
                         {"side_over_load", mean.side},
                         {"sinkage_relative", mean.sinkage}};
  }
  print_sorted(std::move(out));
}

void print_fit(const SoilFit& fit, const SoilMeasurements& measured, const MeanErrors& mean) {
  std::printf("%-14s %12s %12s  %s\n", "parameter", "start", "fitted", "standard error");
  for (const FittedParameter& p : fit.parameters) {
    char error[40];
    std::snprintf(error, sizeof error, "%.3g", p.standard_error);
    std::printf("%-14s %12.5g %12.5g  %s\n", p.key.c_str(), p.start, p.value,
                p.at_bound      ? "lies at its bound"
                : !p.determined ? "not determined by these tests"
                                : error);
  }
  std::printf("\nspread %.2f of the errors assumed, %d measurements\n", fit.spread, fit.residuals);
  const auto same = std::count_if(fit.spreads.begin(), fit.spreads.end(), [&](double spread) {
    return spread < fit.spread + 0.01 * (fit.spread + 0.01);
  });
  std::printf("%d of %zu starts end there", static_cast<int>(same), fit.spreads.size());
  if (static_cast<size_t>(same) < fit.spreads.size())
    std::printf(", the others at spreads of %.2f to %.2f", fit.spreads[static_cast<size_t>(same)],
                fit.spreads.back());
  std::printf("\n");
  for (const MeasuredTransient& transient : measured.transients) {
    std::printf("\n%-34s %14s %12s %8s\n", transient.name.c_str(), "slip path, mm", "extra h, mm",
                "fitted");
    const std::vector<double> extra = predicted_transient(transient, fit.soil, fit.rim);
    for (size_t i = 0; i < extra.size(); ++i) {
      std::printf("%-34s %14.1f %12.2f %8.2f\n", "", transient.places[i].slip_path_m * kMilli,
                  transient.places[i].extra_sinkage_m * kMilli, extra[i] * kMilli);
    }
  }
  if (mean.wheels == 0) return;
  std::printf("\nmean error: pull %.3f W, side force %.3f W, sinkage %.1f %%\n\n", mean.pull,
              mean.side, 100.0 * mean.sinkage);
  std::printf("%-34s %8s %8s   %8s %8s   %8s %8s\n", "case", "pull, N", "fitted", "side, N",
              "fitted", "h, mm", "fitted");
  const auto field = [](const std::optional<double>& value, double scale) {
    char text[16];
    std::snprintf(text, sizeof text, "%8.2f", value.value_or(0.0) * scale);
    return value ? std::string(text) : std::string("       -");
  };
  for (const MeasuredWheel& row : measured.wheels) {
    const WheelReaction r = predicted_wheel(row.wheel, fit.soil, fit.rim);
    std::printf("%-34s %s %8.2f   %s %8.2f   %s %8.2f\n", row.name.c_str(),
                field(row.drawbar_pull_n, 1.0).c_str(), r.drawbar_pull_n,
                field(row.side_force_n, 1.0).c_str(), r.side_force_n,
                field(row.sinkage_m, kMilli).c_str(), r.sinkage_m * kMilli);
  }
}

void add_measurements(const SoilMeasurements& more, SoilMeasurements& all) {
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(all.wheels, more.wheels);
  append(all.transients, more.transients);
  append(all.plates, more.plates);
}

int run_fit(const FitArguments& a) {
  SoilFitProblem problem;
  problem.soil = soil_preset(a.preset);
  a.overrides.apply_to(problem.soil);
  problem.rim = {tangent_of(a.rim_friction_deg), a.rim_adhesion_pa};
  problem.free = a.free;
  for (const std::string& file : a.files)
    add_measurements(read_soil_measurements(file, a.cases), problem.measured);
  ProgressBar bar(std::cerr);
  const SoilFit fit = fit_soil(problem, [&](int evaluations) {
    // A fit takes some hundred evaluations; how many is not known before.
    bar.show_share(1.0 - 100.0 / (100.0 + evaluations), "fitting");
  });
  bar.clear();
  const MeanErrors mean = mean_errors(fit, problem.measured);
  if (a.json) {
    print_json(fit, mean);
  } else {
    print_fit(fit, problem.measured, mean);
  }
  return 0;
}

}  // namespace

void register_soil_fit_command(Command& soil, Program& program) {
  const auto a = std::make_shared<FitArguments>();
  Command* command =
      soil.add_subcommand("fit", "Fit a soil's parameters to tests of wheels or plates");
  command
      ->add_option("FILE", a->files,
                   "CSV of measurements, or several (docs/soil.md has the columns)")
      ->required()
      ->type_name("");
  command
      ->add_option("--free", a->free,
                   "Parameters to fit, with commas between them: keys of [soil], "
                   "rim_friction (tangent), rim_adhesion")
      ->delimiter(',')
      ->required()
      ->type_name("KEY,...");
  command->add_option("--case", a->cases, "Use the rows whose case begins with this text")
      ->type_name("CASE");
  command
      ->add_option("--soil", a->preset, "Begin with this soil: " + name_list(soil_preset_names()))
      ->show_default();
  for (const SoilParameterInfo& parameter : kSoilParameters) {
    add_number(*command, parameter.option, a->overrides.*parameter.override_member,
               option_help(parameter), {parameter.min, parameter.max});
  }
  add_number(*command, "--rim-friction", a->rim_friction_deg,
             "Angle of friction between rim and soil [deg]; 90: rough, soil shears on soil",
             {0.0, 90.0});
  add_number(*command, "--rim-adhesion", a->rim_adhesion_pa, "Adhesion of soil to the rim [Pa]",
             {0.0, 1e7});
  command->add_flag("--json", a->json, "Print JSON");
  command->callback([a, &program] { program.action = [a] { return run_fit(*a); }; });
}

}  // namespace screed
