// `screed soil repose`: a tower collapses to its angle of repose.
#include <memory>

#include "host_sim/soil_validation/repose_pile.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/soil/soil_common.h"

namespace screed {
namespace {

struct ReposeArguments {
  SoilArguments common;
  ReposeTest test;
};

int run_repose(ReposeArguments a) {
  a.test.soil = a.common.soil();
  a.test.cell_m = a.common.cell_m;
  const ReposeResult result = collapse(a.test);
  const double repose = a.test.soil.repose_deg;
  return finish(a.common, "repose",
                a.test.soil.name + text(", a tower of %g mm", a.test.height_m * kMilli) +
                    text(", grid %g mm", a.common.cell_m * kMilli),
                "must be",
                {{"along the axes", "slope_deg", result.slope_axis_deg, "%.2f", repose,
                  SoilLine::Error::kRelative},
                 {"along diagonals", "slope_deg", result.slope_diagonal_deg, "%.2f", repose,
                  SoilLine::Error::kRelative},
                 {"steepest pair", "excess_units", result.excess_units, "%.3f", 1.0},
                 {"", "volume_error", static_cast<double>(result.volume_error), "%.0f", 0.0},
                 {"", "moves", static_cast<double>(result.moves), "%.0f"}});
}

}  // namespace

void register_soil_repose_command(Command& soil, Program& program) {
  const auto a = std::make_shared<ReposeArguments>();
  Command* command =
      soil.add_subcommand("repose", "Let a column of soil collapse to its angle of repose");
  add_soil_options(*command, a->common);
  add_number(*command, "--size", a->test.size_m, "Side length of the bed [m]", {0.1, 10.0});
  add_number(*command, "--radius", a->test.radius_m, "Radius of the column [m]", {0.0005, 10.0});
  add_number(*command, "--height", a->test.height_m, "Height of the column [m]", {1e-4, 10.0});
  add_number(*command, "--tap", a->test.tap_m,
             "Depth by which a plate first taps the column [m]; 0: untouched", {0.0, 1.0});
  add_number(*command, "--x", a->test.centre_x_m, "Centre position in x [m]", {-10.0, 10.0});
  add_number(*command, "--y", a->test.centre_y_m, "Centre position in y [m]", {-10.0, 10.0});
  command->add_flag("--wrap", a->test.wrap, "Wrap the bed around at its edges");
  command->callback([a, &program] { program.action = [a] { return run_repose(*a); }; });
}

}  // namespace screed
