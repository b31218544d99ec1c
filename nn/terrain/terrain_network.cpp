#include "nn/terrain/terrain_network.h"

#include <memory>
#include <vector>

#include "host_sim/core/errors.h"
#include "nn/terrain/flux_network.h"
#include "nn/terrain/window_network.h"

namespace screed::nn {
namespace {

template <typename Network>
std::shared_ptr<const Network> read_as(const std::filesystem::path& file) {
  try {
    return std::make_shared<const Network>(Network::read(file));
  } catch (const InputError&) {  // then it may be the other kind
    return nullptr;
  }
}

}  // namespace

TerrainNetwork read_terrain_network(const std::filesystem::path& file) {
  if (const auto fluxes = read_as<FluxNetwork>(file)) {
    return {"fluxes", [fluxes](const Assembly& robot) -> GroundChange {
              return [fluxes, wheels = wheel_positions(robot)](HeightField& ground,
                                                               const Stride& stride) {
                fluxes->apply(ground, wheels, stride);
              };
            }};
  }
  if (const auto window = read_as<WindowNetwork>(file)) {
    return {"window", [window](const Assembly& /*robot*/) -> GroundChange {
              return [window, last = std::vector<float>(WindowNetwork::kCells)](
                         HeightField& ground, const Stride& stride) mutable {
                window->apply(ground, stride, last);
              };
            }};
  }
  throw InputError(file.string() + ": is no network of screed terrain-net train");
}

}  // namespace screed::nn
