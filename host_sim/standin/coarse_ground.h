// A recorded ground with cells as coarse as the stand-in's.
#pragma once

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// The same bed with cells of about `spacing_m`, each as high as the ground in it is in the mean;
/// the field itself where its own are as coarse.
HeightField coarse_ground(const HeightField& ground, double spacing_m);

}  // namespace screed
