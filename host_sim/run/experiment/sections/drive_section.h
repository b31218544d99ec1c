// [drive] of an experiment file: what the ground station commands.
#pragma once

namespace screed {

struct DriveSection {
  double speed_m_per_s = 0.1;
  double yaw_rate_deg_per_s = 0.0;

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("speed", "m/s", -0.5, 0.5, "algorithm drive: commanded speed",
              &DriveSection::speed_m_per_s);
    keys.real("yaw_rate", "deg/s", -179, 179, "algorithm drive: commanded turn rate",
              &DriveSection::yaw_rate_deg_per_s);
  }
};

}  // namespace screed
