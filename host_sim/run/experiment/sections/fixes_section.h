// [fixes] of an experiment file: position fixes that the ground station sends, as from an overhead
// camera.
#pragma once

namespace screed {

struct FixesSection {
  double period_s = 0.0;
  double sigma_m = 0.02;
  double outage_every_s = 0.0;
  double outage_s = 10.0;

  template <class Keys>
  static void list(Keys& keys) {
    using T = FixesSection;
    keys.real("period", "s", 0, 60,
              "time between two position fixes, rounded to 0.25 s; 0: none. They are in the map's "
              "axes",
              &T::period_s);
    keys.real("sigma", "m", 0, 1, "standard deviation of a fix along each axis", &T::sigma_m);
    keys.real("outage_every", "s", 0, 36000,
              "mean time from the end of an outage to the next one (exponential); 0: no outages",
              &T::outage_every_s);
    keys.real("outage", "s", 0, 36000, "how long an outage lasts", &T::outage_s);
  }
};

}  // namespace screed
