#include "nn/surrogate/default_model.h"

#include "paths.h"

namespace screed::nn {

std::filesystem::path default_model_file() {
  return std::filesystem::path(kModelsFolder) / "v3.json";
}

std::filesystem::path default_bearing_capacity_file() {
  return std::filesystem::path(kModelsFolder) / "terrain_tracks.json";
}

}  // namespace screed::nn
