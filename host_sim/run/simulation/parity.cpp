// The comparison of image and host.
#include "host_sim/run/simulation/parity.h"

#include "host_sim/core/record.h"
#include "host_sim/run/simulation/further_robots.h"
#include "host_sim/run/simulation/parity_checker.h"

namespace screed {

ParityResult run_parity(CoSimulation& image, std::span<const RobotSettings> robots, double seconds,
                        const std::function<bool(const ParityResult&)>& go_on) {
  ParityResult result;
  const RobotSettings& first = robots.front();
  ParityChecker host(first.board, first.parameters, first.credentials);
  FurtherRobots further(image.world(), robots);
  image.on_native_tick([&further] { further.answer(); });
  for (;; ++result.ticks) {
    const SensorSample& sample = image.run_to_sample();
    result.simulated_s = image.world().plant().time_s();
    if (result.simulated_s > seconds || !go_on(result)) return result;
    host.tick(sample);
    const RobotOutput& output = image.run_to_output();
    if (output.duty_left != 0 || output.duty_right != 0) ++result.driving_ticks;
    // Bytes of the radio behind the valid ones are no output.
    result.compared_bytes += kOutputBytes - kRadioOutCapacity + output.radio_out_count;
    const ParityChecker::Difference difference = host.compare(output);
    result.differing_bytes += difference.bytes;
    if (difference.bytes != 0 && !result.first_difference_tick.has_value()) {
      result.first_difference_tick = result.ticks;
      result.first_difference = difference.first;
    }
  }
}

}  // namespace screed
