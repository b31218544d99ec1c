// What a world is given beside its ground and the robots' model. Apart from plant.h, which brings
// ODE: the stand-in and the networks' world take these options too.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/vehicle_options.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/world/terrain_factory.h"

namespace screed {

struct StartPose {
  double x_m = 0.0;
  double y_m = 0.0;
  /// Of the chassis' origin; without it the robot is placed on the terrain and settles.
  std::optional<double> z_m;
  Attitude attitude = {0.0, 0.0, 0.0};
};

struct PlantOptions : TerrainOptions {
  double physics_step_s = 0.001;  ///< divides the control tick of 10 ms
  /// Of each robot; all of one kind, and z_m given for all or for none.
  std::vector<StartPose> starts = {StartPose{}};
  double robot_friction = 0.5;  ///< Coulomb coefficient between robots
  VehicleOptions vehicle;
  Battery battery;
};

}  // namespace screed
