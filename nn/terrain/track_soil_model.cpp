// Equilibrium of the tracks, compaction, deposition.
#include "nn/terrain/track_soil_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/core/gravity.h"
#include "nn/data/motion_signals.h"

namespace screed::nn {
namespace {

constexpr double kMinShare = 0.02;
constexpr int kMaxIterations = 200;    // of Newton's method; ten are typical
constexpr double kMaxImbalance = 0.1;  // of the weight, else the last plane is kept
constexpr std::int64_t kSlides = 4000;
constexpr double kPressure_pa = 2000.0;  // about the robot's weight over its tracks
constexpr double kStanding_m = 0.001;    // of a stride: less is no direction
constexpr double kMinCapacityShare = 0.05;
constexpr double kMaxGap_m = 0.01;
// Scales of the network's inputs.
constexpr double kDisplacement_m = 0.006;
constexpr double kTurn_rad = 0.05;
constexpr double kSlope = 0.1;
// Middle and half range of soil_signals().
constexpr std::array<std::array<double, 2>, 6> kSoilRanges = {
    {{6.0, 1.0}, {0.85, 0.35}, {2000.0, 2000.0}, {0.5, 0.25}, {0.015, 0.008}, {-2.5, 1.0}}};

HeightField sum_of(const HeightField& a, const HeightField& b) {
  HeightField sum = a;
  for (int iy = 0; iy < a.ny(); ++iy) {
    for (int ix = 0; ix < a.nx(); ++ix) sum.set_node(ix, iy, a.node(ix, iy) + b.node(ix, iy));
  }
  return sum;
}

}  // namespace

TrackPlane track_plane_of(const TrackGeometry& tracks, const Stride& stride) {
  return {stride.z_m - tracks.below_m * std::cos(stride.pitch) * std::cos(stride.roll),
          std::tan(stride.pitch), std::tan(stride.roll)};
}

TrackSoilModel::TrackSoilModel(const HeightField& ground, const SoilParameters& soil,
                               const TrackGeometry& tracks)
    : soil_(soil),
      tracks_(tracks),
      flow_(ground, soil.repose_deg),
      power_(soil.exponent),
      bekker_(soil.k_c / tracks.width_m + soil.k_phi),
      sinkage_m_(std::pow(kPressure_pa / bekker_, 1.0 / soil.exponent)),
      histories_(flow_.nodes()) {
  const std::array<double, kSoilSignals> signals = soil_signals(soil);
  for (std::size_t i = 0; i < kSoilRanges.size(); ++i) {
    soil_inputs_.at(i) =
        static_cast<float>((signals.at(i) - kSoilRanges.at(i)[0]) / kSoilRanges.at(i)[1]);
  }
}

TrackSoilModel::TrackSoilModel(const HeightField& ground, const HeightField& sinkage,
                               const SoilParameters& soil, const TrackGeometry& tracks)
    : TrackSoilModel(sum_of(ground, sinkage), soil, tracks) {
  for (int iy = 0; iy < sinkage.ny(); ++iy) {
    for (int ix = 0; ix < sinkage.nx(); ++ix) {
      flow_.begin_sunk(flow_.index(ix, iy), sinkage.node(ix, iy));
    }
  }
}

HeightField TrackSoilModel::sinkage() const {
  const HeightField& now = surface();
  HeightField sinkage(now.nx(), now.ny(), now.spacing_m(), now.wrap());
  for (int iy = 0; iy < now.ny(); ++iy) {
    for (int ix = 0; ix < now.nx(); ++ix) {
      sinkage.set_node(ix, iy, flow_.reference(flow_.index(ix, iy)) - now.node(ix, iy));
    }
  }
  return sinkage;
}

double TrackSoilModel::unloading_stiffness(double times) const {
  return std::min(soil_.elastic_pa_per_m, times * kPressure_pa / sinkage_m_);
}

double TrackSoilModel::track_advance(const Stride& stride, std::size_t side) const {
  const double middle = side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
  return stride.forward_m - stride.turn_rad * middle;
}

void TrackSoilModel::find_cells(const Stride& stride, const TrackPlane& about) {
  const HeightField& field = flow_.surface();
  const double edge = field.spacing_m();
  const double c = std::cos(stride.yaw_rad);
  const double s = std::sin(stride.yaw_rad);
  const double across_edge = edge * (std::abs(c) + std::abs(s));
  const double along = tracks_.half_length_m + tracks_.radius_m;
  const double across = 0.5 * (tracks_.width_m + across_edge);
  const double reach_x = std::abs(c) * along + std::abs(s) * across;
  const double reach_y = std::abs(s) * along + std::abs(c) * across;
  // On a slope the robot does not stand below its origin.
  const double x_m = stride.x_m + tracks_.below_m * (c * about.forward - s * about.left);
  const double y_m = stride.y_m + tracks_.below_m * (s * about.forward + c * about.left);
  const auto cell_of = [&](double coordinate, double begin) {
    return static_cast<int>(std::floor((coordinate - begin) / edge + 0.5));
  };
  cells_.clear();
  for (const std::size_t side : {0U, 1U}) {
    sides_.at(side) = cells_.size();
    const double middle = side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
    const double cx = x_m - s * middle;
    const double cy = y_m + c * middle;
    const int east = cell_of(cx + reach_x, field.x_min());
    const int north = cell_of(cy + reach_y, field.y_min());
    for (int iy = cell_of(cy - reach_y, field.y_min()); iy <= north; ++iy) {
      for (int ix = cell_of(cx - reach_x, field.x_min()); ix <= east; ++ix) {
        const std::int64_t node = flow_.node_at(ix, iy);
        if (node < 0) continue;
        const double dx = field.node_x(ix) - x_m;
        const double dy = field.node_y(iy) - y_m;
        TrackCell cell{};
        cell.x = dx * c + dy * s;
        cell.y = dy * c - dx * s;
        const double beyond = std::abs(cell.x) - tracks_.half_length_m;
        if (beyond >= 0.95 * tracks_.radius_m) continue;
        cell.share =
            std::min(1.0, 0.5 + (0.5 * tracks_.width_m - std::abs(cell.y - middle)) / across_edge);
        if (cell.share <= kMinShare) continue;
        cell.node = static_cast<std::size_t>(node);
        cell.ix = ix;
        cell.iy = iy;
        const double r = tracks_.radius_m;
        if (beyond > 0.0) cell.over = r - std::sqrt(r * r - beyond * beyond);
        cell.level = flow_.reference(cell.node) * kHeightUnit_m;
        cell.sinkage = (flow_.reference(cell.node) - flow_.height(cell.node)) * kHeightUnit_m;
        cell.division = histories_[cell.node].divide(cell.share, cell.sinkage, step_);
        cell.prior = cell.division.under(cell.share, cell.sinkage);
        cells_.push_back(cell);
      }
    }
  }
  sides_[2] = cells_.size();
}

/// What the tracks passed before, each along its own way: where a track has risen over it since,
/// as PathHistory has it (host_sim/physics/terrain/footprint.h), in the last steps' stance.
void TrackSoilModel::update_paths(const Stride& stride) {
  const double length = tracks_.half_length_m + tracks_.radius_m;
  for (const std::size_t side : {0U, 1U}) {
    const double forward = track_advance(stride, side);
    directions_.at(side) = std::clamp(forward / kStanding_m, -1.0, 1.0);
    if (!last_.has_value()) continue;
    const double middle = side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
    TrackPath& path = paths_.at(side);
    const double height = last_->height_m + last_->left * middle;
    const double rose = height - path.height_m.value_or(height);
    path.height_m = height;
    if (forward * path.distance_m < 0.0) path.distance_m = path.rise = 0.0;
    path.distance_m += forward;
    const double share = std::min(1.0, std::abs(forward) / length);
    const double up =
        std::clamp(rose - last_->forward * forward, -std::abs(forward), std::abs(forward)) / length;
    path.rise += (forward < 0.0 ? -up : up) - share * path.rise;
  }
}

/// Bearing capacity of each cell.
void TrackSoilModel::apply_capacity(const BearingCapacity& bearing) {
  const double r = tracks_.radius_m;
  for (const std::size_t side : {0U, 1U}) {
    const TrackPath& path = paths_.at(side);
    const double direction = path.distance_m > 0.0 ? 1.0 : -1.0;
    const double reach = std::abs(path.distance_m) + flow_.surface().spacing_m();
    for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
      TrackCell& cell = cells_[i];
      const double ahead = directions_.at(side) * cell.x / tracks_.half_length_m;
      cell.capacity_share =
          ahead < 0.0 ? std::max(kMinCapacityShare, 1.0 + bearing.rear_reduction * ahead) : 1.0;
      cell.gap = 0.0;
      if (path.distance_m == 0.0 || std::abs(cell.x) > reach) continue;
      double low = cell.over - r;
      for (const double axle : {-tracks_.half_length_m, tracks_.half_length_m}) {
        if (direction * (axle + r * path.rise - cell.x) > 0.0) {
          low = std::min(low, path.rise * (cell.x - axle) - r);
        }
      }
      cell.gap = std::min(bearing.uplift * (cell.over - r - low), kMaxGap_m);
    }
  }
}

/// Minus the soil's reaction force and its moments, and their derivatives by the plane.
Eigen::Vector3d TrackSoilModel::soil_reaction(const TrackPlane& track_plane,
                                              double unloading_pa_per_m,
                                              Eigen::Matrix3d& stiffness) {
  const double area = flow_.surface().spacing_m() * flow_.surface().spacing_m();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  stiffness.setZero();
  for (TrackCell& cell : cells_) {
    cell.depth = cell.level - cell.over -
                 (track_plane.height_m + track_plane.forward * cell.x + track_plane.left * cell.y);
    cell.pressure = 0.0;
    if (cell.depth <= 0.0 || cell.depth <= cell.prior) continue;
    const double deepest = cell.depth + cell.gap;
    const double pressed = cell.capacity_share * bekker_ * power_.power(deepest);
    const double virgin = pressed - unloading_pa_per_m * cell.gap;
    if (virgin <= 0.0) continue;
    const double stiff = unloading_pa_per_m * (cell.depth - cell.prior);
    const bool yields = virgin < stiff;
    cell.pressure = yields ? virgin : stiff;
    const double force = area * cell.share * cell.pressure;
    const double slope =
        area * cell.share * (yields ? soil_.exponent * pressed / deepest : unloading_pa_per_m);
    const Eigen::Vector3d arm(1.0, cell.x, cell.y);
    sum -= force * arm;
    stiffness += slope * arm * arm.transpose();
  }
  return sum;
}

/// Where forces balance: Newton's method with a line search, on a convex energy.
TrackPlane TrackSoilModel::find_equilibrium(const BearingCapacity& bearing) {
  TrackPlane at;
  if (last_.has_value()) {
    at = *last_;
  } else {
    at.height_m = -std::numeric_limits<double>::max();
    for (const TrackCell& cell : cells_)
      at.height_m = std::max(at.height_m, cell.level - cell.over);
  }
  const double weight = bearing.load * tracks_.mass_kg * kGravity_m_per_s2;
  const double mass_x = tracks_.mass_ahead_m - tracks_.mass_height_m * at.forward +
                        bearing.mass_offset_m * 0.5 * (directions_[0] + directions_[1]);
  const double mass_y = -tracks_.mass_height_m * at.left;
  const Eigen::Vector3d load(weight, weight * mass_x, weight * mass_y);
  const double yielding = unloading_stiffness(bearing.equilibrium_stiffness);
  Eigen::Matrix3d stiffness;
  Eigen::Vector3d gradient = load + soil_reaction(at, yielding, stiffness);
  for (int iteration = 0; iteration < kMaxIterations;) {
    stiffness.diagonal() += Eigen::Vector3d(1.0, 0.01, 0.01);
    const Eigen::Vector3d newton_step = -stiffness.llt().solve(gradient);
    const double begin = gradient.dot(newton_step);
    if (!(begin < 0.0)) break;
    constexpr double kMaxStep_m = 0.01;
    constexpr double kArm_m = 0.1;
    double step = std::min(
        1.0, kMaxStep_m / (std::abs(newton_step[0]) +
                           kArm_m * (std::abs(newton_step[1]) + std::abs(newton_step[2]))));
    TrackPlane next;
    for (;;) {
      ++iteration;
      next = {at.height_m + step * newton_step[0], at.forward + step * newton_step[1],
              at.left + step * newton_step[2]};
      gradient = load + soil_reaction(next, yielding, stiffness);
      const double slope = gradient.dot(newton_step);
      if (slope <= -0.3 * begin || iteration >= kMaxIterations) break;
      step *= std::clamp(begin / (begin - slope), 0.1, 0.9);  // secant
    }
    at = next;
    if (std::abs(gradient[0]) < 1e-3 * weight &&
        std::abs(gradient[1]) + std::abs(gradient[2]) < 1e-4 * weight) {
      break;
    }
  }
  const bool stands = std::abs(gradient[0]) < kMaxImbalance * weight;
  return stands || !last_.has_value() ? at : *last_;
}

std::array<float, BearingCapacityNetwork::kInputs> TrackSoilModel::network_inputs(
    const Stride& stride) const {
  double all = 0.0;
  double pressed = 0.0;
  for (const TrackCell& cell : cells_) {
    all += cell.share;
    pressed += cell.share * cell.prior / (cell.prior + sinkage_m_);
  }
  const double slip = 0.5 * (std::abs(stride.track_m[0] - track_advance(stride, 0)) +
                             std::abs(stride.track_m[1] - track_advance(stride, 1)));
  const auto bounded = [](double value) {
    return std::clamp(static_cast<float>(value), -3.0F, 3.0F);
  };
  std::array<float, BearingCapacityNetwork::kInputs> inputs{};
  std::copy(soil_inputs_.begin(), soil_inputs_.end(), inputs.begin());
  inputs[6] = bounded(std::abs(stride.forward_m) / kDisplacement_m - 1.0);
  inputs[7] = bounded(std::abs(stride.turn_rad) / kTurn_rad - 0.5);
  inputs[8] = bounded(slip / kDisplacement_m);
  const TrackPlane track_plane = last_.value_or(TrackPlane{});
  inputs[9] = bounded(std::hypot(track_plane.forward, track_plane.left) / kSlope - 1.0);
  inputs[10] = bounded(4.0 * pressed / all - 1.0);
  return inputs;
}

void TrackSoilModel::compact_soil(const Stride& stride, const TrackPlane& track_plane,
                                  double unloading_pa_per_m) {
  Eigen::Matrix3d unused;
  soil_reaction(track_plane, unloading_pa_per_m, unused);
  compact_cells(stride, unloading_pa_per_m);
  track_plane_ = track_plane;
  last_ = track_plane;
}

void TrackSoilModel::compact_cells(const Stride& stride, double unloading_pa_per_m) {
  const double c = std::cos(stride.yaw_rad);
  const double s = std::sin(stride.yaw_rad);
  constexpr double kPerSecond = kStrideRate_hz;
  for (const std::size_t side : {0U, 1U}) {
    const double forward = kPerSecond * track_advance(stride, side);
    const double left = kPerSecond * stride.sideways_m;
    flow_.begin_footprint({{forward * c - left * s, forward * s + left * c}});
    for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
      const TrackCell& cell = cells_[i];
      CellHistory& history = histories_[cell.node];
      if (cell.pressure <= 0.0) {
        history.release();
        continue;
      }
      history.keep(cell.share, cell.division);
      history.touch(step_);
      flow_.cover(cell.node, cell.ix, cell.iy);
      const double now = cell.depth - cell.pressure / unloading_pa_per_m;
      const auto units =
          static_cast<Height>(std::lround(cell.share * (now - cell.prior) / kHeightUnit_m));
      if (units <= 0) continue;
      flow_.sink(cell.node, cell.ix, cell.iy, units);
    }
  }
  flow_.deposit();
  flow_.slide(kSlides);
  flow_.uncover();
  ++step_;
}

void TrackSoilModel::step(const Stride& stride, const BearingCapacityNetwork* network) {
  find_cells(stride, last_.value_or(TrackPlane{}));
  if (cells_.empty()) return;
  update_paths(stride);
  const BearingCapacity bearing =
      network != nullptr ? network->evaluate(network_inputs(stride)) : BearingCapacity{};
  apply_capacity(bearing);
  TrackPlane track_plane = find_equilibrium(bearing);
  if (last_.has_value()) {
    // From where the last plane has moved to by now.
    const double height =
        last_->height_m + last_->forward * stride.forward_m + last_->left * stride.sideways_m;
    const auto part = [&](double from, double to) {
      return from + bearing.relaxation * (to - from);
    };
    track_plane = {part(height, track_plane.height_m), part(last_->forward, track_plane.forward),
                   part(last_->left, track_plane.left)};
  }
  compact_soil(stride, track_plane, unloading_stiffness(bearing.compaction_stiffness));
}

void TrackSoilModel::step_at(const Stride& stride, const TrackPlane& track_plane) {
  find_cells(stride, track_plane);
  if (cells_.empty()) return;
  apply_capacity({.uplift = 0.0});
  compact_soil(stride, track_plane, soil_.elastic_pa_per_m);
}

void TrackSoilModel::step_evenly(const Stride& stride) {
  find_cells(stride, TrackPlane{});
  if (cells_.empty()) return;
  const double area = 4.0 * tracks_.half_length_m * tracks_.width_m;
  const double pressure = tracks_.mass_kg * kGravity_m_per_s2 / area;
  const double depth = std::pow(pressure / bekker_, 1.0 / soil_.exponent);
  for (TrackCell& cell : cells_) {
    cell.depth = depth - cell.over;
    cell.pressure = cell.depth > 0.0 ? pressure : 0.0;
  }
  compact_cells(stride, std::numeric_limits<double>::infinity());
}

}  // namespace screed::nn
