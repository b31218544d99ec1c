// The model that stands in for the physics when nobody names another one.
#pragma once

#include <filesystem>

namespace screed::nn {

std::filesystem::path default_model_file();

}  // namespace screed::nn
