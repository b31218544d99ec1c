// Heights as colour in a POV-Ray scene: what the terrain is made of takes the tint of its height,
// and a colour bar in the corner of the picture says which height has which.
#pragma once

#include <optional>
#include <string>

#include "host_sim/render/scene/scene_camera.h"

namespace screed {

/// Colours by height (height_color()) that are mixed into what the terrain is made of.
struct HeightTint {
  double low_m = 0.0;   ///< dark slate at and below
  double high_m = 1.0;  ///< pale at and above; more than low_m
  double share = 0.5;   ///< of the tint in the colour, 0..1
};

/// From the round number of millimetres below `low_m` to the one above `high_m`.
HeightTint height_tint(double low_m, double high_m);

/// `#declare HeightColors`, before everything that is tinted.
std::string tint_text(const HeightTint& tint);

/// `pattern`, what stands between the braces of a POV-Ray pigment, with the tint mixed in; as it is
/// without a tint.
std::string tinted(const std::string& pattern, const std::optional<HeightTint>& tint);

/// The colour bar with its heights in mm, in the lower left corner of what the camera sees.
std::string tint_legend_text(const HeightTint& tint, const SceneCamera& camera,
                             const PictureFormat& format);

}  // namespace screed
