// Made-up relief for leveling: a power-law spectrum, mounds as of a loose deposit, a trench with
// its spoil.
#pragma once

#include <cstdint>

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Ranges are checked by the one who reads them from a file.
struct ReliefOptions {
  uint64_t seed = 1;

  /// RMS of the heights of the spectrum about their mean over all nodes, metres; 0: none.
  double rms_m = 0.0;
  /// w of the power spectral density of a profile, which falls with wave number to the power of -w
  /// (ISO 8608: 2); the surface's own falls with -(w + 1).
  double exponent = 2.0;
  /// The band, wave lengths in metres. Waves longer than the bed's shorter side there are none.
  double longest_wave_m = 1.5;
  double shortest_wave_m = 0.15;

  /// Cones at random places, at most as high as given, at least half as high; flanks of this
  /// slope, degrees. They lie on each other where they meet.
  uint32_t mounds = 0;
  double mound_height_m = 0.05;
  double mound_slope_deg = 25.0;

  /// A straight trench near the centre of the bed in a random direction, from edge to edge: depth
  /// below the ground, width of its floor, flanks of this slope; on both sides a bank, so that the
  /// whole has no volume. 0: none.
  double trench_depth_m = 0.0;
  double trench_width_m = 0.1;
  double trench_slope_deg = 25.0;
};

/// Adds the relief to the field. The spectrum repeats after the bed's sides; mounds and trench of a
/// field with wrap go on at the other side. Throws InputError where heights pass +-127 m.
void add_relief(const ReliefOptions& options, HeightField& field);

}  // namespace screed
