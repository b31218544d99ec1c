// How soil yields under a footprint, and the reaction: plastic sinkage, normal stress, shear, what
// is pushed ahead and aside, digging.
//
// The equations in the order of the code. Values of a cell are means over it; E, c, phi, R as in
// soil_parameters.h, A the area of a cell, v the body's velocity there.
//
// Yielding. A body that goes down by `sinking` meets the lower of two lines, unloading and
// reloading along E and Bekker's curve (Bekker 1969; soil_cells.cpp), linear over a step. What E
// does not explain is plastic:
//   along_elastic = cell.pressure + E (pressed - sunk + sinking (1 - rebound) share)
//   pressure      = max(0, min(along_elastic, cell.pressure + rate sinking))
//   units         = (along_elastic - pressure) / E                  in units of height
//   damped        = pressure + R max(0, -v_z) share
//
// Shear. m is the mobilised share of the strength, along and across, carried with the material of
// the running surface (shear_field.h); it acts at the centre of pressure. A surface has a friction
// and adhesion of its own: where it holds less than the soil, it slips on the soil.
//   strength = min(c share + damped tan phi, adhesion share + damped friction)
//
// Forces. Radial normal stress is along the surface's normal (slope_x, slope_y, 1), whose length is
// `steep`; vertical stress is straight up and shears in the horizontal.
//   force    = damped A (slope_x, slope_y, 1)
//   traction = -strength A steep (m_along lengthwise + m_across sideways)
//
// What is pushed (passive_pressure.h). A surface that slides over the soil the way the body travels
// pushes with what faces that way; a wheel or belt that moves aside pushes with its side wall, as
// far as the soil beside it has been sheared since the body came (`aside`, a field that lies still
// on the ground). z is the depth of the surface below the undisturbed level; travelling ahead:
//   ahead    = -p(z) A share max(0, m_along) max(0, -tilt_along)
//   sideways = -R(z) A share / width aside
// Both act on the axle.
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
inline double SoilBed::yield(const SoilCell& cell, double sinking, const Law& law,
                             size_t footprint) {
  const double along_elastic =
      cell.pressure +
      law.elastic * (cell.pressed - cell.sunk + sinking * (1.0 - law.rebound) * cell.share);
  const double pressure =
      std::max(0.0, std::min(along_elastic, cell.pressure + cell.rate * sinking));
  const auto units =
      static_cast<Height>(std::lrint((along_elastic - pressure) / (law.elastic * kHeightUnit_m)));
  if (pressure > 0.0 && units > 0) {
    flow_.sink(footprint, cell.node, cell.ix, cell.iy, units);
  }
  return pressure;
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
  kept.shear.advance(range.frame.contour, motion, range.rear, range.front, soil_.shear_modulus_m,
                     soil_.shear_damping_s, dt);
  if (passive_.none() || contact.footprint->kind() != Footprint::Kind::kTrack) return;
  motion.surface_speed = motion.velocity.x();  // the soil beside it stays behind
  motion.sideways_only = true;
  kept.side.advance(range.frame.contour, motion, range.rear, range.front, soil_.shear_modulus_m,
                    0.0, dt);
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
  const RunFrame& frame = range.frame;
  const Eigen::Vector3d left = frame.axes.col(1);
  const Eigen::Vector3d level_ahead = left.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d level_left = Eigen::Vector3d::UnitZ().cross(level_ahead);
  const bool radial = options_.normal_stress == NormalStress::kRadial;
  const ContactMemory& memory = *contact.memory;
  const bool pushes = !passive_.none() && contact.footprint->kind() == Footprint::Kind::kTrack;
  const double travel = std::copysign(1.0, memory.path.travel_m);
  const double per_width = 0.5 / frame.contour.half_width_m;
  SlipSums slip_sums(level_ahead, level_left);

  for (size_t i = range.begin; i < range.end; ++i) {
    const SoilCell& cell = cells_[i];
    const double pressure = yield(cell, springs_[i].sinking, range.law, range.footprint);
    if (pressure <= 0.0) {
      histories_[cell.node].release();
      continue;
    }
    histories_[cell.node].touch(step_);
    const double v_z =
        centre_velocity.z() + body.omega.x() * cell.arm.y() - body.omega.y() * cell.arm.x();
    const double damped = pressure + soil_.damping_pa_s_per_m * std::max(0.0, -v_z) * cell.share;
    const double along = frame.contour.along(cell.arm.dot(frame.axes.col(0)));
    const double across = cell.arm.dot(left);
    const ShearField::Value m = memory.shear.at(along, across);

    const double load = damped * cell_area_;
    Eigen::Vector3d force(0.0, 0.0, load);
    Eigen::Vector3d lengthwise = level_ahead;
    Eigen::Vector3d sideways = level_left;
    double steep = 1.0;
    if (radial) {
      const Eigen::Vector3d normal(cell.slope_x, cell.slope_y, 1.0);
      steep = normal.norm();
      lengthwise = left.cross(normal) / steep;
      sideways = normal.cross(lengthwise) / steep;
      force = load * normal;
    }
    Eigen::Vector3d torque = load * cell.moment;
    reaction.normal_load += load;
    const double strength =
        std::min(soil_.cohesion_pa * cell.share + damped * tan_friction_,
                 contact.motion.adhesion_pa * cell.share + damped * contact.motion.soil_friction);
    const Eigen::Vector3d traction =
        (-strength * cell_area_ * steep) * (m.along * lengthwise + m.across * sideways);
    force += traction;
    torque += cell.arm.cross(traction);
    reaction.along_surface -= frame.sense * traction.dot(lengthwise);
    if (pushes) {
      const double area = cell_area_ * cell.share;
      const double tilt = cell.tilt_x * level_ahead.x() + cell.tilt_y * level_ahead.y();
      const double facing = std::max(0.0, travel * m.along) * std::max(0.0, -travel * tilt);
      const double ahead = -travel * passive_.pressure(cell.depth) * area * facing;
      const double aside = -passive_.resistance(cell.depth) * area * per_width *
                           memory.side.at(along, across).across;
      const Eigen::Vector3d push = ahead * level_ahead + aside * level_left;
      force += push;
      torque += Eigen::Vector3d(cell.arm.x(), cell.arm.y(), 0.0).cross(push);
    }
    if (soil_.drag_depth_m > 0.0) {
      const double mobilised = std::hypot(m.along, m.across);
      slip_sums.add(cell, m.sliding, mobilised);
      flow_.shear(cell.node, cell.share * mobilised * m.sliding);
    }
    reaction.force += force;
    reaction.torque += torque;
    reaction.area += cell.share * cell_area_;
    reaction.sinkage = std::max(reaction.sinkage, flow_.reference(cell.node) * kHeightUnit_m -
                                                      (pose.translation().z() + cell.arm.z()));
  }
  if (soil_.drag_depth_m > 0.0) dig_below(slip_sums, pose, dt);
  contact.memory->sinkage = reaction.sinkage;
  contact.reaction = reaction;
}

}  // namespace screed
