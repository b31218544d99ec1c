// The cells of a soil bed under a footprint: which they are, and what Bekker's law gives as a mean
// over sample points inside each.
//
// The equations of sample(), in the order of the code. n is Bekker's exponent, b the shorter side
// of the touched area (measure_patch()), E the stiffness of unloading. At a sample point whose cell
// has its undisturbed surface at `level` and had sunk by `old_sinkage` in earlier contacts
// (cell_history.h), below a body at `height` now that was as low as `passed` on its path:
//   deepest = max(0, level - passed)
//   virgin  = (k_c / b + k_phi) deepest^n                     Bekker 1969
//   stiff   = E (deepest - old_sinkage)                       reloading along E
//   loaded  = max(0, min(virgin, stiff))                      p at its deepest
//   depths  : plastic sinkage, max(old_sinkage, deepest - loaded / E)
//   now     = loaded - E (height - passed)                    unloading: it carries when > 0
//   rates   : d loaded / d sinking of the whole body: n virgin / deepest where it yields, else E
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
  // Slip-sinkage raises the exponent with the slip of the moment.
  const double exponent_index =
      std::clamp(contact.motion.slip, 0.0, 1.0) * soil_.slip_sinkage / kExponentStep;
  const PowerTable& table = tables_[static_cast<size_t>(std::lround(exponent_index))];
  // The patch of the last step decides this step's b; at the first touch the body itself does.
  const double b =
      memory.patch_b_m > 0.0 ? std::max(memory.patch_b_m, kMinPatch_m) : footprint.narrow();
  const Law law{soil_.k_phi + soil_.k_c / b, elastic, &table};

  // Unloaded soil rises by its elastic part: where the body is higher above the ground than that
  // there is no contact.
  const double rebound_m = law.bekker * table.power(memory.sinkage + kStepSinkage_m) / elastic;
  find_candidates(footprint, rebound_m);
  size_t point_count = 0;
  for (const Candidate& candidate : candidates_) point_count += sample_count(candidate.lattice);
  sample_points_.clear(point_count);
  for (const Candidate& candidate : candidates_) add_sample_points(candidate);
  // One cell of margin: contact is found cell by cell, so the path may have begun up to a cell
  // earlier.
  PathHistory path = memory.path;
  if (path.travel_m != 0.0) path.travel_m += std::copysign(spacing, path.travel_m);
  footprint.surface(spacing / samples_per_side_, path, sample_points_);
  Range range{cell_count_, cell_count_, law, 0};
  if (cells_.size() < cell_count_ + candidates_.size()) {
    cells_.resize(cell_count_ + candidates_.size());
  }
  size_t first = 0;
  for (const Candidate& candidate : candidates_) {
    if (sample(footprint, candidate, first, law, cells_[cell_count_])) ++cell_count_;
    first += sample_count(candidate.lattice);
  }
  range.end = cell_count_;
  return range;
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
      candidates_.push_back({node, ix, iy, lattice});
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
bool SoilBed::sample(const Footprint& footprint, const Candidate& candidate, size_t first,
                     const Law& law, SoilCell& cell) {
  // A single pair, as on fine grids, needs no loop.
  const size_t count = sample_count(candidate.lattice);
  return count == 2 ? sample<2>(footprint, candidate, first, count, law, cell)
                    : sample<0>(footprint, candidate, first, count, law, cell);
}

/// `static_count`: the number of sample points where the compiler knows it, else 0.
template <size_t static_count>
bool SoilBed::sample(const Footprint& footprint, const Candidate& candidate, size_t first,
                     size_t number, const Law& law, SoilCell& cell) {
  const size_t count = static_count != 0 ? static_count : number;
  const double per_count = 1.0 / static_cast<double>(count);
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const double forward_x = footprint.pose().linear()(0, 0);
  const double forward_y = footprint.pose().linear()(1, 0);
  const double reference = flow_.reference(candidate.node) * kHeightUnit_m;
  cell.sunk = reference - flow_.height(candidate.node) * kHeightUnit_m;
  double covered = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  for (size_t i = first; i < first + count; ++i) {
    covered += sample_points_.share[i];
    if (sample_points_.share[i] > 0.0) lowest = std::min(lowest, sample_points_.passed[i]);
  }
  if (lowest >= reference) return false;
  SoilCellHistory& history = histories_[candidate.node];
  const double covered_share = covered * per_count;
  if (history.is_contact_new(step_)) history.share = history.along = history.across = 0.0F;
  history.keep(covered_share, history.divide(covered_share, cell.sunk, step_));
  const double elastic = law.elastic;
  const double compliance = 1.0 / elastic;
  const double exponent = law.table->exponent();

  const Double2 zero = broadcast(0.0);
  const Double2 level = broadcast(reference);
  const Double2 bekker = broadcast(law.bekker);
  const Double2 stiffness = broadcast(elastic);
  const Double2 old_sinkage = broadcast(history.old_sinkage());
  const Double2 cx = broadcast(centre.x());
  const Double2 cy = broadcast(centre.y());
  const Double2 cz = broadcast(centre.z());
  Double2 shares = zero;
  Double2 depths = zero;
  Double2 pressures = zero;
  Double2 rates = zero;
  Double2 x_shares = zero;
  Double2 y_shares = zero;
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
    // Bekker's curve starts steeper than the soil's own stiffness when n < 1, and in a rut.
    const Double2 virgin =
        bekker * Double2{law.table->power(deepest[0]), law.table->power(deepest[1])};
    const Double2 stiff = stiffness * (deepest - old_sinkage);
    const auto yields = virgin < stiff;
    const Double2 loaded = maximum(zero, yields ? virgin : stiff);
    depths += part * maximum(old_sinkage, deepest - loaded * broadcast(compliance));
    const Double2 now = loaded - stiffness * (height - passed);
    const Double2 in_contact = over & (now > zero) ? part : zero;
    const Double2 weight = in_contact > zero ? part * now : zero;
    const Double2 x = load(&sample_points_.x[i]) - cx;
    const Double2 y = load(&sample_points_.y[i]) - cy;
    const Double2 z = height - cz;
    const Double2 slope_x = in_contact > zero ? load(&sample_points_.slope_x[i]) : zero;
    const Double2 slope_y = in_contact > zero ? load(&sample_points_.slope_y[i]) : zero;
    const Double2 wx = weight * slope_x;
    const Double2 wy = weight * slope_y;
    const Double2 arm_z = in_contact > zero ? z : zero;
    shares += in_contact;
    pressures += weight;
    rates += in_contact * (yields ? broadcast(exponent) * virgin / maximum(deepest, broadcast(1e-9))
                                  : stiffness);
    x_shares += in_contact * x;
    y_shares += in_contact * y;
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
  cell.node = candidate.node;
  cell.ix = candidate.ix;
  cell.iy = candidate.iy;
  cell.share = share * per_count;
  cell.pressed = sum(depths) * per_count + history.beside();
  cell.pressure = pressure * per_count;
  cell.rate = sum(rates) * per_count;
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
