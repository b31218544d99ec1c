// [battery] of an experiment file: what the robot drives on.
#pragma once

#include <optional>

namespace screed {

struct BatterySection {
  double charge = 1.0;
  std::optional<double> capacity_ah;
  int spares = 0;

  template <class Keys>
  static void list(Keys& keys) {
    using T = BatterySection;
    keys.real("charge", "", 0, 1, "share of its charge that the battery begins with", &T::charge);
    keys.real("capacity", "Ah", 0.01, 1000,
              "what it holds when full; left out: as battery.ini of the board says",
              &T::capacity_ah);
    keys.integer("spares", "", 0, 1000,
                 "full batteries to come: one is put in, and nothing waits for it, when a tenth of "
                 "the charge is left",
                 &T::spares);
  }
};

}  // namespace screed
