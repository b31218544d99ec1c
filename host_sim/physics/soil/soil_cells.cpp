// The cells of a soil bed under a footprint: which they are, and what Bekker's law gives as a mean
// over sample points inside each.
//
// The equations of kernels/cell_stress.inc, in the order of its code. n is Bekker's exponent, b the
// shorter side of the touched area (measure_patch()), E the stiffness of unloading. At a sample
// point whose cell has its undisturbed surface at `level` and had sunk by `old_sinkage` in earlier
// contacts (soil_grid.h), below a body at `height` now that was as low as `passed` on its path:
//   deepest = max(0, level - passed)
//   bearing = max(0, deepest - lift)        lift below a wheel: soil_laws.h; else 0
//   virgin  = (k_c / b + k_phi) bearing^n   Bekker 1969
//   stiff   = E (bearing - old_sinkage)     reloading along E; a mean over the small square that a
//                                           point stands for, which reaches the floor of a rut bit
//                                           by bit
//   loaded  = max(0, min(virgin, stiff))    p at its deepest
//   depths  = max(old_sinkage, old_sinkage + (1 - rebound) (deepest - old_sinkage) - loaded / E)
//                                           plastic sinkage
//   now     = loaded - E (height - passed)  unloading: it carries when > 0. Below a wheel whose
//                                           stress is shaped: loaded
//   rates   = n virgin / bearing            where it yields, else E: d loaded / d sinking
//   unload  = E; below a wheel whose stress is shaped, whose soil comes up with it by
//             rise = rebound / (1 - rebound) (pressed - old_sinkage):   now / (rise + now / E)
// A cell has the means of these, each point weighed with its `part` of the body above it; a centre
// of pressure, from points weighed with their pressure; and, for radial stress, the moment of the
// normal's horizontal parts (slope_x, slope_y) about the footprint's centre.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/triple.h"
#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// How much deeper a body may go in one step than in the last, for the bound on what unloaded soil
// rises, m.
constexpr double kStepSinkage_m = 0.001;
constexpr double kMinPatch_m = 1e-3;  // a narrower patch is rounding at first touch
// Of a plane around a cell's centre, in cells: half a cell's diagonal is 0.71.
constexpr double kFlatWithin = 0.75;

}  // namespace

SoilBed::Law SoilBed::law_below(const FootprintContact& contact, const RunFrame& frame,
                                double elastic, double dt) const {
  const Footprint& footprint = *contact.footprint;
  const ContactMemory& memory = *contact.memory;
  // The patch of the last step decides this step's b; at the first touch the body itself does.
  const double b =
      memory.patch_b_m > 0.0 ? std::max(memory.patch_b_m, kMinPatch_m) : footprint.narrow();
  Law law;
  law.cell.bekker = bekker_modulus(soil_, b);
  law.cell.elastic = elastic;
  law.cell.exponent = power_.exponent();
  law.cell.power = power_.lines();
  law.cell.rebound = footprint.is_wheel() ? soil_.exit_angle * soil_.exit_angle : 0.0;
  law.cell.half_square = 0.5 * surface().spacing_m() / samples_per_side_;
  law.cell.cell_area = cell_area_;
  law.cell.edge = surface().spacing_m();
  law.cell.damper = soil_.damping_pa_s_per_m / dt;
  law.cell.radial = options_.normal_stress == NormalStress::kRadial;
  law.cell.centre = triple(footprint.pose().translation());
  law.cell.axis_x = triple(frame.axes.col(0));
  law.cell.body_to = triple(contact.arm);
  return law;
}

/// The cells that a footprint touches, sampled.
SoilBed::Range SoilBed::find_cells(const FootprintContact& contact, double elastic, double dt) {
  const Footprint& footprint = *contact.footprint;
  ContactMemory& memory = *contact.memory;
  const double spacing = surface().spacing_m();
  Range range;
  range.begin = range.end = blocks_;
  range.frame = footprint.run_frame();
  range.law = law_below(contact, range.frame, elastic, dt);
  CellLaw& law = range.law.cell;

  // Unloaded soil rises by its elastic part: where the body is higher above the ground than that
  // there is no contact. Behind a wheel it rises by more, and the wheel is still touching.
  const double deepest = memory.sinkage + kStepSinkage_m;
  const double rebound_m = law.bekker * power_.power(deepest) / elastic + law.rebound * deepest;
  // One cell of margin: contact is found cell by cell, so the path may have begun up to a cell
  // earlier.
  PathHistory path = memory.path;
  if (path.travel_m != 0.0) path.travel_m += std::copysign(spacing, path.travel_m);
  find_candidates(footprint, path, rebound_m);
  lay_out_cells();
  if (groups_.empty()) return range;
  sample_surface(footprint, path);
  const auto each_group = [&](const auto& kernel) {
    for (const Group& group : groups_) {
      kernel(group, sample_points_.points(group.first_point), lattices_[group.lattice].x.size());
    }
  };
  each_group([&](const Group& group, const SurfacePoints& samples, size_t points) {
    kernels_.divide_cells(&cells_[group.begin], group.blocks, samples, points);
  });
  if (footprint.is_wheel()) {
    range.law.stress = wheel_stress(contact, range.law);
    law.stress = range.law.stress.shape();
  }
  CellSums sums;
  sums.rear = std::numeric_limits<double>::infinity();
  sums.front = -sums.rear;
  each_group([&](const Group& group, const SurfacePoints& samples, size_t points) {
    kernels_.sample_cells(&cells_[group.begin], group.blocks, samples, points, law,
                          &springs_[group.begin], sums);
  });
  if (!(sums.area > 0.0)) {
    blocks_ = range.begin;
    return range;
  }
  range.touching = true;
  range.end = blocks_;
  find_extent(footprint, sums, range);
  measure_patch(footprint, sums, memory);
  return range;
}

/// The wheel's entry angle is the mean of what its sample points give: one at the angle theta whose
/// depth has grown by d has entered at acos(cos max(theta, 0) - d / r). What lies free behind the
/// wheel is its rut, come up again, and tells nothing.
WheelStress SoilBed::wheel_stress(const FootprintContact& contact, Law& law) {
  const ContactMemory& memory = *contact.memory;
  if (memory.path.travel_m == 0.0) return {};
  const Footprint& footprint = *contact.footprint;
  const Eigen::Matrix3d& axes = footprint.pose().linear();
  const double per_radius = 1.0 / footprint.radius();
  const double slant = 1.0 / std::sqrt(1.0 + memory.path.gradient * memory.path.gradient);
  const Eigen::Vector3d ahead = slant * std::copysign(1.0, memory.path.travel_m) *
                                (axes.col(0) + memory.path.gradient * axes.col(2));
  law.cell.sine = triple(per_radius * ahead);
  law.cell.per_upright = 1.0 / std::sqrt(std::max(0.25, 1.0 - ahead.z() * ahead.z()));
  EntrySums sums;
  for (const Group& group : groups_) {
    kernels_.entry_angle(&cells_[group.begin], group.blocks,
                         sample_points_.points(group.first_point),
                         lattices_[group.lattice].x.size(), law.cell, per_radius, sums);
  }
  if (sums.weight <= 0.0) return {};
  const double entry = portable::acos(std::clamp(sums.cosine / sums.weight, -1.0, 1.0));
  const double rolled = std::min(
      1.0, std::abs(memory.path.travel_m) * per_radius / std::max(portable::sin(entry), 0.05));
  return {soil_, footprint.radius(), entry, memory.slip, rolled};
}

/// From where to where along its contour a footprint touches.
void SoilBed::find_extent(const Footprint& footprint, const CellSums& sums, Range& range) const {
  const RunContour& contour = range.frame.contour;
  const double end = contour.half_m + contour.radius_m;
  range.rear = contour.along(std::max(sums.rear, -end));
  range.front = contour.along(std::min(sums.front, end));
  const WheelStress& stress = range.law.stress;
  if (!stress.known()) return;
  // A wheel's are known more finely than the cells lie.
  const double radius = footprint.radius();
  const Eigen::Vector3d to_path = radius * vector(range.law.cell.sine);
  const double ahead = to_path.dot(footprint.pose().linear().col(0));
  const double up = to_path.dot(footprint.pose().linear().col(2));
  const double sense = ahead < 0.0 ? -1.0 : 1.0;
  const double lowest = sense * radius * portable::atan2(up, std::abs(ahead));
  const double entry = lowest + sense * radius * stress.entry_rad();
  (sense > 0.0 ? range.front : range.rear) = entry;
  if (stress.shaped()) {
    (sense > 0.0 ? range.rear : range.front) = lowest + sense * radius * stress.exit_rad();
  }
}

/// The runs of cells that may lie below a level, from the rectangle that holds the footprint seen
/// from above. False: there are none.
bool SoilBed::find_runs(const Footprint& footprint, double highest) {
  const HeightField& field = surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d& centre = footprint.pose().translation();
  runs_.clear();
  const Eigen::Vector2d forward = footprint.pose().linear().col(0).head<2>();
  const double level = forward.norm();
  const Eigen::Vector2d d =
      level > 0.0 ? Eigen::Vector2d(forward / level) : Eigen::Vector2d::UnitX();
  const double reach_along = footprint.reach_below(highest, d);
  if (reach_along < 0.0) return false;
  const double reach_across = footprint.reach_below(highest, {-d.y(), d.x()});
  // Of the cells' centres. Cells are squares along the axes: half of their extent along the
  // rectangle's sides comes on top.
  const double half_cell = 0.5 * spacing * (std::abs(d.x()) + std::abs(d.y()));
  const double along = reach_along + half_cell;
  const double across = reach_across + half_cell;
  const double reach_x = footprint.reach_below(highest, Eigen::Vector2d::UnitX()) + 0.5 * spacing;
  const double reach_y = footprint.reach_below(highest, Eigen::Vector2d::UnitY()) + 0.5 * spacing;
  const double per_spacing = 1.0 / spacing;
  // By the whole part: SSE2, which all processors have, knows no ceil and floor.
  const auto first_in = [&](double low, double begin) {
    const double nodes = (low - begin) * per_spacing;
    return static_cast<int>(nodes) + (nodes > static_cast<int>(nodes) ? 1 : 0);
  };
  const auto last_in = [&](double high, double begin) {
    const double nodes = (high - begin) * per_spacing;
    return static_cast<int>(nodes) - (nodes < static_cast<int>(nodes) ? 1 : 0);
  };
  int iy0 = first_in(centre.y() - reach_y, field.y_min());
  int iy1 = last_in(centre.y() + reach_y, field.y_min());
  if (!field.wrap()) {
    iy0 = std::max(iy0, 0);
    iy1 = std::min(iy1, field.ny() - 1);
  }
  const auto rows = static_cast<size_t>(std::max(0, iy1 - iy0 + 1));
  // A row that crosses the seam is two.
  if (runs_.capacity() < 2 * rows) runs_.reserve(4 * rows);
  // |u d_x + v d_y| <= along, |v d_x - u d_y| <= across
  constexpr double kParallel = 1e-6;
  const bool limits_along = std::abs(d.x()) > kParallel;
  const bool limits_across = std::abs(d.y()) > kParallel;
  const double per_dx = limits_along ? 1.0 / d.x() : 0.0;
  const double per_dy = limits_across ? 1.0 / d.y() : 0.0;
  for (int iy = iy0; iy <= iy1; ++iy) {
    const double v = field.node_y(iy) - centre.y();
    double low = -reach_x;
    double high = reach_x;
    if (limits_along) {
      const double middle = -v * d.y() * per_dx;
      const double half = along * std::abs(per_dx);
      low = std::max(low, middle - half);
      high = std::min(high, middle + half);
    }
    if (limits_across) {
      const double middle = v * d.x() * per_dy;
      const double half = across * std::abs(per_dy);
      low = std::max(low, middle - half);
      high = std::min(high, middle + half);
    }
    int ix0 = first_in(centre.x() + low, field.x_min());
    int ix1 = last_in(centre.x() + high, field.x_min());
    if (!field.wrap()) {
      ix0 = std::max(ix0, 0);
      ix1 = std::min(ix1, field.nx() - 1);
    }
    flow_.grid().each_run(iy, ix0, ix1 + 1, [&](size_t node, int ix, size_t count) {
      runs_.push_back({{node, ix, iy}, count});
    });
  }
  return !runs_.empty();
}

/// Cuts runs down to what reaches up to the plane below a box or disc: mostly nothing, below a
/// hull.
void SoilBed::drop_cells_below(const Footprint& footprint, double rebound_m) {
  const Eigen::Vector3d plane = footprint.plane_below();
  if (!std::isfinite(plane.x())) return;
  const HeightField& field = surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const double fall = 0.5 * spacing * (std::abs(plane.y()) + std::abs(plane.z()));
  size_t kept = 0;
  for (const CellRun& run : runs_) {
    const double z = centre.z() + plane.x() +
                     plane.y() * (field.node_x(run.first.ix) - centre.x()) +
                     plane.z() * (field.node_y(run.first.iy) - centre.y()) - fall - rebound_m;
    const AboveLine above = kernels_.above_line(field.heights() + run.first.node, run.count,
                                                kHeightUnit_m, z, plane.y() * spacing);
    if (above.first < above.end) {
      runs_[kept++] = {run.first.eastward(above.first), above.end - above.first};
    }
  }
  runs_.resize(kept);
}

/// With how many sample points a cell below a body with corners is looked at.
SoilBed::Lattice SoilBed::lattice_of_corner(size_t candidate, double highest_surface,
                                            double rim) const {
  const FootprintSamples& points = candidate_points_;
  const double spacing = surface().spacing_m();
  if (!(points.share[candidate] > 0.0)) return rim > highest_surface ? kNone : kOnePerRowAndColumn;
  const double fall =
      (std::abs(points.slope_x[candidate]) + std::abs(points.slope_y[candidate])) * 0.5 * spacing;
  if (points.height[candidate] - fall > highest_surface) return kNone;
  if (points.share[candidate] < 1.0) return kFull;
  return points.flat_within[candidate] > kFlatWithin * spacing ? kCentre : kOnePerRowAndColumn;
}

/// Sorts the cells of runs_ by the lattice that they are looked at with.
void SoilBed::classify(const Footprint& footprint, double rebound_m) {
  const double spacing = surface().spacing_m();
  const double rim = footprint.lowest_at_rim(spacing);
  const size_t count = candidate_points_.count;
  if (footprint.has_corners()) {
    size_t i = 0;
    for (const CellRun& run : runs_) {
      for (size_t k = 0; k < run.count; ++k, ++i) {
        const Lattice lattice =
            lattice_of_corner(i, candidate_heights_[i] * kHeightUnit_m + rebound_m, rim);
        if (lattice == kNone) continue;
        candidates_[lattice].push_back({run.first.eastward(k), static_cast<uint32_t>(i)});
      }
    }
    return;
  }
  // A cell that both sides of a narrow belt cross is sampled, too.
  const bool is_wide = 2.0 * footprint.half().y() > footprint.projected_side(spacing);
  const double flat_within =
      is_wide ? kFlatWithin * spacing : std::numeric_limits<double>::infinity();
  const ClassifyLimits limits{kHeightUnit_m, rebound_m, rim, 0.5 * spacing, flat_within};
  kernels_.classify(candidate_points_.points(), candidate_heights_.data(), count, limits,
                    flat_bits_.data(), curved_bits_.data());
  const auto collect = [&](const std::vector<uint8_t>& bits, Lattice lattice) {
    const CellRun* run = runs_.data();
    size_t begin = 0;  // the run's first candidate
    size_t end = run->count;
    std::vector<GridPlace>& places = candidates_[lattice];
    for (size_t block = 0; block < whole_blocks(count) / kLanes; ++block) {
      for (unsigned left = bits[block]; left != 0; left &= left - 1) {
        const size_t i = block * kLanes + static_cast<size_t>(std::countr_zero(left));
        while (i >= end) {
          begin = end;
          ++run;
          end += run->count;
        }
        places.push_back({run->first.eastward(i - begin), static_cast<uint32_t>(i)});
      }
    }
  };
  collect(flat_bits_, kCentre);
  collect(curved_bits_, kOnePerRowAndColumn);
}

/// The cells that a footprint may touch.
void SoilBed::find_candidates(const Footprint& footprint, const PathHistory& path,
                              double rebound_m) {
  const HeightField& field = surface();
  const double spacing = field.spacing_m();
  const Eigen::Vector3d& centre = footprint.pose().translation();
  for (auto& list : candidates_) list.clear();
  // The bound by tiles of the field covers this circle.
  const double radius = footprint.radius_from_above();
  const double highest = field.max_height_within(centre.x(), centre.y(), radius) + rebound_m;
  if (centre.z() - footprint.reach_down() > highest || !find_runs(footprint, highest)) return;
  if (footprint.has_corners()) drop_cells_below(footprint, rebound_m);
  size_t count = 0;
  for (const CellRun& run : runs_) count += run.count;
  if (count == 0) return;
  candidate_points_.clear(count);
  if (candidate_heights_.size() < whole_blocks(count)) {
    candidate_heights_.resize(2 * whole_blocks(count));
    flat_bits_.resize(candidate_heights_.size() / kLanes);
    curved_bits_.resize(flat_bits_.size());
  }
  for (auto& list : candidates_) {
    if (list.capacity() < count) list.reserve(2 * count);
  }
  Height* height = candidate_heights_.data();
  for (const CellRun& run : runs_) {
    height = std::copy_n(field.heights() + run.first.node, run.count, height);
    const double y = field.node_y(run.first.iy);
    const int end = run.first.ix + static_cast<int>(run.count);
    for (int ix = run.first.ix; ix < end; ++ix) candidate_points_.add(field.node_x(ix), y);
  }
  // A cell turned against the body reaches further across it.
  const double edge = footprint.has_corners() ? 2.0 * spacing : footprint.projected_side(spacing);
  footprint.surface(edge, path, candidate_points_, kernels_);
  classify(footprint, rebound_m);
}

/// Candidates become lanes of blocks, those with the same lattice together.
void SoilBed::lay_out_cells() {
  groups_.clear();
  size_t first_point = 0;
  for (int lattice = 0; lattice < kLattices; ++lattice) {
    const std::vector<GridPlace>& candidates = candidates_[static_cast<size_t>(lattice)];
    if (candidates.empty()) continue;
    const size_t blocks = whole_blocks(candidates.size()) / kLanes;
    groups_.push_back({static_cast<Lattice>(lattice), blocks_, blocks, first_point});
    first_point += blocks * kLanes * lattices_[static_cast<size_t>(lattice)].x.size();
    blocks_ += blocks;
    if (cells_.size() < blocks_) {
      cells_.resize(2 * blocks_);
      springs_.resize(2 * blocks_);
      places_.resize(2 * blocks_ * kLanes);
    }
    const size_t begin = groups_.back().begin;
    std::copy(candidates.begin(), candidates.end(), &places_[begin * kLanes]);
    std::fill(&places_[begin * kLanes] + candidates.size(),
              &places_[begin * kLanes] + blocks * kLanes, candidates.back());
    const GridPlace* places = &places_[begin * kLanes];
    const double of_odd = lattice == kOnePerRowAndColumn ? -1.0 : 1.0;
    for (size_t b = begin; b < blocks_; ++b, places += kLanes) {
      CellBlock& block = cells_[b];
      Height level[kLanes];
      Height sunk[kLanes];
// Eight plain copies: 1 % fewer instructions a step than the loop.
#pragma GCC unroll 8
      for (size_t lane = 0; lane < kLanes; ++lane) {
        const GridPlace& place = places[lane];
        const SoilCell& cell = flow_.grid()[place.at.node];
        sunk[lane] = cell.sunk;
        level[lane] = candidate_heights_[place.candidate] + sunk[lane];
        block.x[lane] = candidate_points_.x[place.candidate];
        block.y[lane] = candidate_points_.y[place.candidate];
        block.fresh[lane] = cell.history.is_contact_new(step_) ? 1.0 : 0.0;
        block.covered_before[lane] = cell.history.covered();
        block.old_sinkage[lane] = cell.history.old_sinkage();
        block.beside[lane] = cell.history.beside();
      }
      for (size_t lane = 0; lane < kLanes; ++lane) {
        block.reference[lane] = level[lane] * kHeightUnit_m;
        block.sunk[lane] = sunk[lane] * kHeightUnit_m;
        block.active[lane] = 1.0;
      }
      if (lattice == kCentre) continue;
      for (size_t lane = 0; lane < kLanes; ++lane) {
        const int parity = (places[lane].at.ix + places[lane].at.iy) & 1;
        block.mirrored[lane] = parity != 0 ? of_odd : 1.0;
      }
    }
    for (size_t lane = candidates.size(); lane < blocks * kLanes; ++lane)
      cells_[blocks_ - 1].active[lane % kLanes] = 0.0;
  }
  sample_points_.clear(first_point);
  sample_points_.count = first_point;
}

/// The body's surface at all sample points of the cells. Of cells below a plane it is known.
void SoilBed::sample_surface(const Footprint& footprint, const PathHistory& path) {
  size_t first = 0;  // of the points to be computed
  for (const Group& group : groups_) {
    if (group.lattice == kCentre) {
      copy_plane_points(footprint, group);
      first = group.blocks * kLanes;
      continue;
    }
    const LatticePoints& lattice = lattices_[group.lattice];
    kernels_.place_points(&cells_[group.begin], group.blocks, lattice.x.data(), lattice.y.data(),
                          lattice.x.size(), sample_points_.x.data() + group.first_point,
                          sample_points_.y.data() + group.first_point);
  }
  const double edge = surface().spacing_m() / samples_per_side_;
  footprint.surface(edge, path, sample_points_, kernels_, first);
}

/// What the body covers of a cell below its plane lower run lies around another place than the
/// cell's centre: nearer to its middle.
void SoilBed::copy_plane_points(const Footprint& footprint, const Group& group) {
  const FootprintSamples& from = candidate_points_;
  FootprintSamples& to = sample_points_;
  const Eigen::Vector3d& centre = footprint.pose().translation();
  const Eigen::Vector2d left = footprint.pose().linear().col(1).head<2>();
  const double half_side = 0.5 * footprint.projected_side(surface().spacing_m());
  for (size_t i = 0; i < group.blocks * kLanes; ++i) {
    const size_t candidate = places_[group.begin * kLanes + i].candidate;
    const size_t at = group.first_point + i;
    const double share = from.share[candidate];
    double dx = 0.0;
    double dy = 0.0;
    double down = 0.0;
    if (share < 1.0) {
      const double across =
          (from.x[candidate] - centre.x()) * left.x() + (from.y[candidate] - centre.y()) * left.y();
      const double inwards = -std::copysign((1.0 - share) * half_side, across);
      dx = inwards * left.x();
      dy = inwards * left.y();
      down = from.slope_x[candidate] * dx + from.slope_y[candidate] * dy;
    }
    to.x[at] = from.x[candidate] + dx;
    to.y[at] = from.y[candidate] + dy;
    to.share[at] = share;
    to.height[at] = from.height[candidate] - down;
    to.slope_x[at] = from.slope_x[candidate];
    to.slope_y[at] = from.slope_y[candidate];
    to.passed[at] = from.passed[candidate] - down;
  }
}

// Second moments of the touched area: a rectangle of sides a and b has variances a^2/12 and b^2/12,
// a disc r^2/4.
void SoilBed::measure_patch(const Footprint& footprint, const CellSums& sums,
                            ContactMemory& memory) const {
  const double edge = surface().spacing_m();
  memory.patch_area_m2 = sums.area * cell_area_;
  // A cell spreads its share over itself.
  const double own = sums.own * edge * edge / 12.0;
  const double vxx = (sums.xx + own - sums.x * sums.x / sums.area) / sums.area;
  const double vyy = (sums.yy + own - sums.y * sums.y / sums.area) / sums.area;
  const double vxy = (sums.xy - sums.x * sums.y / sums.area) / sums.area;
  const double half_trace = 0.5 * (vxx + vyy);
  const double minimum =
      half_trace - std::sqrt(std::max(0.0, 0.25 * (vxx - vyy) * (vxx - vyy) + vxy * vxy));
  const double narrow = std::sqrt(std::max(0.0, minimum));
  memory.patch_b_m = footprint.round() ? 2.0 * narrow : std::sqrt(12.0) * narrow;
}

}  // namespace screed
