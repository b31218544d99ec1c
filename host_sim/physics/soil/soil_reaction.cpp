// How soil yields under a footprint, and the reaction: plastic sinkage, normal stress, shear,
// digging.
#include <algorithm>
#include <cmath>

#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// Below this speed a body does not roll into new soil, m/s.
constexpr double kRolling = 1e-3;
// Of strength: what is mobilised more than all but this has no beginning to be looked for.
constexpr double kMinRemainder = 1e-9;

/// 1 - exp(-x): x is mostly small, and there Pade's fraction of second order is within 2e-8.
double fading(double x) {
  return std::abs(x) < 0.1 ? 12.0 * x / (12.0 + x * (6.0 + x)) : 1.0 - std::exp(-x);
}

}  // namespace

void SoilBed::Digging::add(const SoilCell& cell, double sliding, double mobilised) {
  const double along = cell.arm.dot(forward);
  const double across = cell.arm.dot(side);
  share += cell.share;
  first_along += cell.share * along;
  first_across += cell.share * across;
  second_along += cell.share * along * along;
  second_across += cell.share * across * across;
  swept += cell.share * mobilised * sliding;
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
  // Sheared soil settles too; nothing is deposited where nothing is pushed aside.
  const double lost = options_.bulldozing ? soil_.compaction : 1.0;
  compaction_rest_ += lost * static_cast<double>(units);
  const auto compacted = std::min(units, static_cast<int64_t>(compaction_rest_));
  compaction_rest_ -= static_cast<double>(compacted);
  compacted_ += flow_.dig(patch, units, compacted);
}

/// How the soil yields in a footprint's cells, and the forces of the cells.
void SoilBed::react(const Range& range, const PressingBody& body, FootprintContact& contact,
                    double dt) {
  contact.reaction = {};
  if (range.begin == range.end) return;
  TerrainReaction reaction;  // by itself, so that the sums stay in registers
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
  const Eigen::Vector3d level_forward = axle.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d level_side = Eigen::Vector3d::UnitZ().cross(level_forward);
  int64_t sunk_units = 0;
  Digging digging(level_forward, level_side);

  for (size_t i = range.begin; i < range.end; ++i) {
    const SoilCell& cell = cells_[i];
    CellHistory& history = histories_[cell.node];
    const double sinking = springs_[i].sinking;
    const double along_elastic =
        cell.pressure + elastic * (cell.pressed - cell.sunk + sinking * cell.share);
    const double pressure =
        std::max(0.0, std::min(along_elastic, cell.pressure + cell.rate * sinking));
    // What the elastic part does not explain is plastic: the soil yielded.
    const auto units =
        static_cast<Height>(std::lrint((along_elastic - pressure) * units_per_pressure));
    if (pressure <= 0.0) {
      // Not touching: the next contact finds what this one left.
      history.step = 0;
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
    const Eigen::Vector3d surface = velocity - contact.motion.surface_speed * tread;
    const double slide_along = surface.dot(radial ? tread : level_forward);
    const double slide_across = surface.dot(radial ? face.cross(tread) : level_side);
    // Directions in the plane in which the soil shears.
    const Eigen::Vector3d normal = radial ? Eigen::Vector3d(cell.slope_x, cell.slope_y, 1.0)
                                          : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d lengthwise = radial ? along : level_forward;
    const Eigen::Vector3d sideways = radial ? normal.cross(along) / steep : level_side;

    // Mobilised shear: the mean over the touching part of the cell. What has just come into touch
    // starts at zero.
    const double sliding = std::sqrt(slide_along * slide_along + slide_across * slide_across);
    const double per_sliding = sliding > 0.0 ? 1.0 / sliding : 0.0;
    const double to_along = slide_along * per_sliding;
    const double to_across = slide_across * per_sliding;
    const double kept = std::min(static_cast<double>(history.share), cell.share) / cell.share;
    const double fades = fading(sliding * dt * per_shear_modulus);
    const double stays = kept * (1.0 - fades);
    const double comes = 0.5 * (1.0 + kept) * fades;
    const double mean_along = static_cast<double>(history.along) * stays + to_along * comes;
    const double mean_across = static_cast<double>(history.across) * stays + to_across * comes;
    history.step = step_;
    history.share = static_cast<float>(cell.share);
    history.along = static_cast<float>(mean_along);
    history.across = static_cast<float>(mean_across);

    // Where the pressure is higher the soil has sheared for longer, by the distance between the
    // centre of pressure and that of the contact. That stress answers to a shear that is further on
    // is its damping.
    const double ahead = soil_.shear_damping_s - cell.lead * per_speed;
    // Nowhere does that lie before shear in this direction began.
    const double begun = std::max(0.0, mean_along * to_along + mean_across * to_across);
    const double further = std::max(fading(sliding * ahead * per_shear_modulus),
                                    -begun / std::max(1.0 - begun, kMinRemainder));
    double m_along = mean_along + (to_along - mean_along) * further;
    double m_across = mean_across + (to_across - mean_across) * further;
    const double squared = m_along * m_along + m_across * m_across;
    if (squared > 1.0) {
      const double to_strength = 1.0 / std::sqrt(squared);
      m_along *= to_strength;
      m_across *= to_strength;
    }
    const double load = damped * cell_area_;
    Eigen::Vector3d force(0.0, 0.0, load);
    if (radial) force << load * cell.slope_x, load * cell.slope_y, load;
    Eigen::Vector3d torque = load * cell.moment;
    reaction.normal_load += load;
    const double strength = soil_.cohesion_pa * cell.share + damped * tan_friction_;
    const Eigen::Vector3d traction = (-strength * cell_area_ * (radial ? steep : 1.0)) *
                                     (m_along * lengthwise + m_across * sideways);
    force += traction;
    torque += cell.arm.cross(traction);
    reaction.along_surface -= traction.dot(along);
    if (soil_.drag_depth_m > 0.0) {
      const double mobilised = std::sqrt(std::min(squared, 1.0));
      digging.add(cell, sliding, mobilised);
      flow_.shear(cell.node, cell.share * mobilised * sliding);
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

}  // namespace screed
