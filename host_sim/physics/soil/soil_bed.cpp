// Deformable soil on a grid: a step of it. soil_cells.cpp has what lies under a footprint,
// soil_reaction.cpp how it yields there.
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host_sim/physics/soil/sinking.h"

namespace screed {
namespace {

// Greatest E A dt^2 / mass, A the touched area, of a long footprint that the solver does not tilt:
// its pitch feels E as an explicit spring, which is stable up to 4.
constexpr double kStableStiffness = 0.3;
// Moves of sliding material in one step: what is left over goes on in the next.
constexpr int64_t kSlidesPerStep = 400;

/// Where a wheel presses most follows its slip over the length of its contact, and not the
/// trembling of one that stands.
void average_slip(FootprintContact& contact, const Eigen::Vector3d& velocity, double dt) {
  const Footprint& footprint = *contact.footprint;
  ContactMemory& kept = *contact.memory;
  const double over_ground = std::abs(velocity.dot(footprint.pose().linear().col(0)));
  const double faster = std::max(over_ground, std::abs(contact.motion.surface_speed));
  const double length = footprint.half().x() + footprint.radius();
  kept.slip += std::min(1.0, faster * dt / length) * (contact.motion.slip - kept.slip);
}

}  // namespace

SoilBed::SoilBed(HeightField surface, const SoilParameters& soil, const SoilOptions& options)
    : soil_(soil),
      options_(options),
      kernels_(kernels_for(options.instructions)),
      flow_(std::move(surface), soil.repose_deg,
            options.bulldozing ? Compaction{soil.compaction, soil.compaction_depth_m}
                               : Compaction{1.0, 0.0}),
      power_(soil.exponent),
      tan_friction_(portable::tan(soil.friction_deg * kDegree)),
      tan_repose_(portable::tan(soil.repose_deg * kDegree)),
      passive_(soil) {
  check_soil(soil);
  const double spacing = flow_.grid().surface().spacing_m();
  cell_area_ = spacing * spacing;
  // Even, as the permutation below needs it.
  samples_per_side_ =
      2 * std::max(1, static_cast<int>(std::ceil(0.5 * spacing / options.sample_spacing_m - 1e-9)));
  // One sample point in each row and column, N-rooks sampling (Shirley 1991): in row j it is at
  // (2 j + 1) mod (n + 1), a permutation of 0..n-1 for even n.
  const double edge = spacing / samples_per_side_;
  const auto place = [&](int i) { return 0.5 * (edge - spacing) + i * edge; };
  lattices_[kCentre] = {{0.0}, {0.0}};
  for (int j = 0; j < samples_per_side_; ++j) {
    lattices_[kOnePerRowAndColumn].x.push_back(place((2 * j + 1) % (samples_per_side_ + 1)));
    lattices_[kOnePerRowAndColumn].y.push_back(place(j));
    for (int i = 0; i < samples_per_side_; ++i) {
      lattices_[kFull].x.push_back(place(i));
      lattices_[kFull].y.push_back(place(j));
    }
  }
}

TerrainReaction SoilBed::press(const Footprint& footprint, const FootprintMotion& motion, double dt,
                               ContactMemory& memory) {
  PressingBody body;
  body.mass_kg = motion.mass_kg;
  body.centre = footprint.pose().translation();
  body.velocity = motion.velocity;
  body.omega = motion.omega;
  FootprintContact contact{&footprint, &memory, motion};
  press(body, {&contact, 1}, dt, memory.alone);
  return contact.reaction;
}

void SoilBed::press(const PressingBody& body, std::span<FootprintContact> contacts, double dt,
                    BodyMemory& memory) {
  blocks_ = 0;
  ranges_.clear();
  const bool imposed = !std::isfinite(body.mass_kg);
  const bool tilts = !body.inverse_inertia.isZero(0.0);
  bool touching = false;
  for (FootprintContact& contact : contacts) {
    const Footprint& footprint = *contact.footprint;
    ContactMemory& kept = *contact.memory;
    const Eigen::Vector3d arm = contact.arm = footprint.pose().translation() - body.centre;
    const Eigen::Vector3d velocity = body.velocity + body.omega.cross(arm);
    const Eigen::Vector3d turned = dt * (footprint.pose().linear().transpose() * body.omega);
    extend_path(footprint, velocity * dt, turned, options_.follow_slopes, kept.path);
    average_slip(contact, velocity, dt);
    double elastic = soil_.elastic_pa_per_m;
    if (footprint.extended() && !tilts && !imposed) {
      // The solver does not tilt this long footprint, so its pitch feels E explicitly.
      const double area = std::max(kept.patch_area_m2, cell_area_);
      elastic = std::min(elastic, kStableStiffness * body.mass_kg / (dt * dt * area));
    }
    ranges_.push_back(find_cells(contact, elastic, dt));
    const Range& range = ranges_.back();
    if (range.touching) {
      touching = true;
    } else {
      kept.leave();
    }
    advance_shear(range, body, contact, dt);
    if (!range.touching) continue;
    ranges_.back().reaction = reaction_law(range, body, contact, dt);
    kernels_.shear_cells(&cells_[range.begin], &springs_[range.begin], range.end - range.begin,
                         ranges_.back().reaction);
  }
  if (!touching) {
    memory = {};
    return;
  }
  solve_sinking(body, dt, {springs_.data(), blocks_}, soil_.damping_pa_s_per_m > 0.0, memory,
                kernels_);
  for (size_t i = 0; i < contacts.size(); ++i) react(ranges_[i], body, contacts[i], dt);
}

void SoilBed::end_step() {
  flow_.deposit();
  if (options_.avalanches) flow_.slide(kSlidesPerStep);
  slopes_left_ = options_.avalanches ? flow_.queued() : 0;
  flow_.uncover();
  assert(flow_.in_transit() >= 0);
  ++step_;
}

int64_t SoilBed::relax_slopes(int64_t max_moves) {
  flow_.enqueue_all();
  return flow_.slide(max_moves);
}

}  // namespace screed
