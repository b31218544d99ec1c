// The cells of a soil bed under a footprint: which they are, and what Bekker's law gives as a mean
// over sample points inside each.
//
// The equations of sample(), in the order of the code. n is Bekker's exponent, b the shorter side
// of the touched area (measure_patch()), E the stiffness of unloading. At a sample point whose cell
// has its undisturbed surface at `level` and had sunk by `old_sinkage` in earlier contacts
// (cell_history.h), below a body at `height` now that was as low as `passed` on its path:
//   deepest = max(0, level - passed)
//   bearing = max(0, deepest - lift)                          lift of a wheel: wheel_stress.h, else
//   0 virgin  = (k_c / b + k_phi) bearing^n                     Bekker 1969 stiff   = E (bearing -
//   old_sinkage)                       reloading along E; a mean over the small
//             square that a point stands for, which reaches the floor of a rut bit by bit
//   loaded  = max(0, min(virgin, stiff))                      p at its deepest
//   depths  : plastic sinkage, the larger of old_sinkage and
//             old_sinkage + (1 - rebound) (deepest - old_sinkage) - loaded / E
//   now     = loaded - E (height - passed)                    unloading: it carries when > 0; below
//   a
//             wheel whose stress is shaped: loaded
//   rates   : d loaded / d sinking of the whole body: n virgin / bearing where it yields, else E
// A cell has the means of these, each point weighed with its `part` of the body above it; a centre
// of pressure, from points weighed with their pressure; and, for radial stress, the moment of the
// normal's horizontal parts (slope_x, slope_y) about the footprint's centre.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/terrain/double2.h"

namespace screed {
namespace {

// How much deeper a body may go in one step than in the last, for the bound on what unloaded soil
// rises, m.
constexpr double kStepSinkage_m = 0.001;
constexpr double kMinPatch_m = 1e-3;  // a narrower patch is rounding at first touch

}  // namespace

/// The cells that a footprint touches, sampled.
SoilBed::Range SoilBed::find_cells(const FootprintContact& contact, double elastic) {
  const Footprint& footprint = *contact.footprint;
  const ContactMemory& memory = *contact.memory;
  const double spacing = flow_.surface().spacing_m();
  // Slip-sinkage raises the exponent.
  const double exponent_index =
      std::min(std::abs(memory.slip), 1.0) * soil_.slip_sinkage / kExponentStep;
  const PowerTable& table = tables_[static_cast<size_t>(std::lround(exponent_index))];
  // The patch of the last step decides this step's b; at the first touch the body itself does.
  const double b =
      memory.patch_b_m > 0.0 ? std::max(memory.patch_b_m, kMinPatch_m) : footprint.narrow();
  Range range{cell_count_, cell_count_, {}, 0, footprint.run_frame(), 0.0, 0.0};
  Law& law = range.law;
  law.bekker = soil_.k_phi + soil_.k_c / b;
  law.elastic = elastic;
  law.table = &table;

  // Unloaded soil rises by its elastic part: where the body is higher above the ground than that
  // there is no contact. Behind a wheel it rises by more, and the wheel is still touching.
  double rebound_m = law.bekker * table.power(memory.sinkage + kStepSinkage_m) / elastic;
  const bool is_wheel = footprint.is_wheel();
  if (is_wheel) {
    law.rebound = soil_.exit_angle * soil_.exit_angle;
    rebound_m += law.rebound * (memory.sinkage + kStepSinkage_m);
  }
  find_candidates(footprint, rebound_m);
  size_t point_count = 0;
  for (Candidate& candidate : candidates_) {
    candidate.first = point_count;
    candidate.count = sample_count(candidate.lattice);
    point_count += candidate.count;
  }
  sample_points_.clear(point_count);
  for (const Candidate& candidate : candidates_) add_sample_points(candidate);
  // One cell of margin: contact is found cell by cell, so the path may have begun up to a cell
  // earlier.
  PathHistory path = memory.path;
  if (path.travel_m != 0.0) path.travel_m += std::copysign(spacing, path.travel_m);
  footprint.surface(spacing / samples_per_side_, path, sample_points_);
  divide_sinkage();
  if (is_wheel) law.stress = wheel_stress(contact, law);
  if (cells_.size() < cell_count_ + candidates_.size()) {
    cells_.resize(cell_count_ + candidates_.size());
  }
  for (const Candidate& candidate : candidates_) {
    if (sample(footprint, candidate, law, cells_[cell_count_])) ++cell_count_;
  }
  range.end = cell_count_;
  if (range.begin < range.end) find_extent(footprint, range);
  return range;
}

/// Of each candidate: what it has sunk, and how much of that lies below the body. Those that the
/// body does not reach down to are dropped.
void SoilBed::divide_sinkage() {
  size_t kept = 0;
  for (Candidate& candidate : candidates_) {
    double covered = 0.0;
    double lowest = std::numeric_limits<double>::infinity();
    for (size_t i = candidate.first; i < candidate.first + candidate.count; ++i) {
      covered += sample_points_.share[i];
      if (sample_points_.share[i] > 0.0) lowest = std::min(lowest, sample_points_.passed[i]);
    }
    candidate.reference = flow_.reference(candidate.node) * kHeightUnit_m;
    if (lowest >= candidate.reference) continue;
    candidate.sunk = candidate.reference - flow_.height(candidate.node) * kHeightUnit_m;
    candidate.covered = covered / static_cast<double>(candidate.count);
    candidate.division =
        histories_[candidate.node].divide(candidate.covered, candidate.sunk, step_);
    candidates_[kept++] = candidate;
  }
  candidates_.resize(kept);
}

/// The wheel's entry angle is the mean of what its sample points give: one at the angle theta whose
/// depth has grown by d has entered at acos(cos max(theta, 0) - d / r).
WheelStress SoilBed::wheel_stress(const FootprintContact& contact, Law& law) const {
  const ContactMemory& memory = *contact.memory;
  if (memory.path.travel_m == 0.0) return {};
  const Footprint& footprint = *contact.footprint;
  const Eigen::Matrix3d& axes = footprint.pose().linear();
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const double per_radius = 1.0 / footprint.radius();
  const double slant = 1.0 / std::sqrt(1.0 + memory.path.gradient * memory.path.gradient);
  const Eigen::Vector3d ahead = slant * std::copysign(1.0, memory.path.travel_m) *
                                (axes.col(0) + memory.path.gradient * axes.col(2));
  law.sine = per_radius * ahead;
  const double upright = std::sqrt(std::max(0.25, 1.0 - ahead.z() * ahead.z()));
  law.per_upright = 1.0 / upright;
  double cosine_sum = 0.0;
  double weight_sum = 0.0;
  for (const Candidate& candidate : candidates_) {
    const double floor = candidate.reference - candidate.division.old_sinkage;
    for (size_t i = candidate.first; i < candidate.first + candidate.count; ++i) {
      const double grown = floor - sample_points_.passed[i];
      if (!(sample_points_.share[i] > 0.0) || grown <= 0.0) continue;
      const double sine = std::max(0.0, (sample_points_.x[i] - centre.x()) * law.sine.x() +
                                            (sample_points_.y[i] - centre.y()) * law.sine.y() +
                                            (sample_points_.height[i] - centre.z()) * law.sine.z());
      const double cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
      const double weight = sample_points_.share[i] * grown;
      cosine_sum += weight * (cosine - grown * upright * per_radius);
      weight_sum += weight;
    }
  }
  if (weight_sum <= 0.0) return {};
  const double entry = std::acos(std::clamp(cosine_sum / weight_sum, -1.0, 1.0));
  const double rolled =
      std::min(1.0, std::abs(memory.path.travel_m) * per_radius / std::max(std::sin(entry), 0.05));
  return {soil_, footprint.radius(), entry, memory.slip, rolled};
}

/// From where to where along its contour a footprint touches.
void SoilBed::find_extent(const Footprint& footprint, Range& range) const {
  double rear = std::numeric_limits<double>::infinity();
  double front = -rear;
  const double half = 0.5 * flow_.surface().spacing_m();
  for (size_t i = range.begin; i < range.end; ++i) {
    const double ahead = cells_[i].arm.dot(range.frame.axes.col(0));
    rear = std::min(rear, ahead - half * cells_[i].share);
    front = std::max(front, ahead + half * cells_[i].share);
  }
  const RunContour& contour = range.frame.contour;
  const double end = contour.half_m + contour.radius_m;
  range.rear = contour.along(std::max(rear, -end));
  range.front = contour.along(std::min(front, end));
  const WheelStress& stress = range.law.stress;
  if (!stress.known()) return;
  // A wheel's are known more finely than the cells lie.
  const double radius = footprint.radius();
  const double to_path = radius * radius;  // of the sines' direction
  const double ahead = to_path * range.law.sine.dot(footprint.pose().linear().col(0)) / radius;
  const double up = to_path * range.law.sine.dot(footprint.pose().linear().col(2)) / radius;
  const double lowest = radius * std::atan2(up, std::abs(ahead)) * (ahead < 0.0 ? -1.0 : 1.0);
  const double sense = ahead < 0.0 ? -1.0 : 1.0;
  const double entry = lowest + sense * radius * stress.entry_rad();
  (sense > 0.0 ? range.front : range.rear) = entry;
  if (stress.shaped()) {
    (sense > 0.0 ? range.rear : range.front) = lowest + sense * radius * stress.exit_rad();
  }
}

/// The cells that a footprint may touch.
void SoilBed::find_candidates(const Footprint& footprint, double rebound_m) {
  const HeightField& field = flow_.surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d centre = footprint.pose().translation();
  // The bound by tiles of the field covers this circle.
  const double radius = footprint.radius_from_above();
  const double highest = field.max_height_within(centre.x(), centre.y(), radius) + rebound_m;
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
  candidate_points_.clear(static_cast<size_t>(ix1 - ix0 + 1) * static_cast<size_t>(iy1 - iy0 + 1));
  for (int iy = iy0; iy <= iy1; ++iy) {
    for (int ix = ix0; ix <= ix1; ++ix) candidate_points_.add(field.node_x(ix), field.node_y(iy));
  }
  // A cell turned against the body reaches further across it.
  const double edge = footprint.has_corners() ? 2.0 * spacing : footprint.projected_side(spacing);
  footprint.surface(edge, candidate_points_);
  const double rim = footprint.lowest_at_rim(spacing);
  size_t i = 0;
  for (int iy = iy0; iy <= iy1; ++iy) {
    for (int ix = ix0; ix <= ix1; ++ix, ++i) {
      const size_t node = flow_.node_on(ix, iy);
      const double highest_surface = flow_.height(node) * kHeightUnit_m + rebound_m;
      Lattice lattice = Lattice::kOnePerRowAndColumn;
      if (candidate_points_.share[i] > 0.0) {
        // The lower surface of a convex body is a convex function: it lies above its tangent plane
        // at the centre of the cell.
        const double fall =
            (std::abs(candidate_points_.slope_x[i]) + std::abs(candidate_points_.slope_y[i])) *
            0.5 * spacing;
        if (candidate_points_.height[i] - fall > highest_surface) continue;
        if (candidate_points_.share[i] < 1.0) {
          lattice = footprint.has_corners() ? Lattice::kFull : Lattice::kOnePerRowAndColumn;
        } else if (candidate_points_.flat_within[i] > 0.75 * spacing) {
          // Half a cell's diagonal is 0.71: the surface is plane over the whole cell.
          lattice = Lattice::kCentre;
        }
      } else if (rim > highest_surface) {
        continue;
      }
      candidates_.push_back({.node = node, .ix = ix, .iy = iy, .lattice = lattice});
    }
  }
}

size_t SoilBed::sample_count(Lattice lattice) const {
  const auto samples = static_cast<size_t>(samples_per_side_);
  if (lattice == Lattice::kCentre) return 2;  // the same point twice: they are taken in pairs
  return lattice == Lattice::kOnePerRowAndColumn ? samples : samples * samples;
}

void SoilBed::add_sample_points(const Candidate& candidate) {
  const HeightField& field = flow_.surface();
  const double x = field.node_x(candidate.ix);
  const double y = field.node_y(candidate.iy);
  if (candidate.lattice == Lattice::kCentre) {
    sample_points_.add(x, y);
    sample_points_.add(x, y);
    return;
  }
  if (candidate.lattice == Lattice::kFull) {
    for (const double dy : lattice_) {
      for (const double dx : lattice_) sample_points_.add(x + dx, y + dy);
    }
    return;
  }
  const bool mirror = ((candidate.ix + candidate.iy) & 1) != 0;  // every other cell mirrors them
  const double sense = mirror ? -1.0 : 1.0;
  for (size_t i = 0; i < permuted_.size(); ++i)
    sample_points_.add(x + sense * permuted_[i], y + lattice_[i]);
}

/// Means over a cell of what Bekker's law gives at a lattice of sample points in it, as if nothing
/// but earlier contacts had touched it.
bool SoilBed::sample(const Footprint& footprint, const Candidate& candidate, const Law& law,
                     SoilCell& cell) {
  // A single pair, as on fine grids, needs no loop.
  return candidate.count == 2 ? sample_points<2>(footprint, candidate, law, cell)
                              : sample_points<0>(footprint, candidate, law, cell);
}

/// `static_count`: the number of sample points where the compiler knows it, else 0.
template <size_t static_count>
bool SoilBed::sample_points(const Footprint& footprint, const Candidate& candidate, const Law& law,
                            SoilCell& cell) {
  const size_t first = candidate.first;
  const size_t count = static_count != 0 ? static_count : candidate.count;
  const double per_count = 1.0 / static_cast<double>(count);
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const double reference = candidate.reference;
  const double elastic = law.elastic;
  const double compliance = 1.0 / elastic;
  const double exponent = law.table->exponent();

  const Double2 zero = broadcast(0.0);
  const Double2 level = broadcast(reference);
  const Double2 bekker = broadcast(law.bekker);
  const Double2 stiffness = broadcast(elastic);
  const Double2 old_sinkage = broadcast(candidate.division.old_sinkage);
  const bool shaped = law.stress.shaped();
  const Double2 sine_x = broadcast(law.sine.x());
  const Double2 sine_y = broadcast(law.sine.y());
  const Double2 sine_z = broadcast(law.sine.z());
  const Double2 per_upright = broadcast(law.per_upright);
  const Double2 half_square = broadcast(0.5 * flow_.surface().spacing_m() / samples_per_side_);
  const Double2 tiny = broadcast(1e-9);
  const Double2 stays = broadcast(1.0 - law.rebound);
  const Double2 cx = broadcast(centre.x());
  const Double2 cy = broadcast(centre.y());
  const Double2 cz = broadcast(centre.z());
  Double2 shares = zero;
  Double2 depths = zero;
  Double2 pressures = zero;
  Double2 rates = zero;
  Double2 below = zero;
  Double2 tilts_x = zero;
  Double2 tilts_y = zero;
  Double2 lifts_x = zero;
  Double2 lifts_y = zero;
  Double2 arms_x = zero;
  Double2 arms_y = zero;
  Double2 arms_z = zero;
  Double2 z_lifts_x = zero;
  Double2 z_lifts_y = zero;
  Double2 twists = zero;
  for (size_t i = first; i < first + count; i += 2) {
    const Double2 part = load(&sample_points_.share[i]);
    const auto over = part > zero;
    const Double2 height = load(&sample_points_.height[i]);
    // Deepest so far: where the surface rises again, what has passed before.
    const Double2 passed = load(&sample_points_.passed[i]);
    const Double2 deepest = over ? maximum(zero, level - passed) : zero;
    const Double2 x = load(&sample_points_.x[i]) - cx;
    const Double2 y = load(&sample_points_.y[i]) - cy;
    const Double2 z = height - cz;
    // Below a wheel a point bears as one less deep.
    Double2 bearing = deepest;
    if (shaped) {
      const Double2 sine = x * sine_x + y * sine_y + z * sine_z;
      bearing = maximum(zero, deepest - law.stress.lift(sine) * per_upright);
    }
    // Bekker's curve starts steeper than the soil's own stiffness when n < 1, and in a rut.
    const Double2 virgin =
        bekker * Double2{law.table->power(bearing[0]), law.table->power(bearing[1])};
    // A sample point stands for a small square, across which the surface falls by 2 fall: from the
    // floor of a rut it takes load as its parts reach the floor.
    const Double2 fall = minimum(half_square * (magnitude(load(&sample_points_.slope_x[i])) +
                                                magnitude(load(&sample_points_.slope_y[i]))),
                                 old_sinkage);
    const Double2 softened =
        stiffness * virgin / maximum(virgin + broadcast(2.0) * fall * stiffness, tiny);
    const Double2 stiff =
        (over & (fall > zero) ? softened : stiffness) * (bearing - old_sinkage + fall);
    const auto yields = virgin < stiff;
    const Double2 loaded = maximum(zero, yields ? virgin : stiff);
    depths += part * maximum(old_sinkage, old_sinkage + stays * (deepest - old_sinkage) -
                                              loaded * broadcast(compliance));
    const Double2 now = shaped ? loaded : loaded - stiffness * (height - passed);
    const Double2 in_contact = over & (now > zero) ? part : zero;
    const Double2 weight = in_contact > zero ? part * now : zero;
    const Double2 slope_x = in_contact > zero ? load(&sample_points_.slope_x[i]) : zero;
    const Double2 slope_y = in_contact > zero ? load(&sample_points_.slope_y[i]) : zero;
    const Double2 wx = weight * slope_x;
    const Double2 wy = weight * slope_y;
    const Double2 arm_z = in_contact > zero ? z : zero;
    shares += in_contact;
    pressures += weight;
    rates += in_contact * (yields ? broadcast(exponent) * virgin / maximum(bearing, broadcast(1e-9))
                                  : (over & (fall > zero) ? softened : stiffness));
    below += in_contact * (level - (in_contact > zero ? height : level));
    tilts_x += in_contact * slope_x;
    tilts_y += in_contact * slope_y;
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
  CellHistory& history = histories_[candidate.node];
  history.keep(candidate.covered, candidate.division);
  cell.node = candidate.node;
  cell.sunk = candidate.sunk;
  cell.depth = sum(below) / share;
  cell.ix = candidate.ix;
  cell.iy = candidate.iy;
  cell.share = share * per_count;
  cell.pressed = sum(depths) * per_count + candidate.division.beside;
  cell.pressure = pressure * per_count;
  cell.rate = sum(rates) * per_count;
  cell.arm << sum(arms_x) * per_pressure, sum(arms_y) * per_pressure, sum(arms_z) * per_pressure;
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
    const SoilCell& cell = cells_[i];
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
  const double minimum =
      half_trace - std::sqrt(std::max(0.0, 0.25 * (vxx - vyy) * (vxx - vyy) + vxy * vxy));
  const double narrow = std::sqrt(std::max(0.0, minimum));
  memory.patch_b_m = footprint.round() ? 2.0 * narrow : std::sqrt(12.0) * narrow;
}

}  // namespace screed
