#include "nn/terrain/terrain_network.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

constexpr const char* kFluxFormat = "screed-flux-2";
constexpr const char* kWindowFormat = "screed-window-1";

/// What the file of a network holds; null when it is none of that format.
Json json_of(const std::filesystem::path& file, const char* format) {
  std::ifstream stream(file);
  Json json = Json::parse_or_null(stream);
  return json.is_object() && json.value("format", "") == format ? std::move(json) : Json();
}

// ---- fluxes: patches, and what they do to the ground

constexpr double kHeightScale_m = 0.0015;
constexpr double kSlopeScale = 0.2;
constexpr double kDisplacementScale_m = 0.006;  // of a stride
constexpr double kTurnScale_rad = 0.05;
constexpr float kMaxAbsInput = 4.0F;

std::size_t observed_index(int ix, int iy) {
  return static_cast<std::size_t>(iy) * FluxNetwork::kObservedX + static_cast<std::size_t>(ix);
}

/// Adds units round a place, by bilinear weights; the last node takes what rounding leaves.
void deposit_at(HeightField& ground, const std::array<double, 2>& at, Height units) {
  const double u = (at[0] - ground.x_min()) / ground.spacing_m();
  const double v = (at[1] - ground.y_min()) / ground.spacing_m();
  const double low_u = std::floor(u);
  const double low_v = std::floor(v);
  const double part_u = u - low_u;
  const double part_v = v - low_v;
  const auto wrapped_node = [&](double node, int nodes) {
    const int whole = static_cast<int>(node);
    if (!ground.wrap()) return std::clamp(whole, 0, nodes - 1);
    const int within = whole % nodes;
    return within < 0 ? within + nodes : within;
  };
  const int west = wrapped_node(low_u, ground.nx());
  const int east = wrapped_node(low_u + 1.0, ground.nx());
  const int south = wrapped_node(low_v, ground.ny());
  const int north = wrapped_node(low_v + 1.0, ground.ny());
  Height left = units;
  const auto add_share = [&](int ix, int iy, double weight) {
    const auto share = static_cast<Height>(units * weight);
    left -= share;
    ground.set_node(ix, iy, ground.node(ix, iy) + share);
  };
  add_share(west, south, (1.0 - part_u) * (1.0 - part_v));
  add_share(east, south, part_u * (1.0 - part_v));
  add_share(west, north, (1.0 - part_u) * part_v);
  ground.set_node(east, north, ground.node(east, north) + left);
}

}  // namespace

void move_soil(HeightField& ground, const std::array<double, 2>& from,
               const std::array<double, 2>& to, Height units) {
  deposit_at(ground, from, -units);
  deposit_at(ground, to, units);
}

FluxCells cells_of(std::size_t flux) {
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

FluxNetwork::Patch FluxNetwork::patch_under(const WheelPosition& wheel, const Stride& stride) {
  Patch patch{};
  patch.cos_yaw = portable::cos(stride.yaw_rad);
  patch.sin_yaw = portable::sin(stride.yaw_rad);
  patch.x_m = stride.x_m + patch.cos_yaw * wheel.x - patch.sin_yaw * wheel.y;
  patch.y_m = stride.y_m + patch.sin_yaw * wheel.x + patch.cos_yaw * wheel.y;
  patch.mirrored = wheel.y < 0.0;
  return patch;
}

FluxNetwork::WheelSupport FluxNetwork::wheel_support(const HeightField& ground,
                                                     const std::array<WheelPosition, 4>& wheels,
                                                     const Stride& stride) {
  constexpr double kAlong_m = 0.010;
  constexpr double kAcross_m = 0.010;
  WheelSupport wheel_support{};
  std::array<double, 4> over{};
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Patch patch = patch_under(wheels[i], stride);
    for (const double along : {-kAlong_m, 0.0, kAlong_m}) {
      for (const double across : {-kAcross_m, 0.0, kAcross_m}) {
        const double x = patch.x_m + patch.cos_yaw * along - patch.sin_yaw * across;
        const double y = patch.y_m + patch.sin_yaw * along + patch.cos_yaw * across;
        wheel_support.height_m[i] += ground.at(x, y).height / 9.0;
      }
    }
    over[i] = wheel_support.height_m[i] - wheels[i].x * portable::tan(stride.pitch) -
              wheels[i].y * portable::tan(stride.roll);
  }
  std::array<double, 4> sorted = over;
  std::sort(sorted.begin(), sorted.end());
  const double carried_at = 0.5 * (sorted[2] + sorted[3]);
  for (std::size_t i = 0; i < over.size(); ++i) wheel_support.support_m[i] = over[i] - carried_at;
  return wheel_support;
}

void FluxNetwork::observe(const HeightField& ground, const Patch& patch, const WheelPosition& wheel,
                          double height_m, double support_m, const Stride& stride,
                          std::span<float> observation) {
  const double slope_x = portable::tan(stride.pitch);
  const double slope_y = portable::tan(stride.roll);
  const double side = patch.mirrored ? -1.0 : 1.0;
  const auto bounded = [](double value) {
    return std::clamp(static_cast<float>(value), -kMaxAbsInput, kMaxAbsInput);
  };
  // Heights over the wheel, were the robot to stand on its two highest places: less the robot's
  // plane and the wheel's curve.
  for (int iy = 0; iy < kObservedY; ++iy) {
    for (int ix = 0; ix < kObservedX; ++ix) {
      const auto at = patch.cell(ix - kReachX, iy - kReachY);
      const double x = (ix - kReachX - 0.5 * (kCellsX - 1)) * kCell_m;
      const double y = (iy - kReachY - 0.5 * (kCellsY - 1)) * kCell_m * side;
      const double rim = std::min(std::abs(x), 0.95 * wheel.radius_m);
      const double curve = wheel.radius_m - std::sqrt(wheel.radius_m * wheel.radius_m - rim * rim);
      const double over = ground.at(at[0], at[1]).height - height_m - slope_x * x - slope_y * y;
      observation[observed_index(ix, iy)] = bounded((over + support_m - curve) / kHeightScale_m);
    }
  }
  // At the wheel, not at the robot's middle.
  const double forward = stride.forward_m - stride.turn_rad * wheel.y;
  const double sideways = stride.sideways_m + stride.turn_rad * wheel.x;
  const double surface = stride.track_m[wheel.y < 0.0 ? 1 : 0];
  observation[kObservedCells] = bounded(forward / kDisplacementScale_m);
  observation[kObservedCells + 1] = bounded(side * sideways / kDisplacementScale_m);
  observation[kObservedCells + 2] = bounded((surface - forward) / kDisplacementScale_m);
  observation[kObservedCells + 3] = bounded(side * stride.turn_rad / kTurnScale_rad);
  observation[kObservedCells + 4] = wheel.front ? 1.0F : -1.0F;
  observation[kObservedCells + 5] = bounded(slope_x / kSlopeScale);
  observation[kObservedCells + 6] = bounded(side * slope_y / kSlopeScale);
  observation[kObservedCells + 7] = bounded(support_m / kHeightScale_m);
}

void FluxNetwork::inputs_of(std::span<const float> observation, int ix, int iy, float* inputs) {
  for (int dy = 0; dy <= 2 * kReachY; ++dy) {
    for (int dx = 0; dx <= 2 * kReachX; ++dx) {
      *inputs++ = observation[observed_index(ix + dx, iy + dy)];
    }
  }
  constexpr float kHalfX = 0.5F * (kCellsX - 1);
  constexpr float kHalfY = 0.5F * (kCellsY - 1);
  *inputs++ = 2.0F * (static_cast<float>(ix) - kHalfX) / kHalfX;
  *inputs++ = 2.0F * (static_cast<float>(iy) - kHalfY) / kHalfY;
  std::copy(observation.begin() + kObservedCells, observation.end(), inputs);
}

void FluxNetwork::evaluate(std::span<const float> observation, std::span<float> fluxes) const {
  std::array<float, kInputs> inputs{};
  std::vector<float> out(2 * kCells);
  for (int iy = 0; iy < kCellsY; ++iy) {
    for (int ix = 0; ix < kCellsX; ++ix) {
      inputs_of(observation, ix, iy, inputs.data());
      const auto cell = static_cast<std::size_t>(iy) * kCellsX + static_cast<std::size_t>(ix);
      float forward = second_[hidden_];
      float left = second_[2 * hidden_ + 1];
      for (std::size_t node = 0; node < hidden_; ++node) {
        const float* row = &first_[node * (kInputs + 1)];
        float sum = row[kInputs];
        for (std::size_t i = 0; i < kInputs; ++i) sum += row[i] * inputs[i];
        const float active = static_cast<float>(portable::tanh(sum));
        forward += second_[node] * active;
        left += second_[hidden_ + 1 + node] * active;
      }
      out[cell] = forward;
      out[kCells + cell] = left;
    }
  }
  for (std::size_t flux = 0; flux < kFluxes; ++flux) {
    const FluxCells sides = cells_of(flux);
    fluxes[flux] = out[sides.row * kCells + sides.from];
  }
}

void FluxNetwork::apply(HeightField& ground, const std::array<WheelPosition, 4>& wheels,
                        const Stride& stride) const {
  std::vector<float> observation(kObservation);
  std::vector<float> fluxes(kFluxes);
  const WheelSupport support = wheel_support(ground, wheels, stride);
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    const Patch patch = patch_under(wheels[i], stride);
    observe(ground, patch, wheels[i], support.height_m[i], support.support_m[i], stride,
            observation);
    evaluate(observation, fluxes);
    for (std::size_t flux = 0; flux < kFluxes; ++flux) {
      const auto units = static_cast<Height>(
          std::lround(static_cast<double>(fluxes[flux]) * kOutput_m / kHeightUnit_m));
      if (units == 0) continue;
      const FluxCells sides = cells_of(flux);
      const auto cell = [&](std::size_t index) {
        return patch.cell(static_cast<int>(index % kCellsX), static_cast<int>(index / kCellsX));
      };
      move_soil(ground, cell(sides.from), cell(sides.to), units);
    }
  }
}

std::optional<FluxNetwork> FluxNetwork::read(const std::filesystem::path& file) {
  const Json json = json_of(file, kFluxFormat);
  if (json.is_null()) return std::nullopt;
  try {
    FluxNetwork network(json.at("hidden").get<std::size_t>(), 0);
    const auto first = json.at("first").get<std::vector<float>>();
    const auto second = json.at("second").get<std::vector<float>>();
    if (first.size() != network.first_.size() || second.size() != network.second_.size()) {
      return std::nullopt;
    }
    network.first_ = first;
    network.second_ = second;
    return network;
  } catch (const JsonError&) {
    return std::nullopt;
  }
}

void FluxNetwork::write(const std::filesystem::path& file) const {
  const Json json = {{"format", kFluxFormat},
                     {"cells", {kCellsX, kCellsY}},
                     {"reach", {kReachX, kReachY}},
                     {"hidden", hidden_},
                     {"first", first_},
                     {"second", second_}};
  write_file(file, json.dump() + "\n");
}

// ---- the window

namespace {

constexpr double kSpeed_rad_per_s = 8.0;
constexpr double kTilt_rad = 0.4;

/// The nodes of a field in the cells of the window round a stride's end.
template <class Visit>
void for_nodes(const HeightField& ground, const Stride& stride, Visit&& visit) {
  const int per_cell =
      std::max(1, static_cast<int>(std::lround(WindowNetwork::kCell_m / ground.spacing_m())));
  const int nodes = per_cell * WindowNetwork::kSide;
  const int west =
      static_cast<int>(std::lround((stride.x_m - ground.x_min()) / ground.spacing_m())) - nodes / 2;
  const int south =
      static_cast<int>(std::lround((stride.y_m - ground.y_min()) / ground.spacing_m())) - nodes / 2;
  const auto wrapped_node = [&](int at, int count) {
    if (!ground.wrap()) return at >= 0 && at < count ? at : -1;
    const int within = at % count;
    return within < 0 ? within + count : within;
  };
  for (int iy = 0; iy < nodes; ++iy) {
    const int y = wrapped_node(south + iy, ground.ny());
    for (int ix = 0; ix < nodes; ++ix) {
      const int x = wrapped_node(west + ix, ground.nx());
      if (x < 0 || y < 0) continue;
      visit(static_cast<std::size_t>(iy / per_cell) * WindowNetwork::kSide +
                static_cast<std::size_t>(ix / per_cell),
            x, y, 1.0 / (per_cell * per_cell));
    }
  }
}

}  // namespace

void WindowNetwork::add_motion(const Stride& stride, std::span<float> inputs) {
  inputs[0] = static_cast<float>(stride.v_left / kSpeed_rad_per_s);
  inputs[1] = static_cast<float>(stride.v_right / kSpeed_rad_per_s);
  inputs[2] = static_cast<float>(stride.pitch / kTilt_rad);
  inputs[3] = static_cast<float>(stride.roll / kTilt_rad);
}

void WindowNetwork::observe(const HeightField& before, const HeightField& after,
                            const Stride& stride, std::span<float> cells) {
  std::fill(cells.begin(), cells.end(), 0.0F);
  for_nodes(before, stride, [&](std::size_t cell, int x, int y, double share) {
    const double change = static_cast<double>(after.node(x, y)) - before.node(x, y);
    cells[cell] += static_cast<float>(change * kHeightUnit_m * share / kOutput_m);
  });
}

std::optional<WindowNetwork> WindowNetwork::read(const std::filesystem::path& file) {
  const Json json = json_of(file, kWindowFormat);
  if (json.is_null()) return std::nullopt;
  try {
    WindowNetwork network(json.at("matrix").get<std::vector<float>>(),
                          json.at("constant").get<std::vector<float>>());
    const bool fits =
        network.matrix_.size() == kCells * kInputs && network.constant_.size() == kCells;
    return fits ? std::optional(std::move(network)) : std::nullopt;
  } catch (const JsonError&) {
    return std::nullopt;
  }
}

void WindowNetwork::write(const std::filesystem::path& file) const {
  const Json json = {{"format", kWindowFormat}, {"matrix", matrix_}, {"constant", constant_}};
  write_file(file, json.dump() + "\n");
}

void WindowNetwork::apply(HeightField& ground, const Stride& stride,
                          std::vector<float>& last) const {
  std::vector<float> inputs(last);
  inputs.resize(kInputs);
  add_motion(stride, std::span(inputs).subspan(kCells));
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    float sum = constant_[cell];
    for (std::size_t i = 0; i < kInputs; ++i) sum += matrix_[cell * kInputs + i] * inputs[i];
    last[cell] = sum;
  }
  for_nodes(ground, stride, [&](std::size_t cell, int x, int y, double /*share*/) {
    const double units = static_cast<double>(last[cell]) * kOutput_m / kHeightUnit_m;
    ground.set_node(x, y, ground.node(x, y) + static_cast<Height>(std::lround(units)));
  });
}

// ---- either of them

TerrainNetwork read_terrain_network(const std::filesystem::path& file) {
  if (const auto fluxes = FluxNetwork::read(file)) {
    const auto network = std::make_shared<const FluxNetwork>(*fluxes);
    return {"fluxes", [network](const Assembly& robot) -> GroundChange {
              return [network, wheels = wheel_positions(robot)](HeightField& ground,
                                                                const Stride& stride) {
                network->apply(ground, wheels, stride);
              };
            }};
  }
  if (const auto window = WindowNetwork::read(file)) {
    const auto network = std::make_shared<const WindowNetwork>(*window);
    return {"window", [network](const Assembly& /*robot*/) -> GroundChange {
              return [network, last = std::vector<float>(WindowNetwork::kCells)](
                         HeightField& ground, const Stride& stride) mutable {
                network->apply(ground, stride, last);
              };
            }};
  }
  throw InputError(file.string() + ": is no network of screed terrain-net train");
}

}  // namespace screed::nn
