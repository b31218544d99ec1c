// `screed`, the one host program: its subcommands.
#include <CLI/CLI.hpp>
#include <functional>

#include "tools/screed/cli/program.h"
#include "tools/screed/link/attitude_command.h"
#include "tools/screed/link/calibrate_command.h"
#include "tools/screed/link/decode_command.h"
#include "tools/screed/link/key_command.h"
#include "tools/screed/link/monitor_command.h"
#include "tools/screed/link/plot_command.h"
#include "tools/screed/link/send_command.h"
#include "tools/screed/nn/nn_command.h"
#include "tools/screed/nn/nn_motion_command.h"
#include "tools/screed/nn/nn_stuck_command.h"
#include "tools/screed/nn/terrain_net_command.h"
#include "tools/screed/sim/parity_command.h"
#include "tools/screed/sim/record_command.h"
#include "tools/screed/sim/render_command.h"
#include "tools/screed/sim/replay_command.h"
#include "tools/screed/sim/session_command.h"
#include "tools/screed/sim/sim_command.h"
#include "tools/screed/soil/soil_command.h"
#include "tools/screed/terrain/grid_command.h"
#include "tools/screed/terrain/terrain_command.h"
#include "tools/screed/viewer/view_command.h"
#include "version.h"

int main(int argc, char** argv) {
  CLI::App app("Screed: firmware for a terrain-leveling robot, and its simulation twin", "screed");
  app.set_version_flag("--version", SCREED_VERSION);
  app.require_subcommand(1);
  std::function<int()> action;
  screed::register_sim_command(app, SCREED_VERSION, action);
  screed::register_replay_command(app, action);
  screed::register_render_command(app, action);
  screed::register_key_command(app, action);
  screed::register_parity_command(app, action);
  screed::register_attitude_command(app, action);
  screed::register_decode_command(app, action);
  screed::register_plot_command(app, action);
  screed::register_grid_command(app, SCREED_VERSION, action);
  screed::register_monitor_command(app, action);
  screed::register_send_command(app, action);
  screed::register_calibrate_command(app, action);
  screed::register_soil_command(app, action);
  screed::register_record_command(app, SCREED_VERSION, action);
  screed::register_session_command(app, action);
  screed::register_terrain_command(app, action);
  screed::register_terrain_net_command(app, action);
  screed::register_view_command(app, action);
  screed::register_nn_command(app, action);
  screed::register_nn_motion_command(app, action);
  screed::register_nn_stuck_command(app, action);
  return screed::run_program(app, argc, argv, [&] { return action(); });
}
