// Deformable soil on a grid.
#include "host_sim/soil/soil_bed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/soil/pair.h"

namespace screed {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Elastic stiffness of a long footprint that does not tilt by itself, times its area, at most,
// times dt^2 / mass: an explicit spring is stable up to 4.
constexpr double kStableStiffness = 0.3;
constexpr double kExponentStep = 0.005;  // finer than anybody knows it
// Below this speed a body does not roll into new soil, m/s.
constexpr double kRolling = 1e-3;
// How much deeper a body may go in one step than in the last, for the bound on what unloaded soil
// rises, m.
constexpr double kStepSinkage_m = 0.001;
// Moves of sliding material in one step: what is left over goes on in the next.
constexpr int64_t kSlidesPerStep = 400;
// Greatest rise of a way over itself: what drops has not driven there.
constexpr double kSteepestWay = 1.0;
constexpr double kUpright = 1e-3;  // the vertical part of a body's own vertical that counts

/// A footprint goes on by this way, world frame, m. Its rise is a mean over its own length, the
/// more recent way counting more, or that of a level way.
void go_on(const Footprint& footprint, const Eigen::Vector3d& way, bool follow_slopes,
           FootprintWay& came) {
  const Eigen::Matrix3d& axes = footprint.pose().linear();
  const double along = way.dot(axes.col(0));
  if (along * came.along_m < 0.0) came = {};
  came.along_m += along;
  if (!follow_slopes) {
    came.rise = std::abs(axes(2, 2)) > kUpright ? -axes(2, 0) / axes(2, 2) : 0.0;
    return;
  }
  const double length = footprint.half().x() + footprint.radius();
  const double share = std::abs(along) / length;
  const double most = kSteepestWay * std::abs(along);
  const double up = std::clamp(way.dot(axes.col(2)), -most, most) / length;
  came.rise = share < 1.0 ? came.rise + (along < 0.0 ? -up : up) - share * came.rise : 0.0;
}

}  // namespace

SoilBed::SoilBed(HeightField surface, const SoilParameters& soil, const SoilOptions& options)
    : soil_(soil),
      options_(options),
      flow_(std::move(surface), soil.repose_deg),
      tan_friction_(std::tan(soil.friction_deg * kDegree)) {
  check_soil(soil);
  const double spacing = flow_.surface().spacing_m();
  cell_area_ = spacing * spacing;
  // Even, so that one place in each row and column can be spread evenly.
  samples_ =
      2 * std::max(1, static_cast<int>(std::ceil(0.5 * spacing / options.sample_spacing_m - 1e-9)));
  for (int j = 0; j < samples_; ++j) {
    const double edge = spacing / samples_;
    const double first = 0.5 * (edge - spacing);
    rook_x_.push_back(first + (2 * j + 1) % (samples_ + 1) * edge);
    rook_y_.push_back(first + j * edge);
  }
  volume_before_ = flow_.surface().height_sum();
  traces_.resize(flow_.nodes());
  const auto more = static_cast<int>(std::ceil(soil.slip_sinkage / kExponentStep));
  for (int i = 0; i <= more; ++i) tables_.emplace_back(soil.exponent + i * kExponentStep);
}

VolumeBalance SoilBed::balance() const {
  return {volume_before_, flow_.surface().height_sum(), compacted_, flow_.in_hand()};
}

SoilReaction SoilBed::press(const Footprint& footprint, const FootprintMotion& motion, double dt,
                            ContactMemory& memory) {
  PressingBody body;
  body.mass_kg = motion.mass_kg;
  body.centre = footprint.pose().translation();
  body.velocity = motion.velocity;
  body.omega = motion.omega;
  SoilContact contact{&footprint, &memory, motion.surface_speed, motion.slip};
  press(body, {&contact, 1}, dt, memory.alone);
  return contact.reaction;
}

void SoilBed::press(const PressingBody& body, std::span<SoilContact> contacts, double dt,
                    BodyMemory& memory) {
  cell_count_ = 0;
  ranges_.clear();
  springs_.clear();
  const bool imposed = !std::isfinite(body.mass_kg);
  const bool tilts = !body.inverse_inertia.isZero(0.0);
  for (SoilContact& contact : contacts) {
    const Footprint& footprint = *contact.footprint;
    ContactMemory& kept = *contact.memory;
    const Eigen::Vector3d arm = footprint.pose().translation() - body.centre;
    const Eigen::Vector3d velocity = body.velocity + body.omega.cross(arm);
    go_on(footprint, velocity * dt, options_.follow_slopes, kept.came);
    double elastic = soil_.elastic_pa_per_m;
    if (footprint.extended() && !tilts && !imposed) {
      // Nobody sees this one pitch and roll: there unloading is as stiff as an explicit step bears.
      const double area = std::max(kept.patch_area_m2, cell_area_);
      elastic = std::min(elastic, kStableStiffness * body.mass_kg / (dt * dt * area));
    }
    ranges_.push_back(find_cells(contact, elastic));
    const Range& range = ranges_.back();
    if (range.begin == range.end) {
      kept = {};
      continue;
    }
    measure_patch(footprint, range.begin, kept);
    ranges_.back().footprint = flow_.begin_footprint(velocity.x(), velocity.y());
    for (size_t i = range.begin; i < range.end; ++i) {
      const Cell& cell = cells_[i];
      flow_.cover(cell.node, cell.ix, cell.iy);
      springs_.push_back({cell_area_ * (cell.pressure + elastic * (cell.pressed - cell.sunk)),
                          cell_area_ * elastic * cell.share, cell_area_ * cell.pressure,
                          cell_area_ * cell.rate, cell.arm.x() + arm.x(), cell.arm.y() + arm.y()});
    }
  }
  if (springs_.empty()) {
    memory = {};
    return;
  }
  solve_sinking(body, dt, springs_, memory);
  for (size_t i = 0; i < contacts.size(); ++i) react(ranges_[i], body, contacts[i], dt);
}

/// The cells that a footprint touches, sampled.
SoilBed::Range SoilBed::find_cells(const SoilContact& contact, double elastic) {
  const Footprint& footprint = *contact.footprint;
  const ContactMemory& memory = *contact.memory;
  const double spacing = flow_.surface().spacing_m();
  // Slip-sinkage raises the exponent with the slip of the moment.
  const double more = std::clamp(contact.slip, 0.0, 1.0) * soil_.slip_sinkage / kExponentStep;
  const PowerTable& table = tables_[static_cast<size_t>(std::lround(more))];
  // The patch of the last step decides this step's b; at the first touch the body itself does.
  const double b = memory.patch_b_m > 0.0 ? std::max(memory.patch_b_m, 1e-3) : footprint.narrow();
  const Law law{soil_.k_phi + soil_.k_c / b, elastic, &table};

  // Unloaded soil rises by its elastic part: where the body is higher above the ground than that
  // there is no contact.
  const double rise = law.bekker * table.power(memory.sinkage + kStepSinkage_m) / elastic;
  find_candidates(footprint, rise);
  size_t needed = 0;
  for (const Candidate& candidate : candidates_) needed += places_of(candidate.lattice);
  places_.clear(needed);
  for (const Candidate& candidate : candidates_) add_places(candidate);
  FootprintWay came = memory.came;
  if (came.along_m != 0.0) came.along_m += std::copysign(spacing, came.along_m);
  footprint.surface(spacing / samples_, came, places_);
  Range range{cell_count_, cell_count_, law, 0};
  if (cells_.size() < cell_count_ + candidates_.size()) {
    cells_.resize(cell_count_ + candidates_.size());
  }
  size_t first = 0;
  for (const Candidate& candidate : candidates_) {
    if (sample(footprint, candidate, first, law, cells_[cell_count_])) ++cell_count_;
    first += places_of(candidate.lattice);
  }
  range.end = cell_count_;
  return range;
}

/// The cells that a footprint may touch.
void SoilBed::find_candidates(const Footprint& footprint, double rise) {
  const HeightField& field = flow_.surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d centre = footprint.pose().translation();
  // The bound by tiles of the field covers this circle.
  const double radius = footprint.radius_from_above();
  const double highest = field.max_height_within(centre.x(), centre.y(), radius) + rise;
  candidates_.clear();
  const Eigen::Vector2d reach = footprint.reach_below(highest);
  if (reach.x() < 0.0) return;
  const auto cell_of = [&](double coordinate, double begin) {
    return static_cast<int>(std::floor((coordinate - begin) / spacing + 0.5));
  };
  int ix0 = cell_of(centre.x() - reach.x(), field.x_min());
  int ix1 = cell_of(centre.x() + reach.x(), field.x_min());
  int iy0 = cell_of(centre.y() - reach.y(), field.y_min());
  int iy1 = cell_of(centre.y() + reach.y(), field.y_min());
  if (!field.wrap()) {
    ix0 = std::max(ix0, 0);
    iy0 = std::max(iy0, 0);
    ix1 = std::min(ix1, field.nx() - 1);
    iy1 = std::min(iy1, field.ny() - 1);
  }
  if (ix1 < ix0 || iy1 < iy0) return;
  places_.clear(static_cast<size_t>(ix1 - ix0 + 1) * static_cast<size_t>(iy1 - iy0 + 1));
  for (int iy = iy0; iy <= iy1; ++iy) {
    for (int ix = ix0; ix <= ix1; ++ix) places_.add(field.node_x(ix), field.node_y(iy));
  }
  // A cell turned against the body reaches further across it.
  const double edge = footprint.has_corners() ? 2.0 * spacing : footprint.across(spacing);
  footprint.surface(edge, places_);
  const double rim = footprint.lowest_at_rim(spacing);
  size_t i = 0;
  for (int iy = iy0; iy <= iy1; ++iy) {
    for (int ix = ix0; ix <= ix1; ++ix, ++i) {
      const size_t node = flow_.node_on(ix, iy);
      const double ground = flow_.height(node) * kHeightUnit_m + rise;
      Lattice lattice = Lattice::kRook;
      if (places_.share[i] > 0.0) {
        // The lower surface of a convex body is a convex function: it lies above its tangent plane
        // at the middle of the cell.
        const double fall =
            (std::abs(places_.slope_x[i]) + std::abs(places_.slope_y[i])) * 0.5 * spacing;
        if (places_.height[i] - fall > ground) continue;
        if (places_.share[i] < 1.0) {
          lattice = footprint.has_corners() ? Lattice::kFull : Lattice::kRook;
        } else if (places_.flat_within[i] > 0.75 * spacing) {
          lattice = Lattice::kMiddle;
        }
      } else if (rim > ground) {
        continue;
      }
      candidates_.push_back({node, ix, iy, lattice});
    }
  }
}

size_t SoilBed::places_of(Lattice lattice) const {
  const auto samples = static_cast<size_t>(samples_);
  if (lattice == Lattice::kMiddle) return 2;  // the same place twice: they are taken in pairs
  return lattice == Lattice::kRook ? samples : samples * samples;
}

void SoilBed::add_places(const Candidate& candidate) {
  const HeightField& field = flow_.surface();
  const double x = field.node_x(candidate.ix);
  const double y = field.node_y(candidate.iy);
  if (candidate.lattice == Lattice::kMiddle) {
    places_.add(x, y);
    places_.add(x, y);
    return;
  }
  if (candidate.lattice == Lattice::kFull) {
    for (const double dy : rook_y_) {
      for (const double dx : rook_y_) places_.add(x + dx, y + dy);
    }
    return;
  }
  const bool mirror = ((candidate.ix + candidate.iy) & 1) != 0;  // every other cell mirrors them
  const double sense = mirror ? -1.0 : 1.0;
  for (size_t i = 0; i < rook_x_.size(); ++i) places_.add(x + sense * rook_x_[i], y + rook_y_[i]);
}

/// Where the body covers less or more of a cell than a step ago, the plastic sinkage of what it
/// covers and of the rest is told anew; their sum stays.
void SoilBed::remember_cover(Trace& trace, double covered, double sunk) const {
  double before = static_cast<double>(trace.covered);
  double beside = static_cast<double>(trace.beside);
  double old = static_cast<double>(trace.old);
  if (fresh(trace)) {
    // What was pressed in an earlier contact lies below this body, as far as it covers it.
    old = sunk / std::max({covered, before, 1e-3});
    beside = sunk - covered * old;
    trace.share = trace.along = trace.across = 0.0F;
  } else if (covered < before) {
    beside = sunk - covered * (sunk - beside) / before;
  } else if (covered > before) {
    const double rest = before < 1.0 ? beside / (1.0 - before) : 0.0;
    old = (before * old + (covered - before) * rest) / covered;
    beside -= (covered - before) * rest;
  }
  trace.covered = static_cast<float>(covered);
  trace.beside = static_cast<float>(beside);
  trace.old = static_cast<float>(old);
}

/// Means over a cell of what Bekker's law gives at a lattice of places in it, as if nothing but
/// earlier contacts had touched it.
bool SoilBed::sample(const Footprint& footprint, const Candidate& candidate, size_t first,
                     const Law& law, Cell& cell) {
  // A single pair, as on fine grids, needs no loop.
  const size_t count = places_of(candidate.lattice);
  return count == 2 ? sample<2>(footprint, candidate, first, count, law, cell)
                    : sample<0>(footprint, candidate, first, count, law, cell);
}

/// `places`: known to the compiler, or 0.
template <size_t places>
bool SoilBed::sample(const Footprint& footprint, const Candidate& candidate, size_t first,
                     size_t number, const Law& law, Cell& cell) {
  const size_t count = places != 0 ? places : number;
  const double mean = 1.0 / static_cast<double>(count);
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const double forward_x = footprint.pose().linear()(0, 0);
  const double forward_y = footprint.pose().linear()(1, 0);
  const double reference = flow_.reference(candidate.node) * kHeightUnit_m;
  cell.sunk = reference - flow_.height(candidate.node) * kHeightUnit_m;
  double covered = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t i = first; i < first + count; ++i) {
    covered += places_.share[i];
    if (places_.share[i] > 0.0) lowest = std::min(lowest, places_.passed[i]);
  }
  if (lowest >= reference) return false;
  Trace& trace = traces_[candidate.node];
  remember_cover(trace, covered * mean, cell.sunk);
  const double old = static_cast<double>(trace.old);
  const double elastic = law.elastic;
  const double compliance = 1.0 / elastic;
  const double exponent = law.table->exponent();

  const Pair zero = both(0.0);
  const Pair level = both(reference);
  const Pair bekker = both(law.bekker);
  const Pair stiffness = both(elastic);
  const Pair before = both(old);
  const Pair cx = both(centre.x());
  const Pair cy = both(centre.y());
  const Pair cz = both(centre.z());
  Pair shares = zero;
  Pair depths = zero;
  Pair pressures = zero;
  Pair rates = zero;
  Pair x_shares = zero;
  Pair y_shares = zero;
  Pair tilts_x = zero;
  Pair tilts_y = zero;
  Pair lifts_x = zero;
  Pair lifts_y = zero;
  Pair arms_x = zero;
  Pair arms_y = zero;
  Pair arms_z = zero;
  Pair z_lifts_x = zero;
  Pair z_lifts_y = zero;
  Pair twists = zero;
  for (size_t i = first; i < first + count; i += 2) {
    const Pair part = load(&places_.share[i]);
    const auto over = part > zero;
    const Pair height = load(&places_.height[i]);
    // Deepest so far: where the surface rises again, what has passed before.
    const Pair passed = load(&places_.passed[i]);
    const Pair deepest = over ? greater(zero, level - passed) : zero;
    // Bekker's curve starts steeper than the soil's own stiffness when n < 1, and in a rut.
    const Pair virgin = bekker * Pair{law.table->power(deepest[0]), law.table->power(deepest[1])};
    const Pair stiff = stiffness * (deepest - before);
    const auto yields = virgin < stiff;
    const Pair loaded = greater(zero, yields ? virgin : stiff);
    depths += part * greater(before, deepest - loaded * both(compliance));
    const Pair now = loaded - stiffness * (height - passed);
    const Pair bears = over & (now > zero) ? part : zero;
    const Pair weight = bears > zero ? part * now : zero;
    const Pair x = load(&places_.x[i]) - cx;
    const Pair y = load(&places_.y[i]) - cy;
    const Pair z = height - cz;
    const Pair slope_x = bears > zero ? load(&places_.slope_x[i]) : zero;
    const Pair slope_y = bears > zero ? load(&places_.slope_y[i]) : zero;
    const Pair wx = weight * slope_x;
    const Pair wy = weight * slope_y;
    const Pair arm_z = bears > zero ? z : zero;
    shares += bears;
    pressures += weight;
    rates += bears * (yields ? both(exponent) * virgin / greater(deepest, both(1e-9)) : stiffness);
    x_shares += bears * x;
    y_shares += bears * y;
    tilts_x += bears * slope_x;
    tilts_y += bears * slope_y;
    lifts_x += wx;
    lifts_y += wy;
    arms_x += weight * x;
    arms_y += weight * y;
    arms_z += weight * arm_z;
    z_lifts_x += arm_z * wx;
    z_lifts_y += arm_z * wy;
    twists += x * wy - y * wx;
  }
  const double share = sum(shares);
  const double pressure = sum(pressures);
  if (pressure <= 0.0) return false;
  const double per_pressure = 1.0 / pressure;
  cell.node = candidate.node;
  cell.ix = candidate.ix;
  cell.iy = candidate.iy;
  cell.share = share * mean;
  cell.pressed = sum(depths) * mean + static_cast<double>(trace.beside);
  cell.pressure = pressure * mean;
  cell.rate = sum(rates) * mean;
  cell.arm << sum(arms_x) * per_pressure, sum(arms_y) * per_pressure, sum(arms_z) * per_pressure;
  cell.lead = cell.arm.x() * forward_x + cell.arm.y() * forward_y -
              (sum(x_shares) * forward_x + sum(y_shares) * forward_y) / share;
  // Vertical stress has no horizontal part; it shears in the horizontal all the same.
  const bool radial = options_.normal_stress == NormalStress::kRadial;
  cell.tilt_x = sum(tilts_x) / share;
  cell.tilt_y = sum(tilts_y) / share;
  cell.slope_x = sum(lifts_x) * per_pressure;
  cell.slope_y = sum(lifts_y) * per_pressure;
  cell.moment << cell.arm.y(), -cell.arm.x(), 0.0;
  if (radial) {
    cell.moment += per_pressure * Eigen::Vector3d(-sum(z_lifts_y), sum(z_lifts_x), sum(twists));
  }
  return true;
}

// Second moments of the touched area: a rectangle of sides a and b has variances a^2/12 and b^2/12,
// a disc r^2/4.
void SoilBed::measure_patch(const Footprint& footprint, size_t begin, ContactMemory& memory) const {
  const double edge = flow_.surface().spacing_m();
  double area = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double own = 0.0;
  for (size_t i = begin; i < cell_count_; ++i) {
    const Cell& cell = cells_[i];
    const double cx = cell.arm.x();
    const double cy = cell.arm.y();
    area += cell.share;
    x += cell.share * cx;
    y += cell.share * cy;
    xx += cell.share * cx * cx;
    xy += cell.share * cx * cy;
    yy += cell.share * cy * cy;
    own += cell.share * cell.share;
  }
  memory.patch_area_m2 = area * cell_area_;
  // A cell spreads its share over itself.
  own *= edge * edge / 12.0;
  const double vxx = (xx + own - x * x / area) / area;
  const double vyy = (yy + own - y * y / area) / area;
  const double vxy = (xy - x * y / area) / area;
  const double half_trace = 0.5 * (vxx + vyy);
  const double smaller =
      half_trace - std::sqrt(std::max(0.0, 0.25 * (vxx - vyy) * (vxx - vyy) + vxy * vxy));
  const double narrow = std::sqrt(std::max(0.0, smaller));
  memory.patch_b_m = footprint.round() ? 2.0 * narrow : std::sqrt(12.0) * narrow;
}

void SoilBed::Digging::add(const Cell& cell, double slide_along, double slide_across,
                           double mobilised) {
  const double along = cell.arm.dot(forward);
  const double across = cell.arm.dot(side);
  share += cell.share;
  first_along += cell.share * along;
  first_across += cell.share * across;
  second_along += cell.share * along * along;
  second_across += cell.share * across * across;
  swept += cell.share * mobilised * std::hypot(slide_along, slide_across);
}

// A layer of the soil goes along with a slipping surface: slip times depth times the footprint's
// width a second. It comes from under the whole of the footprint and heaves the ground around it,
// as far as the footprint is wide.
void SoilBed::dig(const Digging& digging, const Eigen::Isometry3d& pose, double dt) {
  if (digging.share <= 0.0) return;
  const double edge = flow_.surface().spacing_m();
  const double per_share = 1.0 / digging.share;
  const double along = digging.first_along * per_share;
  const double across = digging.first_across * per_share;
  const auto half_side = [&](double second, double mean) {
    return 0.5 * std::sqrt(12.0 * std::max(0.0, second * per_share - mean * mean) + edge * edge);
  };
  DugPatch patch;
  patch.forward = digging.forward.head<2>();
  patch.centre = (pose.translation() + along * digging.forward + across * digging.side).head<2>();
  patch.half_length = half_side(digging.second_along, along);
  patch.half_width = half_side(digging.second_across, across);
  patch.band = 2.0 * std::min(patch.half_length, patch.half_width);
  const double volume =
      soil_.drag_depth_m * dt * per_share * 2.0 * digging.swept * patch.half_width;
  dig_rest_ += volume / (cell_area_ * kHeightUnit_m);
  const auto units = static_cast<int64_t>(dig_rest_);
  dig_rest_ -= static_cast<double>(units);
  // Sheared soil settles too; nothing is set down where nothing is pushed aside.
  const double lost = options_.bulldozing ? soil_.compaction : 1.0;
  compaction_rest_ += lost * static_cast<double>(units);
  const auto compacted = std::min(units, static_cast<int64_t>(compaction_rest_));
  compaction_rest_ -= static_cast<double>(compacted);
  compacted_ += flow_.dig(patch, units, compacted);
}

/// What gives way in a footprint's cells, and their forces.
void SoilBed::react(const Range& range, const PressingBody& body, SoilContact& contact, double dt) {
  contact.reaction = {};
  if (range.begin == range.end) return;
  SoilReaction reaction;  // by itself, so that the sums stay in registers
  const bool radial = options_.normal_stress == NormalStress::kRadial;
  const Eigen::Isometry3d& pose = contact.footprint->pose();
  const Eigen::Vector3d centre = pose.translation();
  const Eigen::Vector3d axle = pose.linear().col(1);
  const Eigen::Vector3d forward = pose.linear().col(0);
  const Eigen::Vector3d middle = body.velocity + body.omega.cross(centre - body.centre);
  const double speed = middle.dot(forward);
  const double per_speed = std::abs(speed) > kRolling ? 1.0 / speed : 0.0;
  const double elastic = range.law.elastic;
  const double units_per_pressure = 1.0 / (elastic * kHeightUnit_m);
  const double per_shear_modulus = 1.0 / soil_.shear_modulus_m;
  const Eigen::Vector3d level_way = axle.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d level_side = Eigen::Vector3d::UnitZ().cross(level_way);
  int64_t sunk_units = 0;
  Digging digging(level_way, level_side);

  for (size_t i = range.begin; i < range.end; ++i) {
    const Cell& cell = cells_[i];
    Trace& trace = traces_[cell.node];
    const double sinking = springs_[i].sinking;
    const double along_elastic =
        cell.pressure + elastic * (cell.pressed - cell.sunk + sinking * cell.share);
    const double pressure =
        std::max(0.0, std::min(along_elastic, cell.pressure + cell.rate * sinking));
    // What the elastic part does not explain is plastic: soil gave way.
    const auto units =
        static_cast<Height>(std::lrint((along_elastic - pressure) * units_per_pressure));
    if (pressure <= 0.0) {
      // Not touching: the next contact finds what this one left.
      trace.step = 0;
      continue;
    }
    if (units > 0) {
      flow_.sink(cell.node, cell.ix, cell.iy, units);
      sunk_units += units;
    }
    const Eigen::Vector3d velocity = middle + body.omega.cross(cell.arm);
    const double damped =
        pressure + soil_.damping_pa_s_per_m * std::max(0.0, -velocity.z()) * cell.share;

    // Forces act where the pressure is, the surface slides where it touches: two means of its
    // slope.
    const double steep = std::sqrt(1.0 + cell.slope_x * cell.slope_x + cell.slope_y * cell.slope_y);
    const Eigen::Vector3d along =
        axle.cross(Eigen::Vector3d(cell.slope_x, cell.slope_y, 1.0) / steep);
    const double per_length =
        1.0 / std::sqrt(1.0 + cell.tilt_x * cell.tilt_x + cell.tilt_y * cell.tilt_y);
    const Eigen::Vector3d face(cell.tilt_x * per_length, cell.tilt_y * per_length, per_length);
    // Forward along the surface, at right angles to the axle.
    const Eigen::Vector3d tread = axle.cross(face);
    const Eigen::Vector3d surface = velocity - contact.surface_speed * tread;
    const double slide_along = surface.dot(radial ? tread : level_way);
    const double slide_across = surface.dot(radial ? face.cross(tread) : level_side);
    // Directions in the plane in which the soil shears.
    const Eigen::Vector3d normal = radial ? Eigen::Vector3d(cell.slope_x, cell.slope_y, 1.0)
                                          : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d lengthwise = radial ? along : level_way;
    const Eigen::Vector3d sideways = radial ? normal.cross(along) / steep : level_side;

    // Shear displacement: the mean over the touching part of the cell. What has just come into
    // touch starts at zero.
    const double kept = std::min(static_cast<double>(trace.share), cell.share) / cell.share;
    const double grown = dt * 0.5 * (1.0 + kept);
    const double mean_along = static_cast<double>(trace.along) * kept + slide_along * grown;
    const double mean_across = static_cast<double>(trace.across) * kept + slide_across * grown;
    trace.step = step_;
    trace.share = static_cast<float>(cell.share);
    trace.along = static_cast<float>(mean_along);
    trace.across = static_cast<float>(mean_across);

    // Where the pressure is higher the soil has sheared for longer, by the way between the two
    // means of place.
    const double lag = -cell.lead * per_speed;
    const double j_along = mean_along + slide_along * lag;
    const double j_across = mean_across + slide_across * lag;
    const double length = std::sqrt(j_along * j_along + j_across * j_across);
    const double load = damped * cell_area_;
    Eigen::Vector3d force(0.0, 0.0, load);
    if (radial) force << load * cell.slope_x, load * cell.slope_y, load;
    Eigen::Vector3d torque = load * cell.moment;
    reaction.normal_load += load;
    if (length > 0.0) {
      const double strength = soil_.cohesion_pa * cell.share + damped * tan_friction_;
      const double mobilised = 1.0 - std::exp(-length * per_shear_modulus);
      const Eigen::Vector3d traction =
          (-strength * mobilised * cell_area_ * (radial ? steep : 1.0) / length) *
          (j_along * lengthwise + j_across * sideways);
      force += traction;
      torque += cell.arm.cross(traction);
      reaction.along_surface -= traction.dot(along);
      if (soil_.drag_depth_m > 0.0) {
        digging.add(cell, slide_along, slide_across, mobilised);
        flow_.shear(cell.node, cell.share * mobilised * std::hypot(slide_along, slide_across));
      }
    }
    reaction.force += force;
    reaction.torque += torque;
    reaction.area += cell.share * cell_area_;
    reaction.sinkage = std::max(
        reaction.sinkage, flow_.reference(cell.node) * kHeightUnit_m - (centre.z() + cell.arm.z()));
  }
  flow_.push(range.footprint, sunk_units);
  if (soil_.drag_depth_m > 0.0) dig(digging, pose, dt);
  contact.memory->sinkage = reaction.sinkage;
  contact.reaction = reaction;
}

void SoilBed::end_step() {
  const int64_t sunk = flow_.in_hand();
  if (!options_.bulldozing) {
    compacted_ += sunk;
    flow_.compact(sunk);
  } else {
    if (soil_.compaction > 0.0 && sunk > 0) {
      compaction_rest_ += soil_.compaction * static_cast<double>(sunk);
      const auto units = std::min(sunk, static_cast<int64_t>(compaction_rest_));
      compaction_rest_ -= static_cast<double>(units);
      compacted_ += units;
      flow_.compact(units);
    }
    flow_.set_down();
  }
  if (options_.avalanches) flow_.slide(kSlidesPerStep);
  slopes_left_ = options_.avalanches ? flow_.waiting() : 0;
  flow_.uncover();
  ++step_;
}

int64_t SoilBed::settle(int64_t most) {
  flow_.wake_all();
  return flow_.slide(most);
}

}  // namespace screed
