// The models that stand in for the physics when nobody names others.
#pragma once

#include <filesystem>

namespace screed::nn {

std::filesystem::path default_model_file();
/// The network of what bears tracks (nn/terrain) that goes with it.
std::filesystem::path default_bearing_file();

}  // namespace screed::nn
