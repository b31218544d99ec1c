// [vehicle] as options of the URDF importer; [battery].
#include "host_sim/run/experiment/robot_model.h"

#include <algorithm>
#include <numbers>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"

namespace screed {

Assembly make_robot_model(const Experiment& experiment, const std::string& board,
                          const std::optional<std::filesystem::path>& file) {
  constexpr double kRadPerDeg = std::numbers::pi / 180.0;
  const VehicleSection& vehicle = experiment.vehicle;
  UrdfOptions urdf;
  if (vehicle.leg_angle_deg) urdf.leg_angle_rad = *vehicle.leg_angle_deg * kRadPerDeg;
  urdf.chassis_link = vehicle.chassis_link;
  urdf.imu_link = vehicle.imu_link;
  const std::vector<std::string> wheels = names_in(vehicle.wheel_links);
  std::copy_n(wheels.begin(), std::min(wheels.size(), urdf.wheel_links.size()),
              urdf.wheel_links.begin());
  return import_urdf(file ? *file : find_model_file(experiment, board), urdf);
}

Battery make_battery(const Experiment& experiment, const std::string& board) {
  Battery battery = board_battery(board).value_or(Battery());
  if (experiment.battery.capacity_ah.has_value())
    battery.capacity_c = *experiment.battery.capacity_ah * kSecondsPerHour;
  battery.spares = experiment.battery.spares;
  battery.begin_with(experiment.battery.charge);
  return battery;
}

}  // namespace screed
