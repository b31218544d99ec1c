// Deformable soil on a grid.
#include "host_sim/soil/soil_bed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace screed {
namespace {

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kDegree = std::numbers::pi / 180.0;
// Bounds of the acceleration that everything but the soil gives a footprint, m/s^2: a guess from
// the last step, kept sane.
constexpr double kMostAcceleration = 500.0;
// Elastic stiffness of a long footprint times its area, at most, times dt^2 / mass: an explicit
// spring is stable up to 4.
constexpr double kStableStiffness = 0.3;
constexpr double kExponentStep = 0.005;
// Below this speed a body does not roll into new soil, m/s.
constexpr double kRolling = 1e-3;
// How much deeper a body may go in one step than in the last, for the bound on what unloaded soil
// rises, m.
constexpr double kStepSinkage_m = 0.001;
// Moves of sliding material in one step: what is left over goes on in the next.
constexpr int64_t kSlidesPerStep = 400;

/// Whether a corner of the cell at (x, y) lies under a body whose rim passes beside the cell's
/// middle.
bool at_rim(const Footprint& footprint, double x, double y, double spacing) {
  FootprintPoint point;
  for (const double dx : {-0.5, 0.5}) {
    for (const double dy : {-0.5, 0.5}) {
      if (footprint.at(x + dx * spacing, y + dy * spacing, spacing, point)) return true;
    }
  }
  return false;
}

}  // namespace

SoilBed::SoilBed(HeightField surface, const SoilParameters& soil, const SoilOptions& options)
    : soil_(soil),
      options_(options),
      flow_(std::move(surface), soil.repose_deg),
      table_(soil.exponent),
      tan_friction_(std::tan(soil.friction_deg * kDegree)) {
  check_soil(soil);
  const double spacing = flow_.surface().spacing_m();
  cell_area_ = spacing * spacing;
  // Even, so that one place in each row and column can be spread evenly.
  samples_ =
      2 * std::max(1, static_cast<int>(std::ceil(0.5 * spacing / options.sample_spacing_m - 1e-9)));
  volume_before_ = flow_.surface().height_sum();
  touched_.assign(flow_.nodes(), 0);
  shear_along_.assign(flow_.nodes(), 0.0F);
  shear_across_.assign(flow_.nodes(), 0.0F);
  share_.assign(flow_.nodes(), 0.0F);
}

VolumeBalance SoilBed::balance() const {
  return {volume_before_, flow_.surface().height_sum(), compacted_, flow_.in_hand()};
}

// Means over a cell of what Bekker's law gives at a lattice of places in it, as if the soil had
// been untouched before this contact.
bool SoilBed::sample(const Footprint& footprint, int ix, int iy, const PressureTable& table,
                     const Law& law, double travel, Lattice lattice, Cell& cell) const {
  const double bekker = law.bekker;
  const double elastic = law.elastic;
  const HeightField& field = flow_.surface();
  const double spacing = field.spacing_m();
  const double x = field.node_x(ix);
  const double y = field.node_y(iy);
  const double reference = flow_.reference(cell.node) * kHeightUnit_m;
  const double compliance = 1.0 / elastic;
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const Eigen::Vector3d forward = footprint.pose().linear().col(0);
  const bool radial = options_.normal_stress == NormalStress::kRadial;

  cell.share = cell.pressed = cell.pressure = cell.rate = 0.0;
  double lead = 0.0;
  cell.lift.setZero();
  cell.moment.setZero();
  cell.arm.setZero();
  cell.normal.setZero();
  FootprintPoint point;
  const int rows = lattice == Lattice::kMiddle ? 1 : samples_;
  const int columns = lattice == Lattice::kFull ? samples_ : 1;
  const double edge = spacing / rows;
  const bool mirror = ((ix + iy) & 1) != 0;  // every other cell mirrors the rook's places
  for (int j = 0; j < rows; ++j) {
    const double py = y + (j + 0.5) * edge - 0.5 * spacing;
    const int rook = lattice == Lattice::kRook ? (2 * j + 1) % (samples_ + 1) : 0;
    for (int k = 0; k < columns; ++k) {
      const int i = lattice == Lattice::kFull ? k : (mirror ? rows - 1 - rook : rook);
      const double px = x + (i + 0.5) * edge - 0.5 * spacing;
      if (!footprint.at(px, py, edge, point)) continue;
      const double depth = reference - point.height;
      // Deepest so far: where the surface rises again, what has passed before, if it came from
      // there.
      double lowest = point.height;
      if (std::abs((px - centre.x()) * forward.x() + (py - centre.y()) * forward.y()) <=
          std::abs(travel) + spacing) {
        lowest =
            travel > 0.0 ? point.passed_forward : (travel < 0.0 ? point.passed_backward : lowest);
      }
      const double deepest = reference - lowest;
      if (deepest <= 0.0) continue;
      // Bekker's curve starts steeper than the soil's own stiffness when n < 1.
      const double loaded = std::min(bekker * table.power(deepest), elastic * deepest);
      cell.pressed += point.share * std::max(0.0, deepest - loaded * compliance);
      const double now = loaded - elastic * (deepest - depth);
      if (now <= 0.0) continue;
      const double weight = point.share * now;
      const Eigen::Vector3d arm(px - centre.x(), py - centre.y(), point.height - centre.z());
      const Eigen::Vector3d lift = radial
                                       ? Eigen::Vector3d(weight / point.normal.z() * point.normal)
                                       : Eigen::Vector3d(0.0, 0.0, weight);
      cell.share += point.share;
      lead += point.share * (arm.x() * forward.x() + arm.y() * forward.y());
      cell.pressure += weight;
      cell.rate += point.share * loaded / deepest;
      cell.lift += lift;
      cell.moment += arm.cross(lift);
      cell.arm += weight * arm;
      cell.normal += weight * point.normal;
    }
  }
  if (cell.pressure <= 0.0) return false;
  cell.arm /= cell.pressure;
  cell.lead = cell.arm.head<2>().dot(forward.head<2>()) - lead / cell.share;
  cell.normal.normalize();
  const double mean = 1.0 / (rows * columns);
  cell.share *= mean;
  cell.pressed *= mean;
  cell.pressure *= mean;
  cell.rate *= mean * table.exponent();
  cell.lift *= mean;
  cell.moment *= mean;
  return true;
}

// Second moments of the touched area: a rectangle of sides a and b has variances a^2/12 and b^2/12,
// a disc r^2/4.
void SoilBed::measure_patch(const Footprint& footprint, double edge, ContactMemory& memory) const {
  double area = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Cell& cell : cells_) {
    area += cell.share;
    mean += cell.share * cell.arm.head<2>();
  }
  memory.patch_area_m2 = area * cell_area_;
  if (area <= 0.0) return;
  mean /= area;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Cell& cell : cells_) {
    const Eigen::Vector2d offset = cell.arm.head<2>() - mean;
    // A cell spreads its share over itself.
    spread += cell.share * (offset * offset.transpose() +
                            edge * edge * cell.share / 12.0 * Eigen::Matrix2d::Identity());
  }
  spread /= area;
  const double half_trace = 0.5 * spread.trace();
  const double smaller =
      half_trace - std::sqrt(std::max(0.0, half_trace * half_trace - spread.determinant()));
  const double narrow = std::sqrt(std::max(0.0, smaller));
  memory.patch_b_m = footprint.round() ? 2.0 * narrow : std::sqrt(12.0) * narrow;
}

// Pressure of a cell when the body has sunk by `sinking` more: that of virgin soil, or less where
// the soil was pressed before.
double SoilBed::pressure_after(const Cell& cell, const Law& law, double sinking) {
  const double elastic =
      cell.pressure + law.elastic * (cell.pressed - cell.sunk + sinking * cell.share);
  const double virgin = cell.pressure + cell.rate * sinking;
  return std::max(0.0, std::min(elastic, virgin));
}

// The way that the body sinks in this step: end of step implicit, m (x - v dt) / dt^2 = external
// force - soil's force after x. The soil's side rises with x, so Newton's steps inside a shrinking
// bracket find it. Without it unloading, some hundred times stiffer than loading, would chatter or
// would have to be softened.
double SoilBed::solve_sinking(const FootprintMotion& motion, const ContactMemory& memory,
                              const Law& law, double dt) const {
  if (!std::isfinite(motion.mass_kg)) return 0.0;
  const double inertia = motion.mass_kg / (dt * dt);
  const double speed = -motion.velocity.z();
  // What pushes the body down besides the soil, as the last step showed it.
  double external = kGravity;
  if (memory.touching) {
    const double acceleration =
        (motion.velocity.z() - memory.velocity_z) / dt - memory.force_z / motion.mass_kg;
    external = std::clamp(-acceleration, -kMostAcceleration, kMostAcceleration);
  }
  const double free = speed * dt + external * dt * dt;
  const auto residual = [&](double sinking, double& slope) {
    double force = inertia * (sinking - free);
    slope = inertia;
    for (const Cell& cell : cells_) {
      const double elastic =
          cell.pressure + law.elastic * (cell.pressed - cell.sunk + sinking * cell.share);
      const double virgin = cell.pressure + cell.rate * sinking;
      if (elastic <= 0.0 || virgin <= 0.0) continue;
      force += cell_area_ * std::min(elastic, virgin);
      slope += cell_area_ * (elastic < virgin ? law.elastic * cell.share : cell.rate);
    }
    return force;
  };
  // The soil only pushes up: the body sinks at most as far as it would without soil.
  double high = free;
  double low = -std::abs(free) - 1e-3;
  double slope = 0.0;
  while (residual(low, slope) > 0.0) low *= 4.0;
  double sinking = std::clamp(0.0, low, high);
  for (int i = 0; i < 40; ++i) {
    const double force = residual(sinking, slope);
    (force > 0.0 ? high : low) = sinking;
    double next = sinking - force / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - sinking) < 1e-11) return next;
    sinking = next;
  }
  return sinking;
}

// A slipping surface takes a layer of soil along: what leaves a cell enters the next one, so that
// the belt carries soil from its front to its end, where it stays.
void SoilBed::drag(const Cell& cell, double way_x, double way_y) {
  const double units_per_way = soil_.drag_depth_m / flow_.surface().spacing_m() / kHeightUnit_m;
  const auto carry = [&](double way, int dx, int dy) {
    const auto units = static_cast<Height>(std::abs(way) * units_per_way);
    const int64_t to =
        flow_.node_at(cell.ix + (way > 0.0 ? dx : -dx), cell.iy + (way > 0.0 ? dy : -dy));
    if (units > 0 && to >= 0) flow_.move(cell.node, static_cast<size_t>(to), units);
  };
  carry(way_x, 1, 0);
  carry(way_y, 0, 1);
}

SoilReaction SoilBed::press(const Footprint& footprint, const FootprintMotion& motion, double dt,
                            ContactMemory& memory) {
  SoilReaction reaction;
  const HeightField& field = flow_.surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d centre = footprint.pose().translation();
  const Eigen::Vector2d reach = footprint.reach();
  const auto cell_of = [&](double coordinate, double begin) {
    return static_cast<int>(std::floor((coordinate - begin) / spacing + 0.5));
  };
  const int ix0 = cell_of(centre.x() - reach.x(), field.x_min());
  const int ix1 = cell_of(centre.x() + reach.x(), field.x_min());
  const int iy0 = cell_of(centre.y() - reach.y(), field.y_min());
  const int iy1 = cell_of(centre.y() + reach.y(), field.y_min());

  // Slip-sinkage raises the exponent with the slip of the moment; steps of 0.005 are finer than
  // anybody knows it.
  const bool slips = soil_.slip_sinkage > 0.0 && motion.slip > 0.0;
  if (slips) {
    const double exponent =
        std::round((soil_.exponent + soil_.slip_sinkage * motion.slip) / kExponentStep) *
        kExponentStep;
    if (exponent != slipping_.exponent()) slipping_.set_exponent(exponent);
  }
  const PressureTable& table = slips ? slipping_ : table_;

  const double speed = motion.velocity.dot(footprint.pose().linear().col(0));
  if (speed * memory.travel_m < 0.0) memory.travel_m = 0.0;
  memory.travel_m += speed * dt;
  // The patch of the last step decides this step's b; at the first touch the body itself does.
  const double b = memory.patch_b_m > 0.0 ? std::max(memory.patch_b_m, 1e-3) : footprint.narrow();
  Law law;
  law.bekker = soil_.k_phi + soil_.k_c / b;
  law.elastic = soil_.elastic_pa_per_m;
  if (footprint.extended() && std::isfinite(motion.mass_kg)) {
    // solve_sinking() cannot see a long footprint pitch and roll: there unloading is as stiff as an
    // explicit step bears.
    const double area = std::max(memory.patch_area_m2, cell_area_);
    law.elastic = std::min(law.elastic, kStableStiffness * motion.mass_kg / (dt * dt * area));
  }

  // Unloaded soil rises by its elastic part: where the body is higher above the ground than that
  // there is no contact.
  const double rise = law.bekker * table.power(memory.sinkage + kStepSinkage_m) / law.elastic;

  cells_.clear();
  FootprintPoint point;
  for (int iy = iy0; iy <= iy1; ++iy) {
    for (int ix = ix0; ix <= ix1; ++ix) {
      const int64_t node = flow_.node_at(ix, iy);
      if (node < 0) continue;
      Cell cell;
      cell.node = static_cast<size_t>(node);
      cell.ix = ix;
      cell.iy = iy;
      // The lower surface of a convex body is a convex function: it lies above its tangent plane at
      // the middle of the cell.
      Lattice lattice = Lattice::kRook;
      if (footprint.at(field.node_x(ix), field.node_y(iy), 2.0 * spacing, point)) {
        const double fall = (std::abs(point.normal.x()) + std::abs(point.normal.y())) /
                            point.normal.z() * 0.5 * spacing;
        if (point.height - fall > flow_.height(cell.node) * kHeightUnit_m + rise) continue;
        if (point.share < 1.0) {
          lattice = footprint.has_corners() ? Lattice::kFull : Lattice::kRook;
        } else if (point.flat_within > 0.75 * spacing) {
          lattice = Lattice::kMiddle;
        }
      } else if (!at_rim(footprint, field.node_x(ix), field.node_y(iy), spacing)) {
        continue;
      }
      if (!sample(footprint, ix, iy, table, law, memory.travel_m, lattice, cell)) continue;
      cell.sunk = (flow_.reference(cell.node) - flow_.height(cell.node)) * kHeightUnit_m;
      cells_.push_back(cell);
      flow_.cover(ix, iy);
    }
  }
  if (cells_.empty()) {
    memory = {};
    return reaction;
  }
  measure_patch(footprint, spacing, memory);
  const double sinking = solve_sinking(motion, memory, law, dt);
  const bool radial = options_.normal_stress == NormalStress::kRadial;
  const Eigen::Vector3d vertical = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d axle = footprint.pose().linear().col(1);

  for (const Cell& cell : cells_) {
    const size_t node = cell.node;
    const double pressure = pressure_after(cell, law, sinking);
    const Eigen::Vector3d velocity = motion.velocity + motion.omega.cross(cell.arm);
    // What the elastic part does not explain is plastic: virgin soil gave way.
    const double plastic =
        cell.pressed - cell.sunk + sinking * cell.share - (pressure - cell.pressure) / law.elastic;
    const auto units = static_cast<Height>(std::lround(plastic / kHeightUnit_m));
    if (pressure > 0.0 && units > 0) flow_.sink(node, units);
    if (pressure <= 0.0) {
      touched_[node] = 0;
      continue;
    }
    const double damped =
        pressure + soil_.damping_pa_s_per_m * std::max(0.0, -velocity.z()) * cell.share;

    const Eigen::Vector3d along =
        axle.cross(cell.normal);  // forward along the surface, at right angles to the axle
    const Eigen::Vector3d surface = velocity - motion.surface_speed * along;
    const Eigen::Vector3d& normal =
        radial ? cell.normal : vertical;  // of the plane in which the soil shears
    const Eigen::Vector3d lengthwise = axle.cross(normal).normalized();
    const Eigen::Vector3d sideways = normal.cross(lengthwise);

    // Shear displacement: the mean over the touching part of the cell. What has just come into
    // touch starts at zero.
    const bool fresh = touched_[node] == 0 || touched_[node] + 1 < step_;
    const double kept =
        fresh ? 0.0 : std::min(static_cast<double>(share_[node]), cell.share) / cell.share;
    const double grown = dt * 0.5 * (1.0 + kept);
    const double slide_along = surface.dot(lengthwise);
    const double slide_across = surface.dot(sideways);
    const double mean_along = static_cast<double>(shear_along_[node]) * kept + slide_along * grown;
    const double mean_across =
        static_cast<double>(shear_across_[node]) * kept + slide_across * grown;
    touched_[node] = step_;
    share_[node] = static_cast<float>(cell.share);
    shear_along_[node] = static_cast<float>(mean_along);
    shear_across_[node] = static_cast<float>(mean_across);

    // Where the pressure is higher the soil has sheared for longer, by the way between the two
    // means of place.
    const double lag = std::abs(speed) > kRolling ? -cell.lead / speed : 0.0;
    const Eigen::Vector3d shear = (mean_along + slide_along * lag) * lengthwise +
                                  (mean_across + slide_across * lag) * sideways;
    const double length = shear.norm();
    Eigen::Vector3d force = (damped / cell.pressure * cell_area_) * cell.lift;
    Eigen::Vector3d torque = (damped / cell.pressure * cell_area_) * cell.moment;
    reaction.normal_load += force.z();
    if (length > 0.0) {
      const double strength = soil_.cohesion_pa * cell.share + damped * tan_friction_;
      const double mobilised = 1.0 - std::exp(-length / soil_.shear_modulus_m);
      const double tau = strength * mobilised;
      const Eigen::Vector3d traction = (-tau * cell_area_ / normal.z() / length) * shear;
      force += traction;
      torque += cell.arm.cross(traction);
      reaction.along_surface -= traction.dot(along);
      if (soil_.drag_depth_m > 0.0) {
        const Eigen::Vector3d way =
            (slide_along * lengthwise + slide_across * sideways) * (dt * mobilised * cell.share);
        drag(cell, way.x(), way.y());
      }
    }
    reaction.force += force;
    reaction.torque += torque;
    reaction.area += cell.share * cell_area_;
    reaction.sinkage = std::max(
        reaction.sinkage, flow_.reference(node) * kHeightUnit_m - (centre.z() + cell.arm.z()));
  }
  memory.touching = true;
  memory.sinkage = reaction.sinkage;
  memory.velocity_z = motion.velocity.z();
  memory.force_z = reaction.force.z();
  return reaction;
}

void SoilBed::end_step() {
  const int64_t sunk = flow_.in_hand();
  if (!options_.bulldozing) {
    compacted_ += sunk;
    flow_.take_from_hand(sunk);
  } else {
    if (soil_.compaction > 0.0 && sunk > 0) {
      compaction_rest_ += soil_.compaction * static_cast<double>(sunk);
      const auto units = std::min(sunk, static_cast<int64_t>(compaction_rest_));
      compaction_rest_ -= static_cast<double>(units);
      compacted_ += units;
      flow_.take_from_hand(units);
    }
    flow_.set_down();
  }
  if (options_.avalanches) flow_.slide(kSlidesPerStep);
  flow_.uncover();
  ++step_;
}

int64_t SoilBed::settle(int64_t most) {
  flow_.wake_all();
  return flow_.slide(most);
}

}  // namespace screed
