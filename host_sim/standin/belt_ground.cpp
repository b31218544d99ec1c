// Standing, sinking, digging.
#include "host_sim/standin/belt_ground.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/cholesky.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

namespace screed {
namespace {

constexpr double kStride_s = static_cast<double>(kBeltStrideFrames) / kTickRate_hz;
constexpr double kMinShare = 0.02;        // of a cell that counts as below a belt
constexpr double kPressure_pa = 2000.0;   // about the robot's weight over its belts
constexpr int kMaxIterations = 60;        // of Newton's method; a few are typical
constexpr int kPlacingIterations = 2000;  // where it begins far from the ground
constexpr double kMaxImbalance = 0.1;     // of the weight, else the last plane is kept
constexpr std::int64_t kSlides = 2000;    // in one stride: what is left over goes on in the next
constexpr int kPlacingStrides = 10;

}  // namespace

void BeltStrideRecorder::add_frame(const FrameMotion& motion,
                                   const std::array<BeltShear, 2>& shear) {
  forward_m_ = motion.forward_m;
  for (std::size_t side = 0; side < 2; ++side) shear_[side] += shear[side];
}

BeltStride BeltStrideRecorder::take(const PlanarPose& end) {
  const double faster = (forward_m_ - forward_begin_m_) * kTickRate_hz;
  const BeltStride stride{end, end.since(begin_), shear_, faster / kStride_s};
  begin_ = end;
  forward_begin_m_ = forward_m_;
  shear_ = {};
  return stride;
}

BeltGround::BeltGround(const HeightField& surface, const SoilParameters& soil,
                       const TrackGeometry& tracks, std::size_t robots, const BeltFit& fit)
    : soil_(soil),
      tracks_(tracks),
      fit_(fit),
      flow_(surface, soil.repose_deg, Compaction{soil.compaction, soil.compaction_depth_m}),
      power_(soil.exponent),
      cell_area_(surface.spacing_m() * surface.spacing_m()),
      bekker_(bekker_modulus(soil, tracks.width_m)),
      unloading_pa_per_m_(std::min(
          soil.elastic_pa_per_m,
          fit.unloading * kPressure_pa / bekker_depth_m(soil, tracks.width_m, kPressure_pa))),
      tan_repose_(portable::tan(soil.repose_deg * std::numbers::pi / 180.0)),
      stances_(robots) {
  check_soil(soil);
}

std::size_t BeltGround::patch_of(double x) const {
  const double patch_m = 2.0 * tracks_.half_length_m / kBeltPatches;
  const double from_front = 0.5 * (kBeltPatches - 1) - x / patch_m;
  return static_cast<std::size_t>(std::lround(std::clamp(from_front, 0.0, kBeltPatches - 1.0)));
}

void BeltGround::find_cells(const BeltStride& stride, const TrackPlane& about) {
  const HeightField& field = surface();
  const double edge = field.spacing_m();
  const auto [s, c] = portable::sine_cosine(stride.pose.heading_rad);
  const double across_edge = edge * (std::abs(c) + std::abs(s));
  const double along = tracks_.half_length_m + tracks_.radius_m;
  const double across = 0.5 * (tracks_.width_m + across_edge);
  const double reach_x = std::abs(c) * along + std::abs(s) * across;
  const double reach_y = std::abs(s) * along + std::abs(c) * across;
  const double most_share = std::min(1.0, tracks_.width_m / edge);
  // On a slope the robot does not stand below its origin.
  const double x_m = stride.pose.x_m + tracks_.below_m * (c * about.forward - s * about.left);
  const double y_m = stride.pose.y_m + tracks_.below_m * (s * about.forward + c * about.left);
  const auto cell_of = [&](double coordinate, double begin) {
    return static_cast<int>(std::floor((coordinate - begin) / edge + 0.5));
  };
  cells_.clear();
  for (const std::size_t side : {0U, 1U}) {
    sides_.at(side) = cells_.size();
    const double cx = x_m - s * middle(side);
    const double cy = y_m + c * middle(side);
    const int east = cell_of(cx + reach_x, field.x_min());
    const int north = cell_of(cy + reach_y, field.y_min());
    for (int iy = cell_of(cy - reach_y, field.y_min()); iy <= north; ++iy) {
      for (int ix = cell_of(cx - reach_x, field.x_min()); ix <= east; ++ix) {
        const double dx = field.node_x(ix) - x_m;
        const double dy = field.node_y(iy) - y_m;
        Cell cell{};
        cell.x = dx * c + dy * s;
        cell.y = dy * c - dx * s;
        const double beyond = std::abs(cell.x) - tracks_.half_length_m;
        if (beyond >= 0.95 * tracks_.radius_m) continue;
        cell.share =
            std::min(most_share,
                     0.5 + (0.5 * tracks_.width_m - std::abs(cell.y - middle(side))) / across_edge);
        if (cell.share <= kMinShare) continue;
        cell.at = {0, ix, iy};
        cell.patch = patch_of(cell.x);
        cell.flow = stride.shear[side].patch_flow_m[cell.patch];
        if (!flow_.grid().find(cell.at)) continue;
        const double r = tracks_.radius_m;
        if (beyond > 0.0) cell.over = r - std::sqrt(r * r - beyond * beyond);
        const SoilCell& soil = flow_.grid()[cell.at.node];
        const double sunk = soil.sunk * kHeightUnit_m;
        cell.level = flow_.grid().reference(cell.at.node) * kHeightUnit_m;
        cell.division = soil.history.divide(cell.share, sunk, stride_);
        cell.prior = cell.division.under(cell.share, sunk);
        cells_.push_back(cell);
      }
    }
  }
  sides_[2] = cells_.size();
}

BeltGround::Reaction BeltGround::react(const TrackPlane& plane) {
  Reaction sum;
  for (Cell& cell : cells_) {
    cell.depth =
        cell.level - cell.over - (plane.height_m + plane.forward * cell.x + plane.left * cell.y);
    cell.pressure = 0.0;
    if (cell.depth <= 0.0 || cell.depth <= cell.prior) continue;
    const double capacity = bekker_ * power_.power(cell.depth);
    double virgin = capacity;
    double hardening = power_.exponent() * capacity / cell.depth;
    const double down = cell.depth - cell.prior;  // in this stride
    if (soil_.slip_bearing < 1.0 && cell.flow > 0.0) {
      // bearing_under_slip() of what is plastic of it: down - pressure / E.
      const double per_flow = (1.0 - soil_.slip_bearing) * capacity / cell.flow;
      const double per_elastic = 1.0 / (1.0 + per_flow / unloading_pa_per_m_);
      const double weak = per_elastic * (soil_.slip_bearing * capacity + per_flow * down);
      if (weak < capacity) {
        virgin = weak;
        hardening = power_.exponent() * weak / cell.depth + per_elastic * per_flow;
      }
    }
    const double elastic = unloading_pa_per_m_ * down;
    const bool yields = virgin < elastic;
    cell.pressure = yields ? virgin : elastic;
    const double area = cell_area_ * cell.share;
    const double force = area * cell.pressure;
    const double slope = area * (yields ? hardening : unloading_pa_per_m_);
    sum.force += force;
    sum.moment_x += force * cell.x;
    sum.moment_y += force * cell.y;
    sum.stiffness[0] += slope;
    sum.stiffness[1] += slope * cell.x;
    sum.stiffness[2] += slope * cell.y;
    sum.stiffness[3] += slope * cell.x * cell.x;
    sum.stiffness[4] += slope * cell.x * cell.y;
    sum.stiffness[5] += slope * cell.y * cell.y;
  }
  return sum;
}

/// Where forces balance: Newton's method with a line search, on a convex energy.
TrackPlane BeltGround::find_equilibrium(const TrackPlane& from, double acceleration_m_per_s2,
                                        int iterations) {
  TrackPlane at = from;
  const double weight = tracks_.mass_kg * kGravity_m_per_s2;
  const double backward = at.forward + acceleration_m_per_s2 / kGravity_m_per_s2;
  const Eigen::Vector3d load =
      weight * Eigen::Vector3d(1.0, tracks_.mass_ahead_m - tracks_.mass_height_m * backward,
                               -tracks_.mass_height_m * at.left);
  Reaction soil;
  const auto imbalance = [&](const TrackPlane& plane) {
    soil = react(plane);
    return Eigen::Vector3d(load - Eigen::Vector3d(soil.force, soil.moment_x, soil.moment_y));
  };
  Eigen::Vector3d gradient = imbalance(at);
  for (int iteration = 0; iteration < iterations;) {
    const std::array<double, 6>& k = soil.stiffness;
    Eigen::Matrix3d matrix;
    matrix << k[0] + 1.0, k[1], k[2], k[1], k[3] + 0.01, k[4], k[2], k[4], k[5] + 0.01;
    const Eigen::Vector3d newton = -solve_positive(matrix, gradient);
    const double begin = gradient.dot(newton);
    if (!(begin < 0.0)) break;
    constexpr double kMaxStep_m = 0.01;
    constexpr double kArm_m = 0.1;
    double step = std::min(
        1.0,
        kMaxStep_m / (std::abs(newton[0]) + kArm_m * (std::abs(newton[1]) + std::abs(newton[2]))));
    TrackPlane next;
    for (;;) {
      ++iteration;
      next = {at.height_m + step * newton[0], at.forward + step * newton[1],
              at.left + step * newton[2]};
      gradient = imbalance(next);
      const double slope = gradient.dot(newton);
      if (slope <= -0.3 * begin || iteration >= iterations) break;
      step *= std::clamp(begin / (begin - slope), 0.1, 0.9);  // secant
    }
    at = next;
    if (std::abs(gradient[0]) < 1e-2 * weight &&
        std::abs(gradient[1]) + std::abs(gradient[2]) < 1e-3 * weight) {
      break;
    }
  }
  return std::abs(gradient[0]) < kMaxImbalance * weight ? at : from;
}

/// The cells of a belt are pressed to its depth, but for what springs back.
void BeltGround::compact(const BeltStride& stride, std::size_t side) {
  const auto [s, c] = portable::sine_cosine(stride.pose.heading_rad);
  const double ahead =
      (stride.motion.forward_m - stride.motion.turn_rad * middle(side)) / kStride_s;
  const double left = stride.motion.sideways_m / kStride_s;
  pressed_ = thrown_ = 0.0;
  flow_.begin_footprint({{ahead * c - left * s, ahead * s + left * c}, {c, s}, tracks_.width_m});
  for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
    const Cell& cell = cells_[i];
    CellHistory& history = flow_.grid()[cell.at.node].history;
    if (cell.pressure <= 0.0) {
      history.release();
      continue;
    }
    history.keep(cell.share, cell.division);
    history.touch(stride_);
    flow_.cover(cell.at);
    const double now = cell.depth - cell.pressure / unloading_pa_per_m_;
    const auto units =
        static_cast<Height>(std::lround(cell.share * (now - cell.prior) / kHeightUnit_m));
    if (units <= 0) continue;
    flow_.sink(cell.at, units);
    pressed_ += units;
    thrown_ += units * std::max(0.0, 1.0 - (now - cell.prior) / std::max(cell.flow, 1e-9));
  }
}

/// As SoilBed::dig_below(), of a belt in a stride.
void BeltGround::dig(const BeltStride& stride, const TrackPlane& plane, std::size_t side) {
  const BeltShear& shear = stride.shear.at(side);
  if (shear.length_m <= 0.0 ||
      (soil_.slip_layer_m <= 0.0 && tracks_.lug_height_m <= 0.0 && soil_.slip_bearing >= 1.0))
    return;
  double cells = 0.0;
  double along = 0.0;
  double square = 0.0;
  double depth = 0.0;
  for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
    const Cell& cell = cells_[i];
    if (cell.pressure <= 0.0) continue;
    cells += cell.share;
    along += cell.share * cell.x;
    square += cell.share * cell.x * cell.x;
    depth += cell.share * cell.depth;
    flow_.shear(cell.at.node, cell.share * shear.patch_m[cell.patch]);
  }
  if (cells <= 0.0) return;
  along /= cells;
  const auto [s, c] = portable::sine_cosine(stride.pose.heading_rad);
  const Eigen::Vector2d forward(c, s);
  const Eigen::Vector2d left(-s, c);
  DugPatch patch;
  patch.forward = forward;
  patch.centre =
      Eigen::Vector2d(stride.pose.x_m, stride.pose.y_m) + along * forward + middle(side) * left;
  patch.half_length =
      0.5 * std::sqrt(12.0 * std::max(0.0, square / cells - along * along) + cell_area_);
  patch.half_width = 0.5 * tracks_.width_m;
  patch.band = tracks_.width_m;
  const double layer =
      std::max(soil_.slip_layer_m, std::min(tracks_.lug_height_m, depth / cells)) / kHeightUnit_m;
  dig_remainder_ += fit_.digging * layer * shear.length_m * tracks_.width_m / cell_area_;
  const Eigen::Vector2d fall = -(plane.forward * forward + plane.left * left);
  const Eigen::Vector2d downhill = shear.length_m / std::max(tan_repose_, fall.norm()) * fall;
  const Eigen::Vector2d dragged = shear.forward_m * forward + shear.left_m * left;
  patch.carried = layer * cells * (downhill - soil_.slip_carry * dragged);
  const Eigen::Vector2d past = 2.0 * (patch.half_length * shear.forward_m * forward +
                                      patch.half_width * shear.left_m * left);
  patch.carried -= soil_.slip_carry * thrown_ / shear.length_m * past;
  const auto units = static_cast<std::int64_t>(dig_remainder_);
  dig_remainder_ -= static_cast<double>(units);
  flow_.dig(patch, units, pressed_ > 0.0 ? thrown_ / pressed_ : 0.0);
}

void BeltGround::keep_support(const TrackPlane& plane, Stance& stance) const {
  BeltSupport& support = stance.support;
  support = {plane.forward, plane.left};
  const double half_cell = 0.5 * surface().spacing_m();
  double sum = 0.0;
  for (const std::size_t side : {0U, 1U}) {
    double area = 0.0;
    double depth = 0.0;
    double& front = support.front.at(side) = -std::numeric_limits<double>::infinity();
    double& rear = support.rear.at(side) = std::numeric_limits<double>::infinity();
    for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
      const Cell& cell = cells_[i];
      if (cell.pressure <= 0.0) continue;
      const double touched = cell_area_ * cell.share;
      support.load[side][cell.patch] += touched * cell.pressure;
      support.area[side][cell.patch] += touched;
      sum += touched * cell.pressure;
      front = std::max(front, cell.x + half_cell);
      rear = std::min(rear, cell.x - half_cell);
      area += touched;
      depth += touched * cell.depth;
    }
    const double sinkage = area > 0.0 ? depth / area : 0.0;
    stance.sinkage_m.at(side) = sinkage;
    support.filled.at(side) = sinkage < tracks_.lug_height_m ? sinkage / tracks_.lug_height_m : 1.0;
  }
  if (sum <= 0.0) {
    support.load = level_support(tracks_).load;
    return;
  }
  for (auto& belt : support.load) {
    for (double& load : belt) load /= sum;
  }
}

void BeltGround::place(std::size_t robot, const PlanarPose& pose) {
  for (int i = 0; i < kPlacingStrides; ++i) {
    press(robot, {pose, {}, {}, 0.0});
    end_stride();
  }
}

void BeltGround::press(std::size_t robot, const BeltStride& stride) {
  Stance& stance = stances_[robot];
  find_cells(stride, stance.plane);
  if (cells_.empty()) return;
  TrackPlane from = stance.plane;
  if (stance.placed) {
    from.height_m += from.forward * stride.motion.forward_m + from.left * stride.motion.sideways_m;
  } else {
    from.height_m = -std::numeric_limits<double>::max();
    for (const Cell& cell : cells_) from.height_m = std::max(from.height_m, cell.level - cell.over);
  }
  const TrackPlane plane = find_equilibrium(from, stride.acceleration_m_per_s2,
                                            stance.placed ? kMaxIterations : kPlacingIterations);
  react(plane);
  for (const std::size_t side : {0U, 1U}) {
    compact(stride, side);
    dig(stride, plane, side);
  }
  stance.placed = true;
  stance.plane = plane;
  keep_support(plane, stance);
}

void BeltGround::end_stride() {
  flow_.deposit();
  flow_.slide(kSlides);
  flow_.uncover();
  ++stride_;
}

}  // namespace screed
