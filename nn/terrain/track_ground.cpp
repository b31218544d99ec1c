// Stance, pressing, setting down.
#include "nn/terrain/track_ground.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <variant>

#include "host_sim/core/errors.h"
#include "nn/data/signals.h"

namespace screed::nn {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kLeastShare = 0.02;
constexpr int kMostTurns = 200;         // of Newton's method; some ten are usual
constexpr double kMostUnbalance = 0.1;  // of the weight, else the last stance stays
constexpr std::int64_t kSlides = 4000;
constexpr double kPressure_pa = 2000.0;  // about the robot's weight over its tracks
constexpr double kStanding_m = 0.001;    // of a stride: less is no direction
constexpr double kLeastBearing = 0.05;
constexpr double kMostGap_m = 0.01;
// Scales of the network's inputs.
constexpr double kWay_m = 0.006;
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

TrackGeometry track_geometry(const Assembly& robot) {
  TrackGeometry tracks;
  const auto wheel = [&](const char* name) -> const AssemblyBody& {
    const int index = robot.body_index(name);
    if (index < 0) throw InputError(std::string("robot model: no wheel '") + name + "'");
    return robot.bodies[static_cast<std::size_t>(index)];
  };
  const AssemblyBody& front = wheel("fl_Wheel");
  const Eigen::Vector3d at = front.pose.translation();
  tracks.half_length_m = 0.5 * (at.x() - wheel("bl_Wheel").pose.translation().x());
  tracks.half_tread_m = at.y();
  for (const Shape& shape : front.collision) {
    const auto* cylinder = std::get_if<Cylinder>(&shape.geometry);
    if (cylinder == nullptr) continue;
    tracks.radius_m = cylinder->radius;
    tracks.width_m = cylinder->length;
  }
  tracks.below_m = tracks.radius_m - at.z();
  double mass = 0.0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const AssemblyBody& body : robot.bodies) {
    mass += body.inertia.mass;
    centre += body.inertia.mass * (body.pose * body.inertia.pose.translation());
  }
  tracks.mass_kg = mass;
  tracks.mass_ahead_m = centre.x() / mass;
  tracks.mass_height_m = centre.z() / mass + tracks.below_m;
  return tracks;
}

Stance stance_of(const TrackGeometry& tracks, const Stride& stride) {
  return {stride.z_m - tracks.below_m * std::cos(stride.pitch) * std::cos(stride.roll),
          std::tan(stride.pitch), std::tan(stride.roll)};
}

TrackGround::TrackGround(const HeightField& ground, const SoilParameters& soil,
                         const TrackGeometry& tracks)
    : soil_(soil),
      tracks_(tracks),
      flow_(ground, soil.repose_deg),
      power_(soil.exponent),
      bekker_(soil.k_c / tracks.width_m + soil.k_phi),
      sinkage_m_(std::pow(kPressure_pa / bekker_, 1.0 / soil.exponent)),
      traces_(flow_.nodes()) {
  const std::array<double, kSoilSignals> signals = soil_signals(soil);
  for (std::size_t i = 0; i < kSoilRanges.size(); ++i) {
    soil_inputs_.at(i) =
        static_cast<float>((signals.at(i) - kSoilRanges.at(i)[0]) / kSoilRanges.at(i)[1]);
  }
}

TrackGround::TrackGround(const HeightField& ground, const HeightField& sunk,
                         const SoilParameters& soil, const TrackGeometry& tracks)
    : TrackGround(sum_of(ground, sunk), soil, tracks) {
  for (int iy = 0; iy < sunk.ny(); ++iy) {
    for (int ix = 0; ix < sunk.nx(); ++ix) {
      const Height units = sunk.node(ix, iy);
      if (units == 0) continue;
      flow_.sink(flow_.index(ix, iy), ix, iy, units);
      flow_.compact(units);
    }
  }
}

HeightField TrackGround::sunk() const {
  const HeightField& now = surface();
  HeightField sunk(now.nx(), now.ny(), now.spacing_m(), now.wrap());
  for (int iy = 0; iy < now.ny(); ++iy) {
    for (int ix = 0; ix < now.nx(); ++ix) {
      sunk.set_node(ix, iy, flow_.reference(flow_.index(ix, iy)) - now.node(ix, iy));
    }
  }
  return sunk;
}

double TrackGround::elastic(double times) const {
  return std::min(soil_.elastic_pa_per_m, times * kPressure_pa / sinkage_m_);
}

double TrackGround::along(const Stride& stride, std::size_t side) const {
  const double middle = side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
  return stride.forward_m - stride.turn_rad * middle;
}

void TrackGround::find_cells(const Stride& stride, const Stance& about) {
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
        Cell cell{};
        cell.x = dx * c + dy * s;
        cell.y = dy * c - dx * s;
        const double beyond = std::abs(cell.x) - tracks_.half_length_m;
        if (beyond >= 0.95 * tracks_.radius_m) continue;
        cell.share =
            std::min(1.0, 0.5 + (0.5 * tracks_.width_m - std::abs(cell.y - middle)) / across_edge);
        if (cell.share <= kLeastShare) continue;
        cell.node = static_cast<std::size_t>(node);
        cell.ix = ix;
        cell.iy = iy;
        const double r = tracks_.radius_m;
        if (beyond > 0.0) cell.over = r - std::sqrt(r * r - beyond * beyond);
        cell.level = flow_.reference(cell.node) * kHeightUnit_m;
        cell.sunk = (flow_.reference(cell.node) - flow_.height(cell.node)) * kHeightUnit_m;
        recall(cell);
        cells_.push_back(cell);
      }
    }
  }
  sides_[2] = cells_.size();
}

/// How much of a cell's sinkage belongs to the part that is below the track now.
void TrackGround::recall(Cell& cell) const {
  const Trace& trace = traces_[cell.node];
  const double before = static_cast<double>(trace.covered);
  const double beside = static_cast<double>(trace.beside);
  if (trace.step == 0 || trace.step + 1 < step_) {
    // What an earlier track pressed lies below this one as far as it covers it.
    cell.beside = cell.sunk - cell.share * cell.sunk / std::max(cell.share, before);
  } else if (cell.share < before) {
    cell.beside = cell.sunk - cell.share * (cell.sunk - beside) / before;
  } else if (cell.share > before && before < 1.0) {
    cell.beside = beside * (1.0 - cell.share) / (1.0 - before);
  } else {
    cell.beside = beside;
  }
  cell.old = (cell.sunk - cell.beside) / cell.share;
}

/// What the tracks passed before, each along its own way: where a track has risen over it since,
/// as FootprintWay has it (host_sim/physics/soil/footprint.h), in the last steps' stance.
void TrackGround::go_on(const Stride& stride) {
  const double length = tracks_.half_length_m + tracks_.radius_m;
  for (const std::size_t side : {0U, 1U}) {
    const double forward = along(stride, side);
    sense_.at(side) = std::clamp(forward / kStanding_m, -1.0, 1.0);
    if (!last_.has_value()) continue;
    const double middle = side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
    Way& way = ways_.at(side);
    const double height = last_->height_m + last_->left * middle;
    const double rose = height - way.height_m.value_or(height);
    way.height_m = height;
    if (forward * way.along_m < 0.0) way.along_m = way.rise = 0.0;
    way.along_m += forward;
    const double share = std::min(1.0, std::abs(forward) / length);
    const double up =
        std::clamp(rose - last_->forward * forward, -std::abs(forward), std::abs(forward)) / length;
    way.rise += (forward < 0.0 ? -up : up) - share * way.rise;
  }
}

/// How each cell bears.
void TrackGround::bear(const Bearing& bearing) {
  const double r = tracks_.radius_m;
  for (const std::size_t side : {0U, 1U}) {
    const Way& way = ways_.at(side);
    const double sense = way.along_m > 0.0 ? 1.0 : -1.0;
    const double reach = std::abs(way.along_m) + flow_.surface().spacing_m();
    for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
      Cell& cell = cells_[i];
      const double ahead = sense_.at(side) * cell.x / tracks_.half_length_m;
      cell.bears = ahead < 0.0 ? std::max(kLeastBearing, 1.0 + bearing.trail * ahead) : 1.0;
      cell.gap = 0.0;
      if (way.along_m == 0.0 || std::abs(cell.x) > reach) continue;
      double low = cell.over - r;
      for (const double axle : {-tracks_.half_length_m, tracks_.half_length_m}) {
        if (sense * (axle + r * way.rise - cell.x) > 0.0) {
          low = std::min(low, way.rise * (cell.x - axle) - r);
        }
      }
      cell.gap = std::min(bearing.lift * (cell.over - r - low), kMostGap_m);
    }
  }
}

/// Less what the ground bears, and its moments; and how they change with the stance.
Eigen::Vector3d TrackGround::unbalance(const Stance& stance, double elastic,
                                       Eigen::Matrix3d& stiffness) {
  const double area = flow_.surface().spacing_m() * flow_.surface().spacing_m();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  stiffness.setZero();
  for (Cell& cell : cells_) {
    cell.depth =
        cell.level - cell.over - (stance.height_m + stance.forward * cell.x + stance.left * cell.y);
    cell.pressure = 0.0;
    if (cell.depth <= 0.0 || cell.depth <= cell.old) continue;
    const double deepest = cell.depth + cell.gap;
    const double pressed = cell.bears * bekker_ * power_.power(deepest);
    const double virgin = pressed - elastic * cell.gap;
    if (virgin <= 0.0) continue;
    const double stiff = elastic * (cell.depth - cell.old);
    const bool yields = virgin < stiff;
    cell.pressure = yields ? virgin : stiff;
    const double force = area * cell.share * cell.pressure;
    const double slope =
        area * cell.share * (yields ? soil_.exponent * pressed / deepest : elastic);
    const Eigen::Vector3d arm(1.0, cell.x, cell.y);
    sum -= force * arm;
    stiffness += slope * arm * arm.transpose();
  }
  return sum;
}

/// Where forces balance: Newton's method with a line search, on a convex energy.
Stance TrackGround::stand(const Bearing& bearing) {
  Stance at;
  if (last_.has_value()) {
    at = *last_;
  } else {
    at.height_m = -std::numeric_limits<double>::max();
    for (const Cell& cell : cells_) at.height_m = std::max(at.height_m, cell.level - cell.over);
  }
  const double weight = bearing.load * tracks_.mass_kg * kGravity;
  const double mass_x = tracks_.mass_ahead_m - tracks_.mass_height_m * at.forward +
                        bearing.ahead_m * 0.5 * (sense_[0] + sense_[1]);
  const double mass_y = -tracks_.mass_height_m * at.left;
  const Eigen::Vector3d load(weight, weight * mass_x, weight * mass_y);
  const double yielding = elastic(bearing.stance_stiffness);
  Eigen::Matrix3d stiffness;
  Eigen::Vector3d gradient = load + unbalance(at, yielding, stiffness);
  for (int turn = 0; turn < kMostTurns;) {
    stiffness.diagonal() += Eigen::Vector3d(1.0, 0.01, 0.01);
    const Eigen::Vector3d way = -stiffness.llt().solve(gradient);
    const double begin = gradient.dot(way);
    if (!(begin < 0.0)) break;
    constexpr double kMostWay_m = 0.01;
    constexpr double kArm_m = 0.1;
    double step = std::min(
        1.0, kMostWay_m / (std::abs(way[0]) + kArm_m * (std::abs(way[1]) + std::abs(way[2]))));
    Stance next;
    for (;;) {
      ++turn;
      next = {at.height_m + step * way[0], at.forward + step * way[1], at.left + step * way[2]};
      gradient = load + unbalance(next, yielding, stiffness);
      const double slope = gradient.dot(way);
      if (slope <= -0.3 * begin || turn >= kMostTurns) break;
      step *= std::clamp(begin / (begin - slope), 0.1, 0.9);  // secant
    }
    at = next;
    if (std::abs(gradient[0]) < 1e-3 * weight &&
        std::abs(gradient[1]) + std::abs(gradient[2]) < 1e-4 * weight) {
      break;
    }
  }
  const bool stands = std::abs(gradient[0]) < kMostUnbalance * weight;
  return stands || !last_.has_value() ? at : *last_;
}

std::array<float, BearingNetwork::kInputs> TrackGround::look(const Stride& stride) const {
  double all = 0.0;
  double pressed = 0.0;
  for (const Cell& cell : cells_) {
    all += cell.share;
    pressed += cell.share * cell.old / (cell.old + sinkage_m_);
  }
  const double slip = 0.5 * (std::abs(stride.track_m[0] - along(stride, 0)) +
                             std::abs(stride.track_m[1] - along(stride, 1)));
  const auto bounded = [](double value) {
    return std::clamp(static_cast<float>(value), -3.0F, 3.0F);
  };
  std::array<float, BearingNetwork::kInputs> inputs{};
  std::copy(soil_inputs_.begin(), soil_inputs_.end(), inputs.begin());
  inputs[6] = bounded(std::abs(stride.forward_m) / kWay_m - 1.0);
  inputs[7] = bounded(std::abs(stride.turn_rad) / kTurn_rad - 0.5);
  inputs[8] = bounded(slip / kWay_m);
  const Stance stance = last_.value_or(Stance{});
  inputs[9] = bounded(std::hypot(stance.forward, stance.left) / kSlope - 1.0);
  inputs[10] = bounded(4.0 * pressed / all - 1.0);
  return inputs;
}

void TrackGround::press(const Stride& stride, const Stance& stance, double elastic) {
  Eigen::Matrix3d unused;
  unbalance(stance, elastic, unused);
  press_cells(stride, elastic);
  stance_ = stance;
  last_ = stance;
}

void TrackGround::press_cells(const Stride& stride, double elastic) {
  const double c = std::cos(stride.yaw_rad);
  const double s = std::sin(stride.yaw_rad);
  constexpr double kPerSecond = kStrideRate_hz;
  for (const std::size_t side : {0U, 1U}) {
    const double forward = kPerSecond * along(stride, side);
    const double left = kPerSecond * stride.sideways_m;
    const std::size_t footprint =
        flow_.begin_footprint(forward * c - left * s, forward * s + left * c);
    std::int64_t pressed = 0;
    for (std::size_t i = sides_.at(side); i < sides_.at(side + 1); ++i) {
      const Cell& cell = cells_[i];
      Trace& trace = traces_[cell.node];
      if (cell.pressure <= 0.0) {
        trace.step = 0;
        continue;
      }
      trace.step = step_;
      trace.covered = static_cast<float>(cell.share);
      trace.beside = static_cast<float>(cell.beside);
      flow_.cover(cell.node, cell.ix, cell.iy);
      const double now = cell.depth - cell.pressure / elastic;
      const auto units =
          static_cast<Height>(std::lround(cell.share * (now - cell.old) / kHeightUnit_m));
      if (units <= 0) continue;
      flow_.sink(cell.node, cell.ix, cell.iy, units);
      pressed += units;
    }
    flow_.push(footprint, pressed);
  }
  flow_.set_down();
  flow_.slide(kSlides);
  flow_.uncover();
  ++step_;
}

void TrackGround::step(const Stride& stride, const BearingNetwork* network) {
  find_cells(stride, last_.value_or(Stance{}));
  if (cells_.empty()) return;
  go_on(stride);
  const Bearing bearing = network != nullptr ? network->answer(look(stride)) : Bearing{};
  bear(bearing);
  Stance stance = stand(bearing);
  if (last_.has_value()) {
    // From where the last stance would have come by now.
    const double height =
        last_->height_m + last_->forward * stride.forward_m + last_->left * stride.sideways_m;
    const auto part = [&](double from, double to) { return from + bearing.follow * (to - from); };
    stance = {part(height, stance.height_m), part(last_->forward, stance.forward),
              part(last_->left, stance.left)};
  }
  press(stride, stance, elastic(bearing.press_stiffness));
}

void TrackGround::step_at(const Stride& stride, const Stance& stance) {
  find_cells(stride, stance);
  if (cells_.empty()) return;
  bear({.lift = 0.0});
  press(stride, stance, soil_.elastic_pa_per_m);
}

void TrackGround::step_evenly(const Stride& stride) {
  find_cells(stride, Stance{});
  if (cells_.empty()) return;
  const double area = 4.0 * tracks_.half_length_m * tracks_.width_m;
  const double pressure = tracks_.mass_kg * kGravity / area;
  const double depth = std::pow(pressure / bekker_, 1.0 / soil_.exponent);
  for (Cell& cell : cells_) {
    cell.depth = depth - cell.over;
    cell.pressure = cell.depth > 0.0 ? pressure : 0.0;
  }
  press_cells(stride, std::numeric_limits<double>::infinity());
}

}  // namespace screed::nn
