#include "nn/surrogate/default_model.h"

#include "host_sim/core/data_folders.h"

namespace screed::nn {

std::filesystem::path default_model_file() {
  return data_folders().models / "v3.json";
}

std::filesystem::path default_bearing_capacity_file() {
  return data_folders().models / "terrain_tracks.json";
}

}  // namespace screed::nn
