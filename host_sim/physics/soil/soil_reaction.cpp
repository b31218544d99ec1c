// How soil yields under a footprint, and the reaction: plastic sinkage, normal stress, shear, what
// is pushed ahead and aside, digging.
//
// The equations of kernels/cell_shear.inc (slip, shear), which comes first, and
// kernels/reaction.inc (all others but digging). Values of a cell are means over it; E, c, phi, R
// as in soil_parameters.h, A the area of a cell, v the body's velocity there.
//
// Yielding. A body that goes down by `sinking` meets the lower of two lines, unloading and
// reloading along E and Bekker's curve (Bekker 1969; soil_cells.cpp), linear over a step. What E
// does not explain is plastic:
//   beyond        = pressed - sunk + sinking (1 - rebound) share
//   along_elastic = cell.pressure + (beyond < 0 ? unload : E) beyond
//   pressure      = max(0, min(along_elastic, cell.pressure + rate sinking))
//   units         = (along_elastic - pressure) / E                  in units of height
//   damped        = pressure + R max(0, sinking / dt) share     -v_z where the motion is imposed
//
// Slip. A surface that slides over soil is borne by less (soil_laws.h). v is its speed where the
// ground stays, n its normal; what the body sinks in the step is part of it:
//   flow     = 1.45 |m|^2 (sliding - 0.1 mm/s)
//   share    = min(1, slip_bearing + (1 - slip_bearing) (|v n| + max(0, sinking / dt)) / flow)
//   pressure = share times that of Bekker's curve
//
// Shear. m is the mobilised share of the strength, along and across, carried with the material of
// the running surface (shear_field.h); it acts at the centre of pressure. A surface has a friction
// and adhesion of its own: where it holds less than the soil, it slips on the soil.
//   strength = min(c share + damped tan phi, adhesion share + damped friction)
// Lugs hold as the soil does as far as they are in it, the rest of the surface by its friction:
//   filled   = min(1, depth / lug height)             depth: mean of the last step, as below
//   adhesion = filled c,   friction = filled tan phi + (1 - filled) the surface's own
//
// Forces. Radial normal stress is along the surface's normal (slope_x, slope_y, 1), whose length is
// `steep`; vertical stress is straight up and shears in the horizontal.
//   force    = damped A (slope_x, slope_y, 1)
//   traction = -strength A steep (m_along lengthwise + m_across sideways)
//
// What is pushed (soil_laws.h). A surface that slides over the soil the way the body travels
// pushes with what faces that way; a wheel or belt that moves aside pushes with its side wall, as
// far as the soil beside it has been sheared since the body came (`aside`, a field that lies still
// on the ground). z is the depth of the surface below the undisturbed level; travelling ahead:
//   ahead    = -p(z) A share max(0, m_along) max(0, -tilt_along)
//   sideways = -R(z) A share / width aside
// Both act on the axle.
//
// What slip takes along. A layer goes with the slipping surface: `slip_layer`, or what the
// surface's lugs hold between them, where that is more (A. R. Reece, Principles of soil-vehicle
// mechanics, Proceedings of the Institution of Mechanical Engineers 180(2A), 1965): as much of
// their height as the surface has sunk. `share` is a cell's touching part; variances are of the
// cells' positions, weighed with it:
//   layer   = max(slip_layer, min(lug height, sum(share z) / sum(share)))
//   slip    = sum(share |m| sliding) / sum(share)                     mean speed, m/s
//   sides   = sqrt(12 variance + edge^2)                              of the touched rectangle
//   volume  = layer slip dt width
// Of the soil by which a cell yields, a part goes the way of the flow, the rest is pressed aside
// (MaterialFlow::deposit()):
//   thrown  = 1 - (|v n| + max(0, sinking / dt)) / flow               none where that is negative
// Both go along with the surface, the slower the deeper they lie:
//   carried = slip_carry (volume length + thrown sides)               the way the surface slips,
// along by the length of the touched rectangle, across by its width.
// The layer slips in the direction of all that shears it. Gravity does so, too: down a slope theta
// with tan(theta) / tan(repose) of what makes it slip, so it goes that way with this part of its
// speed, and by gravity no faster than it slips:
//   carried = layer slip dt area min(1, tan(theta) / tan(repose))     volume times way, downhill
#include <algorithm>
#include <cmath>

#include "host_sim/physics/kernels/triple.h"
#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// A surface's own friction or adhesion that never limits.
constexpr double kNoLimit = 1e12;

}  // namespace

void SoilBed::dig_below(const ReactionSums& sums, const ReactionLaw& law,
                        const FootprintContact& contact, double dt) {
  if (sums.area <= 0.0) return;
  const double edge = surface().spacing_m();
  const double per_share = 1.0 / sums.area;
  const double along = sums.sum_along * per_share;
  const double across = sums.sum_across * per_share;
  const auto half_side = [&](double second, double mean) {
    return 0.5 * std::sqrt(12.0 * std::max(0.0, second * per_share - mean * mean) + edge * edge);
  };
  const Eigen::Vector3d forward = vector(law.level_ahead);
  const Eigen::Vector3d left = vector(law.level_left);
  DugPatch patch;
  patch.forward = forward.head<2>();
  patch.centre =
      (contact.footprint->pose().translation() + along * forward + across * left).head<2>();
  patch.half_length = half_side(sums.sum_along_squared, along);
  patch.half_width = half_side(sums.sum_across_squared, across);
  patch.band = 2.0 * std::min(patch.half_length, patch.half_width);
  const double layer =
      std::max(soil_.slip_layer_m, std::min(contact.motion.lug_height_m, contact.memory->depth));
  const double volume = layer * dt * per_share * 2.0 * sums.slip * patch.half_width;
  dig_remainder_ += volume / (cell_area_ * kHeightUnit_m);
  const Eigen::Vector3d normal = vector(law.axis_x).cross(vector(law.axis_y));
  const Eigen::Vector2d fall = normal.head<2>() / std::max(normal.z(), 1e-3);
  const double part = 1.0 / std::max(tan_repose_, fall.norm());
  patch.carried = layer * dt * sums.slip / kHeightUnit_m * part * fall;
  const Eigen::Vector2d slips =
      sums.slip_along * forward.head<2>() + sums.slip_across * left.head<2>();
  patch.carried += layer * soil_.slip_carry * dt / kHeightUnit_m * slips;
  const Eigen::Vector2d past = 2.0 * (patch.half_length * sums.slip_along * forward.head<2>() +
                                      patch.half_width * sums.slip_across * left.head<2>());
  patch.carried += soil_.slip_carry * sums.thrown / sums.slip * past;
  const auto units = static_cast<int64_t>(dig_remainder_);
  dig_remainder_ -= static_cast<double>(units);
  flow_.dig(patch, units, sums.units > 0.0 ? sums.thrown / sums.units : 0.0);
}

/// Carries the shear of the running surface, and of the soil beside it, through this step.
void SoilBed::advance_shear(const Range& range, const PressingBody& body, FootprintContact& contact,
                            double dt) const {
  ContactMemory& kept = *contact.memory;
  if (kept.face != range.frame.face) {  // it has turned over
    kept.face = range.frame.face;
    kept.shear = {};
    kept.side = {};
  }
  const Eigen::Matrix3d to_frame = range.frame.axes.transpose();
  RunMotion motion;
  motion.velocity = to_frame * (body.velocity + body.omega.cross(contact.arm));
  motion.omega = to_frame * body.omega;
  motion.surface_speed = range.frame.sense * contact.motion.surface_speed;
  motion.level = options_.normal_stress == NormalStress::kVertical;
  const auto advance = [&](ShearField& shear, double damping_s) {
    if (range.touching) {
      shear.advance(range.frame.contour, motion, range.rear, range.front, soil_.shear_modulus_m,
                    damping_s, dt, kernels_);
    } else {
      shear.hover(range.frame.contour, motion, dt);
    }
  };
  advance(kept.shear, soil_.shear_damping_s);
  if (passive_.none() || contact.footprint->kind() != Footprint::Kind::kTrack) return;
  motion.surface_speed = motion.velocity.x();  // the soil beside it stays behind
  motion.sideways_only = true;
  advance(kept.side, 0.0);
}

ReactionLaw SoilBed::reaction_law(const Range& range, const PressingBody& body,
                                  const FootprintContact& contact, double dt) const {
  const RunFrame& frame = range.frame;
  const Eigen::Vector3d left = frame.axes.col(1);
  const Eigen::Vector3d level_ahead = left.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d level_left = Eigen::Vector3d::UnitZ().cross(level_ahead);
  const Eigen::Vector3d& centre = contact.footprint->pose().translation();
  const ContactMemory& memory = *contact.memory;
  ReactionLaw law{};
  law.elastic = range.law.cell.elastic;
  law.stays = 1.0 - range.law.cell.rebound;
  law.cell_area = cell_area_;
  law.height_unit = kHeightUnit_m;
  law.damping = soil_.damping_pa_s_per_m;
  law.per_step = std::isfinite(body.mass_kg) ? 1.0 / dt : 0.0;
  law.cohesion = soil_.cohesion_pa;
  law.tan_friction = tan_friction_;
  // Where a surface has none of its own, the soil's strength alone counts.
  law.adhesion = std::min(contact.motion.adhesion_pa, kNoLimit);
  law.surface_friction = std::min(contact.motion.soil_friction, kNoLimit);
  if (contact.motion.lug_height_m > 0.0) {
    const double filled = std::min(1.0, memory.depth / contact.motion.lug_height_m);
    law.adhesion = filled * soil_.cohesion_pa;
    const double own = std::min(contact.motion.soil_friction, contact.motion.friction);
    law.surface_friction = filled * tan_friction_ + (1.0 - filled) * own;
  }
  law.axis_x = triple(frame.axes.col(0));
  law.axis_y = triple(left);
  law.level_ahead = triple(level_ahead);
  law.level_left = triple(level_left);
  law.contour_half = frame.contour.half_m;
  law.contour_radius = frame.contour.radius_m;
  law.sinking_speed = (body.velocity + body.omega.cross(centre - body.centre)).z();
  law.omega_x = body.omega.x();
  law.omega_y = body.omega.y();
  law.centre_z = centre.z();
  law.radial = options_.normal_stress == NormalStress::kRadial;
  law.digs =
      soil_.slip_bearing < 1.0 || soil_.slip_layer_m > 0.0 || contact.motion.lug_height_m > 0.0;
  law.pushes = !passive_.none() && contact.footprint->kind() == Footprint::Kind::kTrack;
  law.sense = frame.sense;
  law.travel = std::copysign(1.0, memory.path.travel_m);
  law.passive_at_surface = passive_.at_surface_pa();
  law.passive_per_depth = passive_.per_depth_pa_per_m();
  law.per_width = 0.5 / frame.contour.half_width_m;
  law.slip_bearing = soil_.slip_bearing;
  law.slip_flow = kSlipFlow;
  law.slip_still = kSlipStill_m_per_s;
  law.dt = dt;
  law.velocity = triple(body.velocity + body.omega.cross(centre - body.centre));
  law.turning = body.omega.z();
  law.shear = memory.shear.view();
  law.aside = memory.side.view();
  return law;
}

/// Books what the cells of a footprint have sunk, and that it stands there: nothing slides onto or
/// off them.
void SoilBed::settle(const Range& range, bool slips) {
  const GridPlace* places = places_.data() + range.begin * kLanes;
  for (size_t b = range.begin; b < range.end; ++b, places += kLanes) {
    const CellBlock& block = cells_[b];
    for (size_t lane = 0; lane < kLanes; ++lane) {
      if (!(block.active[lane] > 0.0)) continue;
      const GridNode& at = places[lane].at;
      flow_.cover(at);
      CellHistory& history = flow_.grid()[at.node].history;
      history.keep(block.covered[lane], {block.old_sinkage[lane], block.beside[lane]});
      if (!(block.bears[lane] > 0.0)) {
        history.release();
        continue;
      }
      history.touch(step_);
      const auto units = static_cast<Height>(block.units[lane]);
      if (units > 0) flow_.sink(at, units);
      if (slips) flow_.shear(at.node, block.shears[lane]);
    }
  }
}

/// How the soil yields in a footprint's cells, and the forces of the cells.
void SoilBed::react(const Range& range, const PressingBody& body, FootprintContact& contact,
                    double dt) {
  contact.reaction = {};
  if (!range.touching) return;
  const ReactionLaw& law = range.reaction;
  ReactionSums sums;
  kernels_.react(&cells_[range.begin], &springs_[range.begin], range.end - range.begin, law, sums);
  const bool slips = law.digs && sums.slip > 0.0;
  const Eigen::Vector3d velocity =
      body.velocity + body.omega.cross(contact.footprint->pose().translation() - body.centre);
  // As digging heaves the soil around a body as far as what touches is wide.
  flow_.begin_footprint(
      {velocity.head<2>(), vector(law.level_ahead).head<2>(), contact.memory->patch_b_m});
  settle(range, slips);
  contact.memory->sinkage = sums.sinkage;
  contact.memory->depth = sums.area > 0.0 ? std::max(0.0, sums.depth / sums.area) : 0.0;
  if (slips) dig_below(sums, law, contact, dt);
  TerrainReaction& reaction = contact.reaction;
  reaction.force = vector(sums.force);
  reaction.torque = vector(sums.torque);
  reaction.along_surface = sums.along_surface;
  reaction.normal_load = sums.normal_load;
  reaction.sinkage = sums.sinkage;
  reaction.area = sums.area * cell_area_;
}

}  // namespace screed
