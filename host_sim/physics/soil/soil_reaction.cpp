// How soil yields under a footprint, and the reaction: plastic sinkage, normal stress, shear,
// digging.
//
// The equations in the order of the code. Values of a cell are means over it; E, c, phi, K, R as in
// soil_parameters.h, A the area of a cell, v the body's velocity there.
//
// Yielding. A body that goes down by `sinking` meets the lower of two lines, unloading and
// reloading along E and Bekker's curve (Bekker 1969; soil_cells.cpp), linear over a step. What E
// does not explain is plastic:
//   along_elastic = cell.pressure + E (pressed - sunk + sinking share)
//   pressure      = max(0, min(along_elastic, cell.pressure + rate sinking))
//   units         = (along_elastic - pressure) / E                  in units of height
//   damped        = pressure + R max(0, -v_z) share
//
// Shear. Janosi and Hanamoto's curve (1961), tau = strength (1 - exp(-j / K)), in its rate form for
// slip that turns (Dahl 1968). With m = tau / strength, a vector along and across, and slip in the
// direction `to` with the speed `sliding`:
//   dm/dt = sliding (to - m) / K,      over a step m <- m + (to - m) fades,
//   fades = 1 - exp(-sliding dt / K)
// Of the touching part only `kept` was there a step ago; the rest came evenly over the step, from
// m = 0, and so has had half of it:
//   mean  = kept (1 - fades) m + (1 + kept) / 2 fades to
// The force acts at the centre of pressure, which has sheared for `ahead` longer than the centre of
// the contact area, and stress answers `shear_damping` early:
//   ahead   = shear_damping - lead / speed
//   begun   = max(0, mean . to)
//   further = max(1 - exp(-sliding ahead / K), -begun / (1 - begun))   back to zero shear at most
//   m       = mean + (to - mean) further     no longer than 1
//   strength = c share + damped tan phi      Mohr and Coulomb (Wong, ch. 2)
//
// Forces. Radial normal stress is along the surface's normal (slope_x, slope_y, 1), whose length is
// `steep`; vertical stress is straight up and shears in the horizontal.
//   force    = damped A (slope_x, slope_y, 1)
//   traction = -strength A steep (m_along lengthwise + m_across sideways)
//
// Digging. A layer of `drag_depth` moves with the slipping surface. `share` is a cell's touching
// part; variances are of the cells' positions, weighed with it:
//   slip    = sum(share |m| sliding) / sum(share)                     mean speed, m/s
//   sides   = sqrt(12 variance + edge^2)                              of the touched rectangle
//   volume  = drag_depth slip dt width
#include <algorithm>
#include <cmath>

#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// Below this speed a body does not roll into new soil, m/s.
constexpr double kRolling = 1e-3;
// Share of the strength, not yet mobilised: keeps a division defined when all is mobilised.
constexpr double kMinRemainder = 1e-9;

/// 1 - exp(-x): x is mostly small, and there Pade's fraction of second order is within 2e-8.
double fading(double x) {
  return std::abs(x) < 0.1 ? 12.0 * x / (12.0 + x * (6.0 + x)) : 1.0 - std::exp(-x);
}

}  // namespace

/// Of a footprint as a whole.
struct SoilBed::FootprintState {
  bool radial;  // normal stress
  Eigen::Vector3d centre;
  Eigen::Vector3d axle;
  Eigen::Vector3d level_forward;
  Eigen::Vector3d level_side;
  double surface_speed;
  double per_speed;  // one over its speed forward, s/m; 0: it does not roll
  double elastic;    // E, Pa/m
  double units_per_pressure;
  double per_shear_modulus;  // 1 / K

  SurfaceSlip slip_over(const SoilCell& cell, const Eigen::Vector3d& velocity) const;
};

/// How a footprint's surface slips over one cell.
struct SoilBed::SurfaceSlip {
  double steep;                // length of (slope_x, slope_y, 1)
  Eigen::Vector3d along;       // forward along the surface where the pressure is
  Eigen::Vector3d lengthwise;  // directions in the plane in which the soil shears
  Eigen::Vector3d sideways;
  double sliding;   // m/s
  double to_along;  // its direction
  double to_across;
};

/// Mobilised shares of the shear strength.
struct SoilBed::Mobilised {
  double along;
  double across;
  double squared;  // of both, before it is limited to 1
};

void SoilBed::SlipSums::add(const SoilCell& cell, double sliding, double mobilised) {
  const double along = cell.arm.dot(forward);
  const double across = cell.arm.dot(side);
  share += cell.share;
  sum_along += cell.share * along;
  sum_across += cell.share * across;
  sum_along_squared += cell.share * along * along;
  sum_across_squared += cell.share * across * across;
  slip_sum += cell.share * mobilised * sliding;
}

// A layer of the soil goes along with a slipping surface: slip times depth times the footprint's
// width a second. It comes from under the whole of the footprint and heaves the ground around it,
// as far as the footprint is wide.
void SoilBed::dig_below(const SlipSums& slip, const Eigen::Isometry3d& pose, double dt) {
  if (slip.share <= 0.0) return;
  const double edge = flow_.surface().spacing_m();
  const double per_share = 1.0 / slip.share;
  const double along = slip.sum_along * per_share;
  const double across = slip.sum_across * per_share;
  const auto half_side = [&](double second, double mean) {
    return 0.5 * std::sqrt(12.0 * std::max(0.0, second * per_share - mean * mean) + edge * edge);
  };
  DugPatch patch;
  patch.forward = slip.forward.head<2>();
  patch.centre = (pose.translation() + along * slip.forward + across * slip.side).head<2>();
  patch.half_length = half_side(slip.sum_along_squared, along);
  patch.half_width = half_side(slip.sum_across_squared, across);
  patch.band = 2.0 * std::min(patch.half_length, patch.half_width);
  const double volume =
      soil_.drag_depth_m * dt * per_share * 2.0 * slip.slip_sum * patch.half_width;
  dig_remainder_ += volume / (cell_area_ * kHeightUnit_m);
  const auto units = static_cast<int64_t>(dig_remainder_);
  dig_remainder_ -= static_cast<double>(units);
  // Sheared soil settles too; nothing is deposited where nothing is pushed aside.
  const double lost = options_.bulldozing ? soil_.compaction : 1.0;
  compaction_remainder_ += lost * static_cast<double>(units);
  const auto compacted = std::min(units, static_cast<int64_t>(compaction_remainder_));
  compaction_remainder_ -= static_cast<double>(compacted);
  compacted_ += flow_.dig(patch, units, compacted);
}

/// Plastic sinkage and pressure of a cell; books what sinks. 0: not touching.
inline double SoilBed::yield(const SoilCell& cell, double sinking, const FootprintState& state,
                             size_t footprint) {
  const double along_elastic =
      cell.pressure + state.elastic * (cell.pressed - cell.sunk + sinking * cell.share);
  const double pressure =
      std::max(0.0, std::min(along_elastic, cell.pressure + cell.rate * sinking));
  const auto units =
      static_cast<Height>(std::lrint((along_elastic - pressure) * state.units_per_pressure));
  if (pressure > 0.0 && units > 0) {
    flow_.sink(footprint, cell.node, cell.ix, cell.iy, units);
  }
  return pressure;
}

/// Forces act where the pressure is, the surface slides where it touches: two means of its slope.
inline SoilBed::SurfaceSlip SoilBed::FootprintState::slip_over(
    const SoilCell& cell, const Eigen::Vector3d& velocity) const {
  SurfaceSlip slip;
  slip.steep = std::sqrt(1.0 + cell.slope_x * cell.slope_x + cell.slope_y * cell.slope_y);
  slip.along = axle.cross(Eigen::Vector3d(cell.slope_x, cell.slope_y, 1.0) / slip.steep);
  const double per_length =
      1.0 / std::sqrt(1.0 + cell.tilt_x * cell.tilt_x + cell.tilt_y * cell.tilt_y);
  const Eigen::Vector3d face(cell.tilt_x * per_length, cell.tilt_y * per_length, per_length);
  // Forward along the surface, at right angles to the axle.
  const Eigen::Vector3d tread = axle.cross(face);
  const Eigen::Vector3d surface = velocity - surface_speed * tread;
  const double slide_along = surface.dot(radial ? tread : level_forward);
  const double slide_across = surface.dot(radial ? face.cross(tread) : level_side);
  slip.lengthwise = level_forward;
  slip.sideways = level_side;
  if (radial) {
    const Eigen::Vector3d normal(cell.slope_x, cell.slope_y, 1.0);
    slip.lengthwise = slip.along;
    slip.sideways = normal.cross(slip.along) / slip.steep;
  }
  slip.sliding = std::sqrt(slide_along * slide_along + slide_across * slide_across);
  const double per_sliding = slip.sliding > 0.0 ? 1.0 / slip.sliding : 0.0;
  slip.to_along = slide_along * per_sliding;
  slip.to_across = slide_across * per_sliding;
  return slip;
}

/// Mobilised shear of a cell after this step, at its centre of pressure; `history` keeps the mean.
inline SoilBed::Mobilised SoilBed::mobilise(const SoilCell& cell, const SurfaceSlip& slip,
                                            const FootprintState& state, double dt,
                                            SoilCellHistory& history) const {
  const double kept = std::min(static_cast<double>(history.share), cell.share) / cell.share;
  const double fades = fading(slip.sliding * dt * state.per_shear_modulus);
  const double stays = kept * (1.0 - fades);
  const double comes = 0.5 * (1.0 + kept) * fades;
  const double mean_along = static_cast<double>(history.along) * stays + slip.to_along * comes;
  const double mean_across = static_cast<double>(history.across) * stays + slip.to_across * comes;
  history.touch(step_);
  history.share = static_cast<float>(cell.share);
  history.along = static_cast<float>(mean_along);
  history.across = static_cast<float>(mean_across);

  const double ahead = soil_.shear_damping_s - cell.lead * state.per_speed;
  // Not further back than to zero shear in this direction.
  const double begun = std::max(0.0, mean_along * slip.to_along + mean_across * slip.to_across);
  const double further = std::max(fading(slip.sliding * ahead * state.per_shear_modulus),
                                  -begun / std::max(1.0 - begun, kMinRemainder));
  Mobilised m;
  m.along = mean_along + (slip.to_along - mean_along) * further;
  m.across = mean_across + (slip.to_across - mean_across) * further;
  m.squared = m.along * m.along + m.across * m.across;
  if (m.squared > 1.0) {
    const double to_strength = 1.0 / std::sqrt(m.squared);
    m.along *= to_strength;
    m.across *= to_strength;
  }
  return m;
}

inline SoilBed::FootprintState SoilBed::footprint_state(
    const FootprintContact& contact, double elastic, const Eigen::Vector3d& centre_velocity) const {
  const Eigen::Isometry3d& pose = contact.footprint->pose();
  FootprintState state;
  state.radial = options_.normal_stress == NormalStress::kRadial;
  state.centre = pose.translation();
  state.axle = pose.linear().col(1);
  state.level_forward = state.axle.cross(Eigen::Vector3d::UnitZ()).normalized();
  state.level_side = Eigen::Vector3d::UnitZ().cross(state.level_forward);
  state.surface_speed = contact.motion.surface_speed;
  const Eigen::Vector3d forward = pose.linear().col(0);
  const double speed = centre_velocity.dot(forward);
  state.per_speed = std::abs(speed) > kRolling ? 1.0 / speed : 0.0;
  state.elastic = elastic;
  state.units_per_pressure = 1.0 / (elastic * kHeightUnit_m);
  state.per_shear_modulus = 1.0 / soil_.shear_modulus_m;
  return state;
}

/// How the soil yields in a footprint's cells, and the forces of the cells.
void SoilBed::react(const Range& range, const PressingBody& body, FootprintContact& contact,
                    double dt) {
  contact.reaction = {};
  if (range.begin == range.end) return;
  TerrainReaction reaction;  // by itself, so that the sums stay in registers
  const Eigen::Isometry3d& pose = contact.footprint->pose();
  const Eigen::Vector3d centre_velocity =
      body.velocity + body.omega.cross(pose.translation() - body.centre);
  const FootprintState state = footprint_state(contact, range.law.elastic, centre_velocity);
  SlipSums slip_sums(state.level_forward, state.level_side);

  for (size_t i = range.begin; i < range.end; ++i) {
    const SoilCell& cell = cells_[i];
    SoilCellHistory& history = histories_[cell.node];
    const double pressure = yield(cell, springs_[i].sinking, state, range.footprint);
    if (pressure <= 0.0) {
      history.release();
      continue;
    }
    const Eigen::Vector3d velocity = centre_velocity + body.omega.cross(cell.arm);
    const double damped =
        pressure + soil_.damping_pa_s_per_m * std::max(0.0, -velocity.z()) * cell.share;
    const SurfaceSlip slip = state.slip_over(cell, velocity);
    const Mobilised m = mobilise(cell, slip, state, dt, history);

    const double load = damped * cell_area_;
    Eigen::Vector3d force(0.0, 0.0, load);
    if (state.radial) force << load * cell.slope_x, load * cell.slope_y, load;
    Eigen::Vector3d torque = load * cell.moment;
    reaction.normal_load += load;
    const double strength = soil_.cohesion_pa * cell.share + damped * tan_friction_;
    const Eigen::Vector3d traction = (-strength * cell_area_ * (state.radial ? slip.steep : 1.0)) *
                                     (m.along * slip.lengthwise + m.across * slip.sideways);
    force += traction;
    torque += cell.arm.cross(traction);
    reaction.along_surface -= traction.dot(slip.along);
    if (soil_.drag_depth_m > 0.0) {
      const double mobilised = std::sqrt(std::min(m.squared, 1.0));
      slip_sums.add(cell, slip.sliding, mobilised);
      flow_.shear(cell.node, cell.share * mobilised * slip.sliding);
    }
    reaction.force += force;
    reaction.torque += torque;
    reaction.area += cell.share * cell_area_;
    reaction.sinkage = std::max(reaction.sinkage, flow_.reference(cell.node) * kHeightUnit_m -
                                                      (state.centre.z() + cell.arm.z()));
  }
  if (soil_.drag_depth_m > 0.0) dig_below(slip_sums, pose, dt);
  contact.memory->sinkage = reaction.sinkage;
  contact.reaction = reaction;
}

}  // namespace screed
