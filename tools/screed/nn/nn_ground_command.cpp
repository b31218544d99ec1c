// `screed nn ground`: the stand-in's ground below recorded drives, beside the recorded one.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/statistics.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "host_sim/standin/coarse_ground.h"
#include "host_sim/standin/standin_plant.h"
#include "nn/surrogate/rollout.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kCubicCentimetres = 1e6;

/// Of every node.
HeightField change_of(const HeightField& before, const HeightField& after) {
  HeightField change = before;
  for (int iy = 0; iy < before.ny(); ++iy) {
    for (int ix = 0; ix < before.nx(); ++ix) {
      change.set_node(ix, iy, after.node(ix, iy) - before.node(ix, iy));
    }
  }
  return change;
}

double robot_scale_rms_mm(const HeightField& field) {
  const HeightField low = low_passed(field, kRobotScale_m);
  double squares = 0.0;
  for (int iy = 0; iy < low.ny(); ++iy) {
    for (int ix = 0; ix < low.nx(); ++ix) {
      const double height = low.node(ix, iy) * kHeightUnit_m;
      squares += height * height;
    }
  }
  return kMillimetres * std::sqrt(squares / (static_cast<double>(low.nx()) * low.ny()));
}

/// What the stand-in's ground becomes below a robot that moves as it was recorded, beside what it
/// became in the physics.
struct GroundCheck {
  std::string source;
  double driven_s = 0.0;
  double change_mm = 0.0;  ///< RMS over the bed of the recorded change, at robot scale
  double error_mm = 0.0;   ///< RMS of the stand-in's change less the recorded one, at robot scale
  double moved_cm3 = 0.0;  ///< volume that was lowered in the recording, on the stand-in's cells
  double standin_moved_cm3 = 0.0;  ///< and in the stand-in
  std::int64_t volume_error = 0;   ///< units that the stand-in lost or made
};

/// Poses and track speeds are the recording's, from Algorithm 5's first frame on, for `seconds` or
/// to its end. Throws InputError for a session that cannot be followed (RecordedDrive).
GroundCheck check_ground(const std::filesystem::path& session_folder, double seconds,
                         const TaskProgress& progress) {
  const nn::RecordedDrive recording(session_folder);
  const SessionInfo& info = recording.session.info();
  const std::uint64_t begin = recording.first;
  const auto frames = static_cast<std::uint64_t>(std::lround(seconds * kTickRate_hz));
  const std::uint64_t end = std::min<std::uint64_t>(recording.frames.size(), begin + 1 + frames);

  PlantOptions options;
  options.soil = recording.soil;
  options.vehicle.motor = board_motor(info.board_name).motor;
  options.starts[0].x_m = recording.poses[begin].x_m;
  options.starts[0].y_m = recording.poses[begin].y_m;
  options.starts[0].attitude.heading = recording.poses[begin].heading_rad;
  const HeightField before =
      coarse_ground(field_of(recording.session.heights_after(begin + 1)), kStandInCell_m);
  StandInPlant plant(before, make_robot_model(recording.experiment, info.board_name), options);
  const std::int64_t volume_before = plant.volume_balance().error();
  for (std::uint64_t row = begin + 1; row < end; ++row) {
    const SimFrame& frame = recording.frames[row];
    plant.follow_frame({frame.track_left, frame.track_right}, recording.poses[row],
                       recording.motions[row]);
    report_progress(progress, "following", row - begin, end - begin);
  }
  const HeightField after =
      coarse_ground(field_of(recording.session.heights_after(end)), kStandInCell_m);

  const HeightField real = change_of(before, after);
  const HeightField standin = change_of(before, plant.terrain());
  GroundCheck check;
  check.source = info.experiment_name;
  check.driven_s = static_cast<double>(end - begin - 1) / kTickRate_hz;
  check.change_mm = robot_scale_rms_mm(real);
  check.error_mm = robot_scale_rms_mm(change_of(real, standin));
  check.moved_cm3 = kCubicCentimetres * terrain_change(before, after).cut_m3;
  check.standin_moved_cm3 = kCubicCentimetres * terrain_change(before, plant.terrain()).cut_m3;
  check.volume_error = plant.volume_balance().error() - volume_before;
  return check;
}

struct GroundArguments {
  std::vector<std::string> sessions;
  double seconds = 600.0;
};

int run_ground(const GroundArguments& arguments) {
  constexpr double kPercent = 100.0;
  std::printf("  %-24s %8s %12s %12s %8s %12s %12s %8s %8s\n", "session", "s", "change, mm",
              "error, mm", "share", "moved, cm3", "stand-in", "share", "lost");
  std::vector<double> errors;
  std::vector<double> moved;
  for (const std::string& folder : arguments.sessions) {
    ProgressBar bar(std::cerr);
    const GroundCheck check = check_ground(
        folder, arguments.seconds,
        [&](std::string_view task, double share) { bar.show_share(share, std::string(task)); });
    bar.clear();
    errors.push_back(kPercent * check.error_mm / check.change_mm);
    moved.push_back(kPercent * check.standin_moved_cm3 / check.moved_cm3);
    std::printf("  %-24s %8.1f %12.3f %12.3f %7.1f%% %12.1f %12.1f %7.1f%% %8lld\n",
                check.source.c_str(), check.driven_s, check.change_mm, check.error_mm,
                errors.back(), check.moved_cm3, check.standin_moved_cm3, moved.back(),
                static_cast<long long>(check.volume_error));
    std::fflush(stdout);
  }
  std::printf(
      "\n  of %zu sessions: error %.1f%% of the change in the median, %.1f%% at worst; "
      "moved %.1f%% in the median, %.1f%% to %.1f%%\n",
      errors.size(), quantile(errors, 0.5), quantile(errors, 1.0), quantile(moved, 0.5),
      quantile(moved, 0.0), quantile(moved, 1.0));
  return 0;
}

}  // namespace

void register_nn_ground_command(Command& nn, Program& program) {
  auto ground = std::make_shared<GroundArguments>();
  Command* command = nn.add_subcommand(
      "ground", "Compare the ground that the stand-in leaves below recorded drives");
  command->add_option("SESSION", ground->sessions, "Run folders of screed record")->required();
  add_number(*command, "--seconds", ground->seconds, "How long to follow each drive [s]",
             {1.0, 1e5});
  command->callback(
      [ground, &program] { program.action = [ground] { return run_ground(*ground); }; });
}

}  // namespace screed
