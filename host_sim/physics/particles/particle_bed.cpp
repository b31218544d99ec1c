// A bed of equal spheres that a robot drives on.
#include "host_sim/physics/particles/particle_bed.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/solid_contact.h"

namespace screed {
namespace {

// Lengths in radii.
constexpr double kSkin = 0.1;            // pairs this near to touching are kept in the list
constexpr double kWakeThreshold = 0.02;  // a move that wakes the neighbours
constexpr double kTouching = 0.02;       // a gap across which a neighbour is one

constexpr double kWindow_s = 0.2;           // at rest this long: asleep
constexpr double kSettlingWindow_s = 0.05;  // while a new bed settles
constexpr double kSettlingDrag = 20.0;      // 1/s
constexpr double kSettling_s = 2.0;         // at most
constexpr double kGearWakeSpeed_m_per_s =
    0.002;                               // surface of running gear over a sleeping particle
constexpr double kHeadroom_m = 0.1;      // of the grid above the bed
constexpr double kNearestToWall = 1e-3;  // of a centre, in radii: no force is greater than there

struct Range {
  const char* name;
  double lowest;
  double highest;
};

void require(const Range& range, double value) {
  if (value >= range.lowest && value <= range.highest) return;  // false for what is no number
  std::ostringstream message;
  message << "particles: " << range.name << " = " << value << "; allowed: " << range.lowest
          << " to " << range.highest;
  throw InputError(message.str());
}

const ParticleOptions& checked(const ParticleOptions& options) {
  const ParticleMaterial& m = options.material;
  require({"radius_m", 0.001, 0.5}, m.radius_m);
  require({"density_kg_per_m3", 10.0, 20000.0}, m.density_kg_per_m3);
  require({"friction", 0.0, 5.0}, m.friction);
  require({"rolling", 0.0, 5.0}, m.rolling);
  require({"stiffness_pa", 1e3, 1e9}, m.stiffness_pa);
  require({"damping_ratio", 0.0, 1.0}, m.damping_ratio);
  require({"ray_spacing_m", 1e-4, 1.0}, options.ray_spacing_m);
  require({"threads", 1, kMaxBedThreads}, options.threads);
  return options;
}

BedExtent checked(const BedExtent& extent, double radius) {
  // A repeating bed must be wide enough that a particle meets each neighbour once.
  if (extent.periodic) {
    require({"width_m", 10.0 * radius, 1e6}, extent.width_m);
    require({"depth_m", 10.0 * radius, 1e6}, extent.depth_m);
  }
  return extent;
}

double highest_of(const std::vector<Eigen::Vector3d>& centres) {
  double highest = 0.0;
  for (const Eigen::Vector3d& centre : centres) highest = std::max(highest, centre.z());
  return highest;
}

std::vector<Eigen::Vector3d> laid(const HeightField& top, const ParticleOptions& options,
                                  const TaskProgress& progress) {
  const double radius = checked(options).material.radius_m;
  const BedExtent extent = checked(bed_extent(top, radius), radius);
  return lay_spheres(stack_counts(top, extent, radius), extent, radius, options.seed, progress);
}

void add(const PushRow& push, PushRow& to) {
  for (int axis = 0; axis < 3; ++axis) {
    to.force[axis] += push.force[axis];
    to.moment[axis] += push.moment[axis];
  }
}

}  // namespace

ParticleBed::ParticleBed(const HeightField& top, const ParticleOptions& options,
                         const TaskProgress& progress)
    : ParticleBed(laid(top, options, progress), bed_extent(top, options.material.radius_m), 0.0,
                  options) {
  if (!options_.fixed) settle(kSettling_s, progress);
}

ParticleBed::ParticleBed(const std::vector<Eigen::Vector3d>& centres, const BedExtent& extent,
                         double height_m, const ParticleOptions& options)
    : options_(checked(options)),
      extent_(checked(extent, options.material.radius_m)),
      law_(options.material),
      kernel_(bed_functions(options.instructions)),
      window_s_(kWindow_s),
      grid_(extent.width_m, extent.depth_m, std::max(height_m, highest_of(centres) + kHeadroom_m),
            (2.0 + kSkin) * options.material.radius_m, extent.periodic,
            kWakeThreshold * options.material.radius_m),
      particles_(centres),
      groups_(extent, (2.0 + kSkin) * options.material.radius_m, particles_.groups,
              particles_.size),
      team_(options.threads),
      pushes_(static_cast<size_t>(options.threads)),
      surface_(extent, options.ray_spacing_m, options.material.radius_m, grid_) {
  work_.elements = size();
  store_.resize(size());
  gear_step_.assign(size(), 0);
  grid_.resize(size());
  for (size_t i = 0; i < size(); ++i) {
    const auto particle = static_cast<int32_t>(i);
    grid_.insert(particle, grid_.cell_at(particles_.at(particle)));
    surface_.mark(grid_, grid_.cell_of(particle));
    wake(particle);
  }
}

SphereSet ParticleBed::spheres() const {
  SphereSet set;
  set.radius_m = options_.material.radius_m;
  set.centers_m.reserve(size());
  for (size_t i = 0; i < size(); ++i) {
    const Eigen::Vector3d at = position(i);
    set.centers_m.push_back(
        {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z())});
  }
  return set;
}

BedBounds ParticleBed::bounds() const {
  return {extent_.width_m, extent_.depth_m,
          extent_.periodic ? BedEdge::kWrapped : BedEdge::kWalled};
}

const HeightField& ParticleBed::surface() const {
  for (const int32_t group : groups_.active()) {
    for (const int32_t particle : groups_.group(group).awake) {
      surface_.mark(grid_, grid_.cell_of(particle));
    }
  }
  surface_.cast(grid_, particles_);
  return surface_.field();
}

// ---- sleep
// ---------------------------------------------------------------------------------------

void ParticleBed::wake(int32_t particle) {
  if (particles_.awake(particle) || options_.fixed) return;
  particles_.set_awake(particle, true, now_s_);
  groups_.wake(particle);
}

void ParticleBed::wake_near(int32_t particle) {
  if (groups_.awake() == size()) return;
  const Eigen::Vector3d here = particles_.at(particle);
  const double near = (2.0 + kTouching) * options_.material.radius_m;
  grid_.visit_near(here, near, [&](int32_t other) {
    if (!particles_.awake(other) &&
        between(extent_, here, particles_.at(other)).squaredNorm() < near * near) {
      wake(other);
    }
  });
}

void ParticleBed::wake_all() {
  for (size_t i = 0; i < size(); ++i) {
    wake(static_cast<int32_t>(i));
    particles_.motion[i].since_s = now_s_;
  }
}

void ParticleBed::set_motion(size_t particle, const Eigen::Vector3d& velocity,
                             const Eigen::Vector3d& angular_velocity) {
  wake(static_cast<int32_t>(particle));
  for (int axis = 0; axis < 3; ++axis) {
    particles_.motion[particle].velocity[axis] = velocity[axis];
    particles_.motion[particle].spin[axis] = angular_velocity[axis];
  }
}

// ---- a step
// --------------------------------------------------------------------------------------

void ParticleBed::set_constants(double dt) {
  StepConstants& c = constants_;
  const ParticleMaterial& material = options_.material;
  const double extents[3] = {extent_.width_m, extent_.depth_m, 0.0};
  const double kept = std::max(0.0, 1.0 - drag_ * dt);
  for (int axis = 0; axis < 3; ++axis) {
    const bool repeats = extent_.periodic && axis < 2;
    c.period[axis] = repeats ? extents[axis] : 0.0;
    c.frequency[axis] = repeats ? 1.0 / extents[axis] : 0.0;
    c.dt_row[axis] = dt;
    c.kept[axis] = c.kept[axis + 4] = kept;
    c.per_push[axis] = dt / material.mass_kg();
    c.per_push[axis + 4] = dt / material.inertia_kg_m2();
    c.pull[axis] = dt * options_.gravity[axis];
  }
  c.kept[3] = c.kept[7] = 1.0;
  for (size_t wall = 0; wall < kBedWalls; ++wall) {
    const double normal = wall_distance(extent_, wall, Eigen::Vector3d::Ones()) -
                          wall_distance(extent_, wall, Eigen::Vector3d::Zero());
    const size_t axis = wall == 0 ? 2 : (wall - 1) / 2;
    c.walls[wall] = {};
    c.walls[wall].normal[axis] = normal > 0.0 ? 1.0 : -1.0;
    c.walls[wall].point[axis] = axis == 2 ? 0.0 : (normal > 0.0 ? -0.5 : 0.5) * extents[axis];
    c.walls[wall].nearest[axis] = kNearestToWall * material.radius_m;
  }
  c.law = law_.single_precision();
  c.dt = static_cast<float>(dt);
  c.diameter = static_cast<float>(2.0 * material.radius_m);
  c.friction = static_cast<float>(material.friction);
  c.periodic = extent_.periodic;
  c.nobody = particles_.nobody();
  c.noticed_m = kWakeThreshold * material.radius_m;
}

void ParticleBed::step(double dt) {
  release_gear();
  if (groups_.stale() || 2.0 * travelled_ > kSkin * options_.material.radius_m) {
    groups_.find(particles_, grid_, store_, team_);
    travelled_ = 0.0;
  }
  work_.awake = groups_.awake();
  work_.contacts = groups_.contacts();
  work_.element_steps += work_.awake;
  ++work_.steps;
  set_constants(dt);
  now_s_ += dt;
  constants_.rested_since_s = now_s_ - window_s_;
  compute_groups();
  double fastest2 = 0.0;
  for (const int32_t number : groups_.active()) {
    fastest2 = std::max(fastest2, groups_.group(number).report.fastest2);
  }
  travelled_ += std::sqrt(fastest2) * dt;
  settle_rested();
  follow_moved();
  ++steps_;
}

/// Contacts and motion. Particles that only their own group pushes on move with it, while they are
/// in the cache; the others when all groups have pushed.
void ParticleBed::compute_groups() {
  for (std::vector<PushRow>& pushes : pushes_) {
    if (pushes.size() < groups_.push_rows()) pushes.resize(groups_.push_rows());
  }
  const std::vector<int32_t>& active = groups_.active();
  team_.run(active.size(),
            [&](size_t i, size_t member) { push_group(active[i], pushes_[member]); });
  team_.run(active.size(), [&](size_t i, size_t member) { move_edge(active[i], pushes_[member]); });
}

BedRows ParticleBed::rows(int32_t group, std::vector<PushRow>& pushes) {
  return {particles_.place.data(), particles_.motion.data(), particles_.anchor.data(),
          pushes.data(), base_of(static_cast<size_t>(group))};
}

void ParticleBed::push_group(int32_t number, std::vector<PushRow>& pushes) {
  ParticleGroup& group = groups_.group(number);
  const BedRows rows = this->rows(number, pushes);
  const auto push_of = [&](int32_t particle) -> PushRow& {
    return rows.push[particle - rows.base];
  };
  for (const OuterPush& outer : group.outer) add(outer.push, push_of(outer.particle));
  group.outer.clear();
  std::vector<ContactPacket>& pairs = group.pairs.packets();
  std::vector<ContactPacket>& walls = group.walls.packets();
  kernel_.collide_pairs(rows, constants_, pairs.data(), pairs.size());
  kernel_.collide_walls(rows, constants_, walls.data(), walls.size());
  group.report = {group.moved.data(), 0, group.rested.data(), 0, 0.0};
  kernel_.move(rows, constants_, group.inner.data(), group.inner.size(), group.report);
  // What is left goes to where it waits for the other groups, or to nobody.
  for (size_t k = 0; k < group.edge.size(); ++k) {
    group.edge_push[k] = std::exchange(push_of(group.edge[k]), PushRow{});
  }
  for (size_t k = 0; k < group.foreign; ++k) {
    group.foreign_push[k] = std::exchange(pushes[kFirstForeignPush + k], PushRow{});
  }
  for (const int32_t particle : group.slept) push_of(particle) = {};
  pushes[kNobodysPush] = {};
}

void ParticleBed::move_edge(int32_t number, std::vector<PushRow>& pushes) {
  ParticleGroup& group = groups_.group(number);
  const BedRows rows = this->rows(number, pushes);
  const auto push_of = [&](int32_t particle) -> PushRow& {
    return rows.push[particle - rows.base];
  };
  for (size_t k = 0; k < group.edge.size(); ++k) push_of(group.edge[k]) = group.edge_push[k];
  for (const PushAcross& across : group.across) {
    const ParticleGroup& from = groups_.group(across.group);
    add(from.foreign_push[static_cast<size_t>(across.row)], push_of(across.particle));
  }
  kernel_.move(rows, constants_, group.edge.data(), group.edge.size(), group.report);
  for (const int32_t particle : group.slept) push_of(particle) = {};
}

/// Puts to sleep who has rested long enough.
void ParticleBed::settle_rested() {
  const double slow = kWakeThreshold / window_s_;  // rad/s
  bool any = false;
  for (const int32_t number : groups_.active()) {
    MotionReport& report = groups_.group(number).report;
    for (size_t k = 0; k < report.rested_count; ++k) {
      const auto i = static_cast<size_t>(report.rested[k]);
      // A sphere that spins in its place is not at rest.
      if (angular_velocity(i).norm() > slow) {
        particles_.motion[i].since_s = now_s_;
        continue;
      }
      particles_.set_awake(report.rested[k], false, now_s_);
      surface_.mark(grid_, grid_.cell_of(report.rested[k]));
      any = true;
    }
  }
  if (any) groups_.remove_sleepers(particles_);
}

/// Those who have moved noticeably wake their neighbours, and the grid learns where they are.
void ParticleBed::follow_moved() {
  for (const int32_t number : groups_.active()) {
    const MotionReport& report = groups_.group(number).report;
    for (size_t k = 0; k < report.moved_count; ++k) {
      const int32_t particle = report.moved[k];
      const auto i = static_cast<size_t>(particle);
      for (int axis = 0; axis < 3; ++axis) {
        particles_.anchor[i].at[axis] = particles_.place[i].at[axis];
      }
      particles_.place[i].strayed = 0.0;
      particles_.motion[i].since_s = now_s_;
      const int32_t before = grid_.cell_of(particle);
      const int32_t cell = grid_.cell_at(particles_.at(particle));
      if (cell != before) {
        surface_.mark(grid_, before);
        grid_.remove(particle);
        grid_.insert(particle, cell);
        surface_.mark(grid_, cell);
      }
      wake_near(particle);
    }
  }
}

double ParticleBed::settle(double max_s, const TaskProgress& progress) {
  const double dt = longest_step_s();
  drag_ = kSettlingDrag;
  window_s_ = kSettlingWindow_s;
  double time = 0.0;
  double share = 0.0;  // of the time, or of the particles that sleep: it ends with either
  for (; time < max_s && groups_.awake() > 0; time += dt) {
    const double asleep = 1.0 - static_cast<double>(groups_.awake()) / static_cast<double>(size());
    share = std::max({share, time / max_s, asleep});
    report_progress(progress, "settling particles", share);
    step(dt);
  }
  drag_ = 0.0;
  window_s_ = kWindow_s;
  work_.awake = groups_.awake();
  return time;
}

// ---- running gear
// --------------------------------------------------------------------------------

int32_t ParticleBed::gear_partner(const Footprint* solid) {
  auto at = std::find(gear_.begin(), gear_.end(), solid);
  if (at == gear_.end()) at = gear_.insert(at, solid);
  return kGearPartner - static_cast<int32_t>(at - gear_.begin());
}

void ParticleBed::press(const PressingBody& /*body*/, std::span<FootprintContact> contacts,
                        double dt, BodyMemory& /*memory*/) {
  for (FootprintContact& contact : contacts) {
    contact.reaction = press(*contact.footprint, contact.motion, dt);
  }
}

ContactStiffness ParticleBed::contact_stiffness() const {
  const ParticleMaterial& material = options_.material;
  const double stiffness = material.stiffness_n_per_m();
  return {stiffness, 2.0 * material.damping_ratio * std::sqrt(stiffness * material.mass_kg())};
}

TerrainReaction ParticleBed::press(const Footprint& solid, const FootprintMotion& motion,
                                   double dt) {
  const double radius = options_.material.radius_m;
  const Eigen::Vector3d centre = solid.pose().translation();
  const Eigen::Matrix3d& axes = solid.pose().linear();
  const int32_t gear = gear_partner(&solid);
  Eigen::Vector3d reach;
  reach << solid.reach(), solid.reach_down();
  reach.array() += radius;
  TerrainReaction reaction;
  grid_.visit_box(centre - reach, centre + reach, [&](int32_t particle) {
    const auto i = static_cast<size_t>(particle);
    const SolidContact near =
        nearest_on(solid, axes.transpose() * between(extent_, centre, particles_.at(particle)));
    if (near.distance >= radius) {
      if (gear_step_[i] + 1 >= steps_) store_.forget(particle, gear);
      return;
    }
    const Eigen::Vector3d arm = axes * near.surface;
    const Eigen::Vector3d belt = axes * near.belt;
    SphereContact contact;
    contact.normal = axes * near.normal;
    contact.overlap = std::min(radius - near.distance, radius);
    contact.velocity = velocity(i) - near.distance * angular_velocity(i).cross(contact.normal) -
                       motion.velocity - motion.omega.cross(arm) - motion.surface_speed * belt;
    contact.angular_velocity = angular_velocity(i) - motion.omega;
    if (contact.velocity.squaredNorm() > kGearWakeSpeed_m_per_s * kGearWakeSpeed_m_per_s)
      wake(particle);
    if (gear_step_[i] != steps_) {
      gear_step_[i] = steps_;
      pressed_.push_back(particle);
    }
    ContactBristle passing{};
    ContactBristle* const kept = store_.take(particle, gear);
    const SphereForce push =
        law_.force(contact, motion.friction, dt, kept == nullptr ? passing : *kept);
    if (particles_.awake(particle)) {
      const Eigen::Vector3d moment = push.moment - near.distance * contact.normal.cross(push.force);
      const Eigen::Vector3d& force = push.force;
      groups_.group(static_cast<int32_t>(group_of(particle)))
          .outer.push_back({particle,
                            {{force.x(), force.y(), force.z()},
                             0.0,
                             {moment.x(), moment.y(), moment.z()},
                             0.0}});
    }
    reaction.force -= push.force;
    reaction.torque -= arm.cross(push.force) + push.moment;
    reaction.along_surface -= push.force.dot(belt);
    reaction.normal_load -= push.force.z();
  });
  return reaction;
}

/// Particles that running gear has left are no longer held by it.
void ParticleBed::release_gear() {
  for (const int32_t particle : was_pressed_) {
    if (gear_step_[static_cast<size_t>(particle)] == steps_) continue;
    store_.forget_gear(particle);
    wake(particle);
  }
  was_pressed_.swap(pressed_);
  pressed_.clear();
}

}  // namespace screed
