// Patches, fluxes, and what they do to the ground.
#include "nn/terrain/flux_network.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

constexpr double kHeightScale_m = 0.0015;
constexpr double kSlopeScale = 0.2;
constexpr double kWayScale_m = 0.006;  // of a stride
constexpr double kTurnScale_rad = 0.05;
constexpr float kMostInput = 4.0F;

std::size_t seen(int ix, int iy) {
  return static_cast<std::size_t>(iy) * FluxNetwork::kSeenX + static_cast<std::size_t>(ix);
}

/// Adds units round a place, by bilinear weights; the last node takes what rounding leaves.
void spread(HeightField& ground, const std::array<double, 2>& at, Height units) {
  const double u = (at[0] - ground.x_min()) / ground.spacing_m();
  const double v = (at[1] - ground.y_min()) / ground.spacing_m();
  const double low_u = std::floor(u);
  const double low_v = std::floor(v);
  const double part_u = u - low_u;
  const double part_v = v - low_v;
  const auto place = [&](double node, int nodes) {
    const int whole = static_cast<int>(node);
    if (!ground.wrap()) return std::clamp(whole, 0, nodes - 1);
    const int within = whole % nodes;
    return within < 0 ? within + nodes : within;
  };
  const int west = place(low_u, ground.nx());
  const int east = place(low_u + 1.0, ground.nx());
  const int south = place(low_v, ground.ny());
  const int north = place(low_v + 1.0, ground.ny());
  Height left = units;
  const auto give = [&](int ix, int iy, double weight) {
    const auto share = static_cast<Height>(units * weight);
    left -= share;
    ground.set_node(ix, iy, ground.node(ix, iy) + share);
  };
  give(west, south, (1.0 - part_u) * (1.0 - part_v));
  give(east, south, part_u * (1.0 - part_v));
  give(west, north, (1.0 - part_u) * part_v);
  ground.set_node(east, north, ground.node(east, north) + left);
}

}  // namespace

void move_soil(HeightField& ground, const std::array<double, 2>& from,
               const std::array<double, 2>& to, Height units) {
  spread(ground, from, -units);
  spread(ground, to, units);
}

FluxSides sides_of(std::size_t flux) {
  constexpr std::size_t kX = FluxNetwork::kCellsX;
  if (flux < FluxNetwork::kFluxesX) {
    const std::size_t from = flux / (kX - 1) * kX + flux % (kX - 1);
    return {from, from + 1, 0};
  }
  const std::size_t from = flux - FluxNetwork::kFluxesX;
  return {from, from + kX, 1};
}

FluxNetwork::FluxNetwork(std::size_t hidden, std::uint64_t seed)
    : hidden_(hidden), first_(hidden * (kInputs + 1)), second_(2 * (hidden + 1)) {
  WorldRandom random(seed, "flux network");
  const double first = std::sqrt(6.0 / static_cast<double>(kInputs + hidden));
  for (float& weight : first_) weight = static_cast<float>(random.uniform(-first, first));
  const double second = 0.02 * std::sqrt(6.0 / static_cast<double>(2 + hidden));
  for (float& weight : second_) weight = static_cast<float>(random.uniform(-second, second));
}

std::array<double, 2> FluxNetwork::Patch::cell(int ix, int iy) const {
  const double x = (ix - 0.5 * (kCellsX - 1)) * kCell_m;
  const double y = (iy - 0.5 * (kCellsY - 1)) * kCell_m * (mirrored ? -1.0 : 1.0);
  return {x_m + cos_yaw * x - sin_yaw * y, y_m + sin_yaw * x + cos_yaw * y};
}

FluxNetwork::Patch FluxNetwork::patch_under(const WheelPlace& wheel, const Stride& stride) {
  Patch patch{};
  patch.cos_yaw = std::cos(stride.yaw_rad);
  patch.sin_yaw = std::sin(stride.yaw_rad);
  patch.x_m = stride.x_m + patch.cos_yaw * wheel.x - patch.sin_yaw * wheel.y;
  patch.y_m = stride.y_m + patch.sin_yaw * wheel.x + patch.cos_yaw * wheel.y;
  patch.mirrored = wheel.y < 0.0;
  return patch;
}

FluxNetwork::Footing FluxNetwork::footing(const HeightField& ground,
                                          const std::array<WheelPlace, 4>& wheels,
                                          const Stride& stride) {
  constexpr double kAlong_m = 0.010;
  constexpr double kAcross_m = 0.010;
  Footing footing{};
  std::array<double, 4> over{};
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Patch patch = patch_under(wheels[i], stride);
    for (const double along : {-kAlong_m, 0.0, kAlong_m}) {
      for (const double across : {-kAcross_m, 0.0, kAcross_m}) {
        const double x = patch.x_m + patch.cos_yaw * along - patch.sin_yaw * across;
        const double y = patch.y_m + patch.sin_yaw * along + patch.cos_yaw * across;
        footing.height_m[i] += ground.at(x, y).height / 9.0;
      }
    }
    over[i] = footing.height_m[i] - wheels[i].x * std::tan(stride.pitch) -
              wheels[i].y * std::tan(stride.roll);
  }
  std::array<double, 4> sorted = over;
  std::sort(sorted.begin(), sorted.end());
  const double carried_at = 0.5 * (sorted[2] + sorted[3]);
  for (std::size_t i = 0; i < over.size(); ++i) footing.support_m[i] = over[i] - carried_at;
  return footing;
}

void FluxNetwork::look(const HeightField& ground, const Patch& patch, const WheelPlace& wheel,
                       double height_m, double support_m, const Stride& stride,
                       std::span<float> sight) {
  const double slope_x = std::tan(stride.pitch);
  const double slope_y = std::tan(stride.roll);
  const double side = patch.mirrored ? -1.0 : 1.0;
  const auto bounded = [](double value) {
    return std::clamp(static_cast<float>(value), -kMostInput, kMostInput);
  };
  // Heights over the wheel, were the robot to stand on its two highest places: less the robot's
  // plane and the wheel's curve.
  for (int iy = 0; iy < kSeenY; ++iy) {
    for (int ix = 0; ix < kSeenX; ++ix) {
      const auto at = patch.cell(ix - kReachX, iy - kReachY);
      const double x = (ix - kReachX - 0.5 * (kCellsX - 1)) * kCell_m;
      const double y = (iy - kReachY - 0.5 * (kCellsY - 1)) * kCell_m * side;
      const double rim = std::min(std::abs(x), 0.95 * wheel.radius_m);
      const double curve = wheel.radius_m - std::sqrt(wheel.radius_m * wheel.radius_m - rim * rim);
      const double over = ground.at(at[0], at[1]).height - height_m - slope_x * x - slope_y * y;
      sight[seen(ix, iy)] = bounded((over + support_m - curve) / kHeightScale_m);
    }
  }
  // At the wheel, not at the robot's middle.
  const double forward = stride.forward_m - stride.turn_rad * wheel.y;
  const double sideways = stride.sideways_m + stride.turn_rad * wheel.x;
  const double surface = stride.track_m[wheel.y < 0.0 ? 1 : 0];
  sight[kSeen] = bounded(forward / kWayScale_m);
  sight[kSeen + 1] = bounded(side * sideways / kWayScale_m);
  sight[kSeen + 2] = bounded((surface - forward) / kWayScale_m);
  sight[kSeen + 3] = bounded(side * stride.turn_rad / kTurnScale_rad);
  sight[kSeen + 4] = wheel.front ? 1.0F : -1.0F;
  sight[kSeen + 5] = bounded(slope_x / kSlopeScale);
  sight[kSeen + 6] = bounded(side * slope_y / kSlopeScale);
  sight[kSeen + 7] = bounded(support_m / kHeightScale_m);
}

void FluxNetwork::inputs_of(std::span<const float> sight, int ix, int iy, float* inputs) {
  for (int dy = 0; dy <= 2 * kReachY; ++dy) {
    for (int dx = 0; dx <= 2 * kReachX; ++dx) {
      *inputs++ = sight[seen(ix + dx, iy + dy)];
    }
  }
  constexpr float kHalfX = 0.5F * (kCellsX - 1);
  constexpr float kHalfY = 0.5F * (kCellsY - 1);
  *inputs++ = 2.0F * (static_cast<float>(ix) - kHalfX) / kHalfX;
  *inputs++ = 2.0F * (static_cast<float>(iy) - kHalfY) / kHalfY;
  std::copy(sight.begin() + kSeen, sight.end(), inputs);
}

void FluxNetwork::answer(std::span<const float> sight, std::span<float> fluxes) const {
  std::array<float, kInputs> inputs{};
  std::vector<float> out(2 * kCells);
  for (int iy = 0; iy < kCellsY; ++iy) {
    for (int ix = 0; ix < kCellsX; ++ix) {
      inputs_of(sight, ix, iy, inputs.data());
      const auto cell = static_cast<std::size_t>(iy) * kCellsX + static_cast<std::size_t>(ix);
      float forward = second_[hidden_];
      float left = second_[2 * hidden_ + 1];
      for (std::size_t node = 0; node < hidden_; ++node) {
        const float* row = &first_[node * (kInputs + 1)];
        float sum = row[kInputs];
        for (std::size_t i = 0; i < kInputs; ++i) sum += row[i] * inputs[i];
        const float active = std::tanh(sum);
        forward += second_[node] * active;
        left += second_[hidden_ + 1 + node] * active;
      }
      out[cell] = forward;
      out[kCells + cell] = left;
    }
  }
  for (std::size_t flux = 0; flux < kFluxes; ++flux) {
    const FluxSides sides = sides_of(flux);
    fluxes[flux] = out[sides.row * kCells + sides.from];
  }
}

void FluxNetwork::act(HeightField& ground, const std::array<WheelPlace, 4>& wheels,
                      const Stride& stride) const {
  std::vector<float> sight(kSight);
  std::vector<float> fluxes(kFluxes);
  const Footing feet = footing(ground, wheels, stride);
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Patch patch = patch_under(wheels[i], stride);
    look(ground, patch, wheels[i], feet.height_m[i], feet.support_m[i], stride, sight);
    answer(sight, fluxes);
    for (std::size_t flux = 0; flux < kFluxes; ++flux) {
      const auto units = static_cast<Height>(
          std::lround(static_cast<double>(fluxes[flux]) * kOutput_m / kHeightUnit_m));
      if (units == 0) continue;
      const FluxSides sides = sides_of(flux);
      const auto cell = [&](std::size_t index) {
        return patch.cell(static_cast<int>(index % kCellsX), static_cast<int>(index / kCellsX));
      };
      move_soil(ground, cell(sides.from), cell(sides.to), units);
    }
  }
}

FluxNetwork FluxNetwork::read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  const auto fail = [&] { return InputError(file.string() + ": is not a network of the terrain"); };
  if (json.is_discarded() || !json.is_object() || json.value("format", "") != "screed-flux-2") {
    throw fail();
  }
  try {
    FluxNetwork network(json.at("hidden").get<std::size_t>(), 0);
    const auto first = json.at("first").get<std::vector<float>>();
    const auto second = json.at("second").get<std::vector<float>>();
    if (first.size() != network.first_.size() || second.size() != network.second_.size()) {
      throw fail();
    }
    network.first_ = first;
    network.second_ = second;
    return network;
  } catch (const nlohmann::json::exception&) {
    throw fail();
  }
}

void FluxNetwork::write(const std::filesystem::path& file) const {
  const nlohmann::ordered_json json = {{"format", "screed-flux-2"},
                                       {"cells", {kCellsX, kCellsY}},
                                       {"reach", {kReachX, kReachY}},
                                       {"hidden", hidden_},
                                       {"first", first_},
                                       {"second", second_}};
  write_file(file, json.dump() + "\n");
}

}  // namespace screed::nn
