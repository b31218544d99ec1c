// The surrogate models used when no others are named.
#pragma once

#include <filesystem>

namespace screed::nn {

std::filesystem::path default_model_file();
/// The bearing-capacity network (nn/terrain) that belongs to it.
std::filesystem::path default_bearing_capacity_file();

}  // namespace screed::nn
