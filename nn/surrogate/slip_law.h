// Track kinematics fitted to recorded drives: the baselines of rollouts.
#pragma once

#include <cstdint>
#include <span>

#include "nn/surrogate/motion_series.h"
#include "nn/surrogate/track_kinematics.h"

namespace screed::nn {

enum class SlipLaw : std::uint8_t {
  kConstant,  ///< a share of the speed, and of the turn
  kBySlope,   ///< both, and what the slope adds; slides down sideways
  /// Instantaneous centres of rotation (J. Pentzer, S. Brennan, K. Reichard, Journal of Field
  /// Robotics 31(3), 2014): forward, sideways and turn each linear in both tracks' speeds.
  kRotationCentres,
  kRotationCentresAndSlope,
};
const char* name_of(SlipLaw law);

/// By least squares over frames. Fitted to the very drive on which it is judged, no other constants
/// of the law have less error in a frame.
TrackKinematics fitted_kinematics(SlipLaw law, std::span<const MotionSeries> series);

}  // namespace screed::nn
