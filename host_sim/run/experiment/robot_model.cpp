// [vehicle] as options of the URDF importer.
#include "host_sim/run/experiment/robot_model.h"

#include <algorithm>
#include <numbers>
#include <vector>

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

}  // namespace screed
