// A bed of equal spheres that a robot drives on.
#include "host_sim/physics/particles/particle_bed.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host_sim/core/errors.h"
#include "host_sim/physics/particles/solid_contact.h"

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
    0.002;                           // surface of running gear over a sleeping particle
constexpr double kHeadroom_m = 0.1;  // of the grid above the bed

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

int rays_along(double size, double spacing) {
  return std::max(2, static_cast<int>(std::lround(size / spacing)));
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

}  // namespace

ParticleBed::ParticleBed(const HeightField& top, const ParticleOptions& options,
                         const TaskProgress& progress)
    : ParticleBed(laid(top, options, progress), bed_extent(top, options.material.radius_m), 0.0,
                  options) {
  if (options_.fixed) {
    std::fill(state_.begin(), state_.end(), kAsleep);
    awake_.clear();
  } else {
    settle(kSettling_s, progress);
  }
}

ParticleBed::ParticleBed(const std::vector<Eigen::Vector3d>& centres, const BedExtent& extent,
                         double height_m, const ParticleOptions& options)
    : options_(checked(options)),
      extent_(checked(extent, options.material.radius_m)),
      law_(options.material),
      mass_(options.material.mass_kg()),
      inertia_(options.material.inertia_kg_m2()),
      window_s_(kWindow_s),
      grid_(extent.width_m, extent.depth_m, std::max(height_m, highest_of(centres) + kHeadroom_m),
            (2.0 + kSkin) * options.material.radius_m, extent.periodic),
      position_(centres),
      surface_(rays_along(extent.width_m, options.ray_spacing_m),
               rays_along(extent.depth_m,
                          extent.width_m / rays_along(extent.width_m, options.ray_spacing_m)),
               extent.width_m / rays_along(extent.width_m, options.ray_spacing_m),
               extent.periodic) {
  surface_.add_walls();  // unless it repeats
  set_up();
}

void ParticleBed::set_up() {
  const size_t n = position_.size();
  work_.elements = n;
  velocity_.assign(n, Eigen::Vector3d::Zero());
  angular_velocity_ = force_ = moment_ = velocity_;
  anchor_ = position_;
  rest_s_.assign(n, 0.0);
  state_.assign(n, kAwake);
  gear_step_.assign(n, 0);
  slots_.assign(n * kSlots, Slot{});
  grid_.resize(n);
  awake_.reserve(n);
  const size_t columns =
      static_cast<size_t>(grid_.columns_x()) * static_cast<size_t>(grid_.columns_y());
  stale_.assign(columns, 0);
  to_cast_.assign(columns, 0);
  stale_columns_.reserve(columns);
  cast_columns_.reserve(columns);
  for (size_t i = 0; i < n; ++i) {
    const auto particle = static_cast<int32_t>(i);
    grid_.insert(particle, grid_.cell_at(position_[i]));
    mark(grid_.cell_of(particle));
    awake_.push_back(particle);
  }
  // The first ray of each column.
  const auto rays = [](int count, int nodes, const auto& column_of) {
    std::vector<int> first(static_cast<size_t>(count) + 1, nodes);
    for (int i = nodes - 1; i >= 0; --i) first[static_cast<size_t>(column_of(i))] = i;
    for (int c = count - 1; c >= 0; --c) {
      first[static_cast<size_t>(c)] =
          std::min(first[static_cast<size_t>(c)], first[static_cast<size_t>(c) + 1]);
    }
    return first;
  };
  rays_x_ = rays(grid_.columns_x(), surface_.nx(),
                 [&](int i) { return grid_.column_x(surface_.node_x(i)); });
  rays_y_ = rays(grid_.columns_y(), surface_.ny(),
                 [&](int i) { return grid_.column_y(surface_.node_y(i)); });
}

Eigen::Vector3d ParticleBed::between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
  Eigen::Vector3d separation = to - from;
  if (extent_.periodic) {
    separation.x() -= extent_.width_m * std::round(separation.x() / extent_.width_m);
    separation.y() -= extent_.depth_m * std::round(separation.y() / extent_.depth_m);
  }
  return separation;
}

SphereSet ParticleBed::spheres() const {
  SphereSet set;
  set.radius_m = options_.material.radius_m;
  set.centers_m.reserve(position_.size());
  for (const Eigen::Vector3d& at : position_) {
    set.centers_m.push_back(
        {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z())});
  }
  return set;
}

BedBounds ParticleBed::bounds() const {
  return {extent_.width_m, extent_.depth_m,
          extent_.periodic ? BedEdge::kWrapped : BedEdge::kWalled};
}

// ---- sleep
// ---------------------------------------------------------------------------------------

void ParticleBed::wake(int32_t particle) {
  const auto i = static_cast<size_t>(particle);
  if (state_[i] == kAwake || options_.fixed) return;
  state_[i] = kAwake;
  rest_s_[i] = 0.0;
  awake_.push_back(particle);
  pairs_stale_ = true;
}

void ParticleBed::wake_near(int32_t particle) {
  const Eigen::Vector3d& here = position_[static_cast<size_t>(particle)];
  const double near = (2.0 + kTouching) * options_.material.radius_m;
  grid_.visit_near(here, near, [&](int32_t other) {
    const auto j = static_cast<size_t>(other);
    if (state_[j] == kAsleep && between(here, position_[j]).squaredNorm() < near * near)
      wake(other);
  });
}

void ParticleBed::wake_all() {
  for (size_t i = 0; i < size(); ++i) wake(static_cast<int32_t>(i));
  std::fill(rest_s_.begin(), rest_s_.end(), 0.0);
}

void ParticleBed::set_motion(size_t particle, const Eigen::Vector3d& velocity,
                             const Eigen::Vector3d& angular_velocity) {
  wake(static_cast<int32_t>(particle));
  velocity_[particle] = velocity;
  angular_velocity_[particle] = angular_velocity;
}

// ---- what contacts remember
// ----------------------------------------------------------------------

ParticleBed::Slot* ParticleBed::slot_of(int32_t particle, int32_t partner) {
  Slot* const begin = &slots_[static_cast<size_t>(particle) * kSlots];
  Slot* const found = std::find_if(begin, begin + kSlots,
                                   [&](const Slot& slot) { return slot.partner == partner; });
  return found == begin + kSlots ? nullptr : found;
}

ParticleBed::Slot* ParticleBed::take_slot(int32_t particle, int32_t partner) {
  Slot* slot = slot_of(particle, partner);
  if (slot != nullptr) return slot;
  slot = slot_of(particle, kNoPartner);
  if (slot != nullptr) *slot = {partner, {}};
  return slot;
}

// ---- a step
// --------------------------------------------------------------------------------------

void ParticleBed::find_pairs() {
  std::sort(awake_.begin(), awake_.end());
  pairs_.clear();
  const double near = (2.0 + kSkin) * options_.material.radius_m;
  for (const int32_t particle : awake_) {
    const Eigen::Vector3d& here = position_[static_cast<size_t>(particle)];
    grid_.visit_near(here, near, [&](int32_t other) {
      const auto j = static_cast<size_t>(other);
      if (other == particle || (other < particle && state_[j] == kAwake)) return;
      if (between(here, position_[j]).squaredNorm() >= near * near) return;
      const int32_t a = std::min(particle, other);
      const int32_t b = std::max(particle, other);
      const Slot* slot = slot_of(a, b);
      pairs_.push_back({a, b,
                        slot == nullptr ? -1
                                        : static_cast<int32_t>(
                                              slot - &slots_[static_cast<size_t>(a) * kSlots])});
    });
  }
  pairs_stale_ = false;
  travelled_ = 0.0;
}

void ParticleBed::collide_pairs(double dt) {
  const double diameter = 2.0 * options_.material.radius_m;
  for (ContactPair& pair : pairs_) {
    const auto a = static_cast<size_t>(pair.a);
    const auto b = static_cast<size_t>(pair.b);
    Slot* const slots = &slots_[a * kSlots];
    const Eigen::Vector3d separation = between(position_[b], position_[a]);
    const double square = separation.squaredNorm();
    if (square >= diameter * diameter || square == 0.0) {
      if (pair.slot >= 0) slots[pair.slot] = {};
      pair.slot = -1;
      continue;
    }
    if (state_[a] == kAsleep && state_[b] == kAsleep) continue;
    if (pair.slot < 0) {
      const Slot* slot = take_slot(pair.a, pair.b);
      pair.slot = slot == nullptr ? -1 : static_cast<int32_t>(slot - slots);
    }
    const double distance = std::sqrt(square);
    SphereContact contact;
    contact.normal = separation / distance;
    contact.overlap = diameter - distance;
    contact.velocity =
        velocity_[a] - velocity_[b] -
        0.5 * distance * (angular_velocity_[a] + angular_velocity_[b]).cross(contact.normal);
    contact.angular_velocity = angular_velocity_[a] - angular_velocity_[b];
    ContactBristle passing{};
    const SphereForce push = law_.force(contact, options_.material.friction, dt,
                                        pair.slot >= 0 ? slots[pair.slot].bristle : passing);
    const Eigen::Vector3d turning = -0.5 * distance * contact.normal.cross(push.force);
    if (state_[a] == kAwake) {
      force_[a] += push.force;
      moment_[a] += turning + push.moment;
    }
    if (state_[b] == kAwake) {
      force_[b] -= push.force;
      moment_[b] += turning - push.moment;
    }
  }
}

void ParticleBed::collide_wall(int32_t particle, int32_t wall, const Eigen::Vector3d& normal,
                               double distance, double dt) {
  const auto i = static_cast<size_t>(particle);
  if (distance >= options_.material.radius_m) {
    Slot* const slot = slot_of(particle, wall);
    if (slot != nullptr) *slot = {};
    return;
  }
  SphereContact contact;
  contact.normal = normal;
  contact.overlap = options_.material.radius_m - distance;
  contact.velocity = velocity_[i] - distance * angular_velocity_[i].cross(normal);
  contact.angular_velocity = angular_velocity_[i];
  ContactBristle passing{};
  Slot* const slot = take_slot(particle, wall);
  const SphereForce push = law_.force(contact, options_.material.friction, dt,
                                      slot == nullptr ? passing : slot->bristle);
  force_[i] += push.force;
  moment_[i] += push.moment - distance * normal.cross(push.force);
}

void ParticleBed::collide_walls(double dt) {
  const double near = (1.0 + kSkin) * options_.material.radius_m;
  const double half_x = 0.5 * extent_.width_m;
  const double half_y = 0.5 * extent_.depth_m;
  for (const int32_t particle : awake_) {
    const Eigen::Vector3d at = position_[static_cast<size_t>(particle)];
    const auto wall = [&](int number, const Eigen::Vector3d& normal, double distance) {
      if (distance < near) collide_wall(particle, kFloor - number, normal, distance, dt);
    };
    wall(0, Eigen::Vector3d::UnitZ(), at.z());
    if (extent_.periodic) continue;
    wall(1, Eigen::Vector3d::UnitX(), at.x() + half_x);
    wall(2, -Eigen::Vector3d::UnitX(), half_x - at.x());
    wall(3, Eigen::Vector3d::UnitY(), at.y() + half_y);
    wall(4, -Eigen::Vector3d::UnitY(), half_y - at.y());
  }
}

void ParticleBed::move(double dt) {
  const double wake_distance = kWakeThreshold * options_.material.radius_m;
  const double kept_share = std::max(0.0, 1.0 - drag_ * dt);
  double fastest2 = 0.0;
  size_t kept = 0;
  const size_t movers = awake_.size();
  for (size_t k = 0; k < movers; ++k) {
    const int32_t particle = awake_[k];
    const auto i = static_cast<size_t>(particle);
    velocity_[i] = kept_share * (velocity_[i] + dt * (force_[i] / mass_ + options_.gravity));
    angular_velocity_[i] = kept_share * (angular_velocity_[i] + dt * (moment_[i] / inertia_));
    force_[i].setZero();
    moment_[i].setZero();
    Eigen::Vector3d& at = position_[i];
    at += dt * velocity_[i];
    if (extent_.periodic) {
      at.x() -= extent_.width_m * std::floor(at.x() / extent_.width_m + 0.5);
      at.y() -= extent_.depth_m * std::floor(at.y() / extent_.depth_m + 0.5);
    }
    fastest2 = std::max(fastest2, velocity_[i].squaredNorm());
    const int32_t cell = grid_.cell_at(at);
    mark(grid_.cell_of(particle));
    if (cell != grid_.cell_of(particle)) {
      grid_.remove(particle);
      grid_.insert(particle, cell);
      mark(cell);
    }
    if (between(anchor_[i], at).squaredNorm() > wake_distance * wake_distance) {
      anchor_[i] = at;
      rest_s_[i] = 0.0;
      wake_near(particle);
    } else if ((rest_s_[i] += dt) >= window_s_) {
      // A sphere that spins in its place is not at rest.
      if (angular_velocity_[i].norm() * options_.material.radius_m * window_s_ <= wake_distance) {
        state_[i] = kAsleep;
        velocity_[i].setZero();
        angular_velocity_[i].setZero();
        continue;
      }
      rest_s_[i] = 0.0;
    }
    awake_[kept++] = particle;
  }
  for (size_t k = movers; k < awake_.size(); ++k) awake_[kept++] = awake_[k];
  awake_.resize(kept);
  travelled_ += std::sqrt(fastest2) * dt;
}

void ParticleBed::step(double dt) {
  release_gear();
  if (pairs_stale_ || 2.0 * travelled_ > kSkin * options_.material.radius_m) find_pairs();
  work_.awake = awake_.size();
  work_.contacts = pairs_.size();
  work_.element_steps += awake_.size();
  ++work_.steps;
  collide_pairs(dt);
  collide_walls(dt);
  move(dt);
  ++steps_;
}

double ParticleBed::settle(double max_s, const TaskProgress& progress) {
  const double dt = longest_step_s();
  drag_ = kSettlingDrag;
  window_s_ = kSettlingWindow_s;
  double time = 0.0;
  double share = 0.0;  // of the time, or of the particles that sleep: it ends with either
  for (; time < max_s && !awake_.empty(); time += dt) {
    const double asleep =
        1.0 - static_cast<double>(awake_.size()) / static_cast<double>(position_.size());
    share = std::max({share, time / max_s, asleep});
    report_progress(progress, "settling particles", share);
    step(dt);
  }
  drag_ = 0.0;
  window_s_ = kWindow_s;
  work_.awake = awake_.size();
  return time;
}

// ---- running gear
// --------------------------------------------------------------------------------

int32_t ParticleBed::gear_number(const Footprint* solid) {
  auto at = std::find(gear_.begin(), gear_.end(), solid);
  if (at == gear_.end()) at = gear_.insert(at, solid);
  return kGear - static_cast<int32_t>(at - gear_.begin());
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
  const int32_t gear = gear_number(&solid);
  Eigen::Vector3d reach;
  reach << solid.reach(), solid.reach_down();
  reach.array() += radius;
  TerrainReaction reaction;
  grid_.visit_box(centre - reach, centre + reach, [&](int32_t particle) {
    const auto i = static_cast<size_t>(particle);
    const SolidContact near = nearest_on(solid, axes.transpose() * between(centre, position_[i]));
    if (near.distance >= radius) {
      if (gear_step_[i] + 1 >= steps_) {
        Slot* const slot = slot_of(particle, gear);
        if (slot != nullptr) *slot = {};
      }
      return;
    }
    const Eigen::Vector3d arm = axes * near.surface;
    const Eigen::Vector3d belt = axes * near.belt;
    SphereContact contact;
    contact.normal = axes * near.normal;
    contact.overlap = std::min(radius - near.distance, radius);
    contact.velocity = velocity_[i] - near.distance * angular_velocity_[i].cross(contact.normal) -
                       motion.velocity - motion.omega.cross(arm) - motion.surface_speed * belt;
    contact.angular_velocity = angular_velocity_[i] - motion.omega;
    if (contact.velocity.squaredNorm() > kGearWakeSpeed_m_per_s * kGearWakeSpeed_m_per_s)
      wake(particle);
    if (gear_step_[i] != steps_) {
      gear_step_[i] = steps_;
      pressed_.push_back(particle);
    }
    ContactBristle passing{};
    Slot* const slot = take_slot(particle, gear);
    const SphereForce push =
        law_.force(contact, motion.friction, dt, slot == nullptr ? passing : slot->bristle);
    if (state_[i] == kAwake) {
      force_[i] += push.force;
      moment_[i] += push.moment - near.distance * contact.normal.cross(push.force);
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
    for (int k = 0; k < kSlots; ++k) {
      Slot& slot = slots_[static_cast<size_t>(particle) * kSlots + static_cast<size_t>(k)];
      if (slot.partner <= kGear) slot = {};
    }
    wake(particle);
  }
  was_pressed_.swap(pressed_);
  pressed_.clear();
}

// ---- height map
// ----------------------------------------------------------------------------------

void ParticleBed::mark(int32_t cell) {
  const size_t column = grid_.column_of_cell(cell);
  if (stale_[column] != 0) return;
  stale_[column] = 1;
  stale_columns_.push_back(static_cast<int32_t>(column));
}

const HeightField& ParticleBed::surface() const {
  // A particle reaches into the columns beside its own.
  for (const int32_t column : stale_columns_) {
    stale_[static_cast<size_t>(column)] = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        int ix = column % grid_.columns_x() + dx;
        int iy = column / grid_.columns_x() + dy;
        if (!grid_.wrap(ix, iy)) continue;
        const size_t beside = grid_.column(ix, iy);
        if (to_cast_[beside] != 0) continue;
        to_cast_[beside] = 1;
        cast_columns_.push_back(static_cast<int32_t>(beside));
      }
    }
  }
  stale_columns_.clear();
  for (const int32_t column : cast_columns_) {
    to_cast_[static_cast<size_t>(column)] = 0;
    cast_rays(column % grid_.columns_x(), column / grid_.columns_x());
  }
  cast_columns_.clear();
  return surface_;
}

void ParticleBed::cast_rays(int column_x, int column_y) const {
  const double radius = options_.material.radius_m;
  for (int ry = rays_y_[static_cast<size_t>(column_y)];
       ry < rays_y_[static_cast<size_t>(column_y) + 1]; ++ry) {
    for (int rx = rays_x_[static_cast<size_t>(column_x)];
         rx < rays_x_[static_cast<size_t>(column_x) + 1]; ++rx) {
      const Eigen::Vector3d ray(surface_.node_x(rx), surface_.node_y(ry), 0.0);
      double height = 0.0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          int ix = column_x + dx;
          int iy = column_y + dy;
          if (!grid_.wrap(ix, iy)) continue;
          for (int layer = grid_.layers() - 1; layer >= 0; --layer) {
            // The highest layer has no upper side.
            if (layer + 1 < grid_.layers() && grid_.layer_top(layer) + radius <= height) break;
            for (int32_t particle = grid_.first(grid_.cell(ix, iy, layer));
                 particle != SphereGrid::kNone; particle = grid_.next(particle)) {
              const Eigen::Vector3d to = between(ray, position_[static_cast<size_t>(particle)]);
              const double discriminant = radius * radius - to.x() * to.x() - to.y() * to.y();
              if (discriminant > 0.0) height = std::max(height, to.z() + std::sqrt(discriminant));
            }
          }
        }
      }
      surface_.set_node(rx, ry, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
}

}  // namespace screed
