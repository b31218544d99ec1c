// Two answers as packed rows.
#include "host_sim/run/simulation/parity_checker.h"

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

}  // namespace screed
