// [sensors] of an experiment file: how true they are.
#pragma once

namespace screed {

struct SensorsSection {
  bool noise = true;
  bool calibrated = true;
  bool calibration_motion = false;

  template <class Keys>
  static void list(Keys& keys) {
    using S = SensorsSection;
    keys.flag("noise",
              "noise, bias and scale errors as in the data sheets; false: quantisation alone",
              &S::noise);
    keys.flag(
        "calibrated",
        "what a calibration leaves of the chips' biases; false: as the chips come, unless noise is "
        "false",
        &S::calibrated);
    keys.flag("handled",
              "the IMU feels a person turning the robot over, as screed calibrate asks; the robot "
              "stands",
              &S::calibration_motion);
  }
};

}  // namespace screed
