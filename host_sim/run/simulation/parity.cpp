// Two answers as packed rows.
#include "host_sim/run/simulation/parity.h"

#include <array>

#include "host_sim/core/errors.h"
#include "host_sim/core/record.h"

namespace screed {

void ParityChecker::tick(const SensorSample& sample) {
  shadow_.tick(sample, expected_);
  ++ticks_;
}

ParityChecker::Difference ParityChecker::compare(const RobotOutput& answer) const {
  std::array<uint8_t, kOutputBytes> expected{};
  std::array<uint8_t, kOutputBytes> got{};
  pack(expected_, expected);
  pack(answer, got);
  Difference difference;
  for (size_t i = 0; i < got.size(); ++i) {
    if (got.at(i) != expected.at(i)) ++difference.bytes;
  }
  if (difference.bytes != 0) {
    difference.first = first_difference(kOutputColumns, expected, got).value_or("");
  }
  return difference;
}

void ParityChecker::require_equal(const RobotOutput& answer) const {
  const Difference difference = compare(answer);
  if (difference.bytes == 0) return;
  throw RunError("two robots answered the same samples differently in tick " +
                 std::to_string(ticks_) + ": " + difference.first);
}

// The comparison of image and host.

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
