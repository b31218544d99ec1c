#include "nn/surrogate/default_model.h"

#include "paths.h"

namespace screed::nn {

std::filesystem::path default_model_file() {
  return std::filesystem::path(kModelsFolder) / "v3.json";
}

}  // namespace screed::nn
