// The tracked robot in a world of physics, for tests of what stands round it.
#pragma once

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

inline const Assembly& rover5() {
  static const Assembly model = import_urdf(find_model_file(Experiment{}));
  return model;
}

/// Half a metre above the ground at (x, y): where it is does not depend on how it comes to rest.
inline PlantOptions held_at(double x_m, double y_m) {
  PlantOptions options;
  options.starts[0].x_m = x_m;
  options.starts[0].y_m = y_m;
  options.starts[0].z_m = 0.5;
  return options;
}

inline PlantOptions on_soil(PlantOptions options) {
  options.soil = soil_preset("viper");
  return options;
}

}  // namespace screed
