// A bed of particles as part of a POV-Ray scene: round stones of several tones.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/render/scene/terrain_scene.h"

namespace screed {

/// The numbers of the particles that can be seen from above or from the side: not those that lie
/// deeper than some layers below their surroundings.
std::vector<std::size_t> visible_spheres(const SphereSet& particles);

/// The visible particles as spheres, and the floor of the bed below them.
std::string spheres_text(const SphereSet& particles, const SoilAppearance& look,
                         const std::optional<HeightTint>& tint);

}  // namespace screed
