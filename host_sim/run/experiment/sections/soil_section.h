// [soil] of an experiment file: the soil of the model scm, a named one and what differs from it.
#pragma once

#include <optional>
#include <string>

#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

struct SoilSection {
  std::string preset = "viper";
  double cell_m = 0.005;
  bool bulldozing = true;
  bool avalanches = true;
  bool follow_slopes = true;
  SoilOverrides overrides;

  template <class Keys>
  static void list(Keys& keys) {
    using S = SoilSection;
    keys.choice("preset", soil_preset_names(), "model scm: a named soil", &S::preset);
    keys.real("cell", "m", 0.001, 0.05, "model scm: side of a grid cell", &S::cell_m);
    keys.flag("bulldozing", "sunk material is pushed aside; false: compacted", &S::bulldozing);
    keys.flag("avalanches", "slopes above the angle of repose slide", &S::avalanches);
    keys.flag("follow_slopes",
              "ruts uphill and downhill are as deep as on the level; false: too deep "
              "below belts going downhill",
              &S::follow_slopes);
    for (const SoilParameterInfo& row : kSoilParameters) {
      keys.real(row.key, row.unit, row.min, row.max, row.meaning,
                [&row](S& soil) -> std::optional<double>& {
                  return soil.overrides.*row.override_member;
                });
    }
  }
};

}  // namespace screed
