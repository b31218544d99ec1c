// The comparison of image and host.
#include "host_sim/run/simulation/parity.h"

#include "host_sim/core/record.h"
#include "host_sim/run/simulation/parity_checker.h"

namespace screed {

namespace {

class Comparison : public RobotWatch {
 public:
  Comparison(const World& world, const RobotSettings& host, double seconds,
             const std::function<bool(const ParityResult&)>& go_on)
      : world_(world), seconds_(seconds), go_on_(go_on), host_(host) {}

  bool on_sample(size_t robot, SensorSample& sample) override {
    if (robot != 0) return true;
    result_.simulated_s = world_.plant().time_s();
    if (result_.simulated_s > seconds_ || !go_on_(result_)) return false;
    host_.tick(sample);
    return true;
  }

  void on_output(size_t robot, RobotOutput& output) override {
    if (robot != 0) return;
    if (output.duty_left != 0 || output.duty_right != 0) ++result_.driving_ticks;
    // Bytes of the radio behind the valid ones are no output.
    result_.compared_bytes += kOutputBytes - kRadioOutCapacity + output.radio_out_count;
    const ParityChecker::Difference difference = host_.compare(output);
    result_.differing_bytes += difference.bytes;
    if (difference.bytes != 0 && !result_.first_difference_tick.has_value()) {
      result_.first_difference_tick = result_.ticks;
      result_.first_difference = difference.first;
    }
    ++result_.ticks;
  }

  const ParityResult& result() const { return result_; }

 private:
  const World& world_;
  double seconds_;
  const std::function<bool(const ParityResult&)>& go_on_;
  ParityChecker host_;
  ParityResult result_;
};

}  // namespace

ParityResult run_parity(World& world, const RobotSettings& host, double seconds,
                        const std::function<bool(const ParityResult&)>& go_on) {
  Comparison comparison(world, host, seconds, go_on);
  while (world.advance(&comparison)) {
  }
  return comparison.result();
}

}  // namespace screed
