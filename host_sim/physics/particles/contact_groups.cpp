// Lists of who is awake and of contacts to compute.
#include "host_sim/physics/particles/contact_groups.h"

#include <Eigen/Core>
#include <algorithm>
#include <iterator>
#include <utility>

namespace screed {

namespace {

// Lists are renewed when fewer than this share of those they were made for are awake.
constexpr double kStillAwake = 0.75;

bool is_none(const ContactBristle& bristle) {
  return std::all_of(bristle.slide, bristle.slide + 3, [](float a) { return a == 0.0F; }) &&
         std::all_of(bristle.roll, bristle.roll + 3, [](float a) { return a == 0.0F; });
}

/// Who remembers a contact: the lower number, as its own motion against the other's. Of a first
/// particle with the higher number everything is the other way round.
struct Memory {
  int32_t owner;
  int32_t partner;
  float sign;
};

Memory memory_of(int32_t first, int32_t second) {
  if (first < second) return {first, second, 1.0F};
  return {second, first, -1.0F};
}

Memory memory_of_wall(int32_t first, int32_t wall) {
  return {first, kFloorPartner - wall, 1.0F};
}

using MemoryOf = Memory (*)(int32_t, int32_t);

void put_into(ContactStore& store, const ContactList& list, size_t i, MemoryOf memory_of_contact) {
  const Memory memory = memory_of_contact(list.first(i), list.second(i));
  const ContactBristle bristle = list.bristle(i, memory.sign);
  if (is_none(bristle)) return;
  ContactBristle* const kept = store.take(memory.owner, memory.partner);
  if (kept != nullptr) *kept = bristle;
}

void take_from(ContactStore& store, ContactList& list, size_t i, MemoryOf memory_of_contact) {
  const Memory memory = memory_of_contact(list.first(i), list.second(i));
  const ContactBristle* const kept = store.find(memory.owner, memory.partner);
  if (kept == nullptr) return;
  list.set_bristle(i, *kept, memory.sign);
  store.forget(memory.owner, memory.partner);
}

/// The contacts that a list had before: their first particles count up, and one asks for them in
/// this order.
class Before {
 public:
  explicit Before(const ContactList& list) : list_(list) {}

  void go_to(int32_t first) {
    while (begin_ < list_.size() && list_.first(begin_) < first) ++begin_;
  }
  /// Copies the state of the contact with this second, if there was one, to the last of `list`.
  bool copy_to(ContactList& list, int32_t first, int32_t second) const {
    for (size_t i = begin_; i < list_.size() && list_.first(i) == first; ++i) {
      if (list_.second(i) != second) continue;
      list.set_bristle(list.size() - 1, list_.bristle(i, 1.0F), 1.0F);
      return true;
    }
    return false;
  }

 private:
  const ContactList& list_;
  size_t begin_ = 0;
};

}  // namespace

void ContactList::add(int32_t first, int32_t second) {
  const size_t k = count_ % kPacketContacts;
  if (k == 0) {
    ContactPacket& packet = packets_.emplace_back();
    std::fill(packet.target, packet.target + kPacketContacts, static_cast<uint16_t>(kNobodysPush));
    std::fill(packet.second, packet.second + kPacketContacts, no_partner_);
  }
  packets_.back().first[k] = static_cast<uint16_t>(first - base_);
  packets_.back().second[k] = second;
  ++count_;
}

ContactBristle ContactList::bristle(size_t i, float sign) const {
  const ContactPacket& packet = packets_[i / kPacketContacts];
  const size_t k = i % kPacketContacts;
  ContactBristle bristle;
  for (size_t axis = 0; axis < 3; ++axis) {
    bristle.slide[axis] = sign * packet.slide[axis][k];
    bristle.roll[axis] = sign * packet.roll[axis][k];
  }
  return bristle;
}

void ContactList::set_bristle(size_t i, const ContactBristle& bristle, float sign) {
  ContactPacket& packet = packets_[i / kPacketContacts];
  const size_t k = i % kPacketContacts;
  for (size_t axis = 0; axis < 3; ++axis) {
    packet.slide[axis][k] = sign * bristle.slide[axis];
    packet.roll[axis][k] = sign * bristle.roll[axis];
  }
}

void ContactList::swap(ContactList& other) {
  std::swap(packets_, other.packets_);
  std::swap(count_, other.count_);
  std::swap(base_, other.base_);
  std::swap(no_partner_, other.no_partner_);
}

double wall_distance(const BedExtent& extent, size_t wall, const Eigen::Vector3d& at) {
  switch (wall) {
    case 0:
      return at.z();
    case 1:
      return 0.5 * extent.width_m + at.x();
    case 2:
      return 0.5 * extent.width_m - at.x();
    case 3:
      return 0.5 * extent.depth_m + at.y();
    default:
      return 0.5 * extent.depth_m - at.y();
  }
}

ContactGroups::ContactGroups(const BedExtent& extent, double near_m, size_t groups,
                             size_t particles)
    : extent_(extent),
      near_m_(near_m),
      groups_(groups),
      foreign_row_(particles, -1),
      at_edge_(particles, 0) {
  active_.reserve(groups);
}

void ContactGroups::wake(int32_t particle) {
  std::vector<int32_t>& awake = groups_[group_of(particle)].awake;
  awake.push_back(particle);
  ++awake_;
  stale_ = true;
}

void ContactGroups::remove_sleepers(const BedParticles& particles) {
  awake_ = 0;
  const auto sleeps = [&](int32_t particle) { return !particles.awake(particle); };
  for (ParticleGroup& group : groups_) {
    if (group.awake.empty()) continue;
    if (group.report.rested_count > 0) {
      std::copy_if(group.awake.begin(), group.awake.end(), std::back_inserter(group.slept), sleeps);
      std::erase_if(group.awake, sleeps);
      std::erase_if(group.inner, sleeps);
      std::erase_if(group.edge, sleeps);
    }
    awake_ += group.awake.size();
  }
  if (static_cast<double>(awake_) < kStillAwake * static_cast<double>(awake_when_found_)) {
    stale_ = true;
  }
}

void ContactGroups::find(const BedParticles& particles, const SphereGrid& grid, ContactStore& store,
                         ThreadTeam& team) {
  for (const int32_t number : active_) {
    put_away(groups_[static_cast<size_t>(number)], particles, store);
  }
  active_.clear();
  for (size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].awake.empty()) active_.push_back(static_cast<int32_t>(g));
  }
  if (most_awake()) runs_.sort(grid, particles);
  team.run(active_.size(), [&](size_t i, size_t /*member*/) {
    find_in(static_cast<size_t>(active_[i]), particles, grid, store);
  });
  contacts_ = 0;
  push_rows_ = kFirstForeignPush;
  int32_t rows = 0;  // of all groups
  for (const int32_t number : active_) {
    ParticleGroup& group = groups_[static_cast<size_t>(number)];
    contacts_ += group.pairs.size();
    recall(group, store);
    number_foreign(number, rows);
  }
  team.run(active_.size(), [&](size_t i, size_t /*member*/) {
    part_edge(groups_[static_cast<size_t>(active_[i])]);
  });
  awake_when_found_ = awake_;
  stale_ = false;
}

/// Empties the lists of a group. Contacts that will not come again with the same first particle go
/// to the store.
void ContactGroups::put_away(ParticleGroup& group, const BedParticles& particles,
                             ContactStore& store) {
  for (size_t i = 0; i < group.pairs.size(); ++i) {
    const int32_t first = group.pairs.first(i);
    const int32_t second = group.pairs.second(i);
    const bool comes_again = particles.awake(first) && (first < second || !particles.awake(second));
    if (!comes_again) put_into(store, group.pairs, i, memory_of);
  }
  for (size_t i = 0; i < group.walls.size(); ++i) {
    if (!particles.awake(group.walls.first(i))) put_into(store, group.walls, i, memory_of_wall);
  }
  group.pairs_before.swap(group.pairs);
  group.walls_before.swap(group.walls);
  group.pairs.clear(0, 0);
  group.walls.clear(0, 0);
  for (const PushAcross& push : group.across) {
    at_edge_[static_cast<size_t>(push.particle)] = 0;
    foreign_row_[static_cast<size_t>(push.particle)] = -1;
  }
  group.across.clear();
  group.inner.clear();
  group.edge.clear();
  group.slept.clear();
}

void ContactGroups::find_in(size_t number, const BedParticles& particles, const SphereGrid& grid,
                            const ContactStore& store) {
  ParticleGroup& group = groups_[number];
  if (!std::is_sorted(group.awake.begin(), group.awake.end())) {
    std::sort(group.awake.begin(), group.awake.end());
  }
  group.moved.resize(group.awake.size());
  group.rested.resize(group.awake.size());
  find_pairs(number, particles, grid, store);
  find_walls(number, particles, store);
  group.pairs_before.clear(0, 0);
  group.walls_before.clear(0, 0);
}

void ContactGroups::find_pairs(size_t number, const BedParticles& particles, const SphereGrid& grid,
                               const ContactStore& store) {
  ParticleGroup& group = groups_[number];
  const int32_t base = base_of(number);
  group.pairs.clear(base, base);  // nothing touches itself
  group.pairs_to_recall.clear();
  group.foreign_pairs.clear();
  Before before(group.pairs_before);
  const auto near2 = near_m_ * near_m_;
  for (const int32_t particle : group.awake) {
    const Eigen::Vector3d here = particles.at(particle);
    before.go_to(particle);
    const auto meet = [&](int32_t other, bool awake, const Eigen::Vector3d& there) {
      if (other <= particle && awake) return;  // the other finds this one
      if (between(extent_, here, there).squaredNorm() >= near2) return;
      group.pairs.add(particle, other);
      const size_t i = group.pairs.size() - 1;
      if (!before.copy_to(group.pairs, particle, other) && store.any(std::min(particle, other))) {
        group.pairs_to_recall.push_back(i);
      }
      if (!awake) return;  // nobody gets the push
      if (group_of(other) == number) {
        group.pairs.set_target(i, static_cast<size_t>(other - base));
      } else {
        group.foreign_pairs.push_back(i);
      }
    };
    if (most_awake()) {
      runs_.visit_near(grid, here, near_m_, [&](const CellRuns::Entry& entry) {
        meet(entry.particle, entry.awake, Eigen::Vector3d(entry.at));
      });
    } else {
      grid.visit_near(here, near_m_, [&](int32_t other) {
        meet(other, particles.awake(other), particles.at(other));
      });
    }
  }
}

void ContactGroups::find_walls(size_t number, const BedParticles& particles,
                               const ContactStore& store) {
  ParticleGroup& group = groups_[number];
  group.walls.clear(base_of(number), kNoWall);
  group.walls_to_recall.clear();
  Before before(group.walls_before);
  const size_t walls = extent_.periodic ? 1 : kBedWalls;
  for (const int32_t particle : group.awake) {
    const Eigen::Vector3d at = particles.at(particle);
    before.go_to(particle);
    for (size_t wall = 0; wall < walls; ++wall) {
      if (wall_distance(extent_, wall, at) >= 0.5 * near_m_) continue;
      const auto partner = static_cast<int32_t>(wall);
      group.walls.add(particle, partner);
      if (!before.copy_to(group.walls, particle, partner) && store.any(particle)) {
        group.walls_to_recall.push_back(group.walls.size() - 1);
      }
    }
  }
}

void ContactGroups::recall(ParticleGroup& group, ContactStore& store) {
  for (const size_t i : group.pairs_to_recall) take_from(store, group.pairs, i, memory_of);
  for (const size_t i : group.walls_to_recall) take_from(store, group.walls, i, memory_of_wall);
}

/// Gives each particle of other groups that this one pushes on a row. `rows` counts those of all
/// groups.
void ContactGroups::number_foreign(int32_t number, int32_t& rows) {
  ParticleGroup& group = groups_[static_cast<size_t>(number)];
  const int32_t begin = rows;
  for (const size_t i : group.foreign_pairs) {
    const int32_t second = group.pairs.second(i);
    int32_t& row = foreign_row_[static_cast<size_t>(second)];
    if (row < begin) {  // none yet in this group
      row = rows++;
      groups_[group_of(second)].across.push_back({number, row - begin, second});
      at_edge_[static_cast<size_t>(second)] = 1;
    }
    group.pairs.set_target(i, kFirstForeignPush + static_cast<size_t>(row - begin));
  }
  group.foreign = static_cast<size_t>(rows - begin);
  group.foreign_push.resize(group.foreign);
  push_rows_ = std::max(push_rows_, kFirstForeignPush + group.foreign);
}

void ContactGroups::part_edge(ParticleGroup& group) {
  for (const int32_t particle : group.awake) {
    (at_edge_[static_cast<size_t>(particle)] != 0 ? group.edge : group.inner).push_back(particle);
  }
  group.edge_push.resize(group.edge.size());
}

}  // namespace screed
