// The comparison of image and host.
#include "host_sim/run/world/parity.h"

#include <array>

#include "firmware/robot/robot.h"
#include "host_sim/core/record.h"

namespace screed {

ParityResult run_parity(CoSimulation& image, const BoardConstants& board,
                        const Parameters& parameters, const Credentials& credentials,
                        double seconds, const std::function<bool(const ParityResult&)>& go_on) {
  ParityResult result;
  Robot robot(board, parameters, credentials);
  RobotOutput expected_output{};  // one for all ticks, as in the main loop
  std::array<std::uint8_t, kOutputBytes> expected{};
  std::array<std::uint8_t, kOutputBytes> got{};
  for (;; ++result.ticks) {
    const SensorSample& sample = image.run_to_sample();
    result.simulated_s = image.plant().time_s();
    if (result.simulated_s > seconds || !go_on(result)) return result;
    robot.tick(sample, expected_output);
    const RobotOutput& output = image.run_to_output();
    pack(expected_output, expected);
    pack(output, got);
    if (output.duty_left != 0 || output.duty_right != 0) ++result.driving_ticks;
    // Bytes of the radio behind the valid ones are no output.
    result.compared_bytes += kOutputBytes - kRadioOutCapacity + output.radio_out_count;
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (got.at(i) != expected.at(i)) ++result.differing_bytes;
    }
    if (result.first_difference_tick.has_value()) continue;
    if (const auto difference = first_difference(kOutputColumns, expected, got)) {
      result.first_difference_tick = result.ticks;
      result.first_difference = *difference;
    }
  }
}

}  // namespace screed
