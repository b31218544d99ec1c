// `screed session odometry RUN...`: how far dead reckoning was off, as a table or JSON.
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
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

void print_errors(const Json& json) {
  print("{legs} legs of {leg_m:g} m of the true path, error at their end [m]:\n", json);
  print("{:-30s} {:8s} {:16s} {:8s}\n", "", "median", "95 % of it", "90 %");
  for (const auto& [way, errors] : json["errors"].items()) {
    print("{:-30s}", way);
    print(" {median_m:8.2f} {median_95_m.0:7.2f} to {median_95_m.1:5.2f} {ninety_percent_m:8.2f}\n",
          errors);
  }
  print(
      "squared error over the variance that the firmware states: {consistency:.2f}; consistent "
      "from {consistent_95.0:.2f} to {consistent_95.1:.2f}\n",
      json);
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
  const Json json = json_of(summarize(legs), arguments.length_m);
  arguments.json ? print_json(json) : print_errors(json);
  return 0;
}

}  // namespace

void register_session_odometry_command(Command& session, Program& program) {
  auto [command, arguments] = add_subcommand<OdometryArguments>(
      session, program, "odometry",
      "Compare dead reckoning with the truth, over all legs of one or more runs", run_odometry);
  command.add_option("RUN", arguments.runs, "Run folders or session files")->required();
  add_number(command, "--length", arguments.length_m, "Length of a leg along the true path [m]",
             {0.1, 1e6});
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
