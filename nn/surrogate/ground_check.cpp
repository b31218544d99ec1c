#include "nn/surrogate/ground_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hal/sample.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "host_sim/standin/coarse_ground.h"
#include "host_sim/standin/standin_plant.h"
#include "nn/surrogate/recorded_drive.h"

namespace screed::nn {
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

}  // namespace

GroundCheck check_ground(const std::filesystem::path& session_folder, double seconds,
                         const TaskProgress& progress) {
  const RecordedDrive recording(session_folder);
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

}  // namespace screed::nn
