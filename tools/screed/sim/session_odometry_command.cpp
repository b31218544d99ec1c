// `screed session odometry RUN...`: how far dead reckoning was off, as a table or JSON.
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/run/comparison/odometry_errors.h"
#include "host_sim/run/session/run_folder.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

struct OdometryArguments {
  std::vector<std::string> runs;
  double length_m = 10.0;
  bool json = false;
};

Json json_of(const OdometrySummary& summary, double length_m) {
  Json json;
  json["leg_m"] = length_m;
  json["legs"] = summary.legs;
  for (std::size_t way = 0; way < kReckonings; ++way) {
    const OdometrySummary::Errors& errors = summary.errors[way];
    json["errors"][name_of(static_cast<Reckoning>(way))] = {
        {"median_m", errors.median_m},
        {"median_95_m", {errors.median_95_m.low, errors.median_95_m.high}},
        {"ninety_percent_m", errors.ninety_percent_m}};
  }
  json["consistency"] = summary.consistency;
  json["consistent_95"] = {summary.consistent.low, summary.consistent.high};
  return json;
}

void print_text(const OdometrySummary& summary, double length_m) {
  std::printf("%zu legs of %g m of the true path, error at their end [m]:\n", summary.legs,
              length_m);
  std::printf("%-30s %8s %16s %8s\n", "", "median", "95 % of it", "90 %");
  for (std::size_t way = 0; way < kReckonings; ++way) {
    const OdometrySummary::Errors& errors = summary.errors[way];
    std::printf("%-30s %8.2f %7.2f to %5.2f %8.2f\n", name_of(static_cast<Reckoning>(way)),
                errors.median_m, errors.median_95_m.low, errors.median_95_m.high,
                errors.ninety_percent_m);
  }
  std::printf(
      "squared error over the variance that the firmware states: %.2f; consistent from %.2f to "
      "%.2f\n",
      summary.consistency, summary.consistent.low, summary.consistent.high);
}

int run_odometry(const OdometryArguments& arguments) {
  TaskBar bar(arguments.json);
  std::vector<OdometryLeg> legs;
  for (const std::string& run : arguments.runs) {
    const auto of_run = odometry_legs(session_file(run), arguments.length_m, bar.progress());
    legs.insert(legs.end(), of_run.begin(), of_run.end());
  }
  bar.clear();
  if (legs.empty()) {
    throw InputError("no run is as long as one leg; --length must be shorter than what they drove");
  }
  const OdometrySummary summary = summarize(legs);
  if (arguments.json) {
    std::cout << json_of(summary, arguments.length_m).dump(2) << "\n";
  } else {
    print_text(summary, arguments.length_m);
  }
  return 0;
}

}  // namespace

void register_session_odometry_command(Command& session, Program& program) {
  auto arguments = std::make_shared<OdometryArguments>();
  Command* command = session.add_subcommand(
      "odometry", "Compare dead reckoning with the truth, over all legs of one or more runs");
  command->add_option("RUN", arguments->runs, "Run folders or session files")->required();
  add_number(*command, "--length", arguments->length_m, "Length of a leg along the true path [m]",
             {0.1, 1e6});
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_odometry(*arguments); }; });
}

}  // namespace screed
