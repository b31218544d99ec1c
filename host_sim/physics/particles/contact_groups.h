// All particles of a bed sorted by the cubes of its grid: for those who look at most of them at
// once. Chains of the grid lead all over the memory; these are read one after the other.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/contact_law.h"
#include "host_sim/physics/particles/sphere_grid.h"
#include "host_sim/physics/particles/thread_team.h"

namespace screed {

class CellRuns {
 public:
  struct Entry {
    double at[3];
    int32_t particle;
    bool awake;
  };

  void sort(const SphereGrid& grid, const BedParticles& particles) {
    begin_.assign(grid.cells() + 1, 0);
    for (size_t i = 0; i < particles.size; ++i) ++begin_[cell(grid, i)];
    int32_t sum = 0;
    for (int32_t& begin : begin_) {  // becomes the end of the cell's run
      sum += begin;
      begin = sum;
    }
    entries_.resize(particles.size);
    for (size_t i = particles.size; i-- > 0;) {
      const double* const at = particles.place[i].at;
      entries_[static_cast<size_t>(--begin_[cell(grid, i)])] = {
          {at[0], at[1], at[2]}, static_cast<int32_t>(i), particles.state[i] != 0};
    }
  }

  /// As SphereGrid::visit_near, with entries.
  template <class Visit>
  void visit_near(const SphereGrid& grid, const Eigen::Vector3d& position, double radius,
                  const Visit& visit) const {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
    grid.visit_cells(position - reach, position + reach, [&](int32_t begin, int32_t end) {
      const auto last = static_cast<size_t>(begin_[static_cast<size_t>(end)]);
      for (auto i = static_cast<size_t>(begin_[static_cast<size_t>(begin)]); i < last; ++i) {
        visit(entries_[i]);
      }
    });
  }

 private:
  static size_t cell(const SphereGrid& grid, size_t particle) {
    return static_cast<size_t>(grid.cell_of(static_cast<int32_t>(particle)));
  }

  std::vector<int32_t> begin_;  // of each cell's run, and the end of the last
  std::vector<Entry> entries_;
};

// The contacts that particles remember while they are in no list: those of sleepers, and those with
// running gear.

/// Partners of a particle that are no particles.
constexpr int32_t kNoPartner = -1;
constexpr int32_t kFloorPartner = -2;  ///< kFloorPartner - 1 .. kFloorPartner - 4: the walls
constexpr int32_t kGearPartner = -8;   ///< kGearPartner - n: the n-th body that ever pressed

class ContactStore {
 public:
  void resize(size_t particles) {
    slots_.assign(particles * kSlots, Slot{});
    kept_.assign(particles, 0);
  }
  /// Whether it remembers any contact.
  bool any(int32_t particle) const { return kept_[static_cast<size_t>(particle)] != 0; }

  /// Null when the particle remembers no such contact.
  ContactBristle* find(int32_t particle, int32_t partner) {
    Slot* const slot = slot_of(particle, partner);
    return slot == nullptr ? nullptr : &slot->bristle;
  }
  /// Remembers it from now on. Null when the particle has as many as it can have.
  ContactBristle* take(int32_t particle, int32_t partner) {
    Slot* slot = slot_of(particle, partner);
    if (slot != nullptr) return &slot->bristle;
    slot = slot_of(particle, kNoPartner);
    if (slot == nullptr) return nullptr;
    *slot = {partner, {}};
    ++kept_[static_cast<size_t>(particle)];
    return &slot->bristle;
  }
  void forget(int32_t particle, int32_t partner) {
    Slot* const slot = slot_of(particle, partner);
    if (slot != nullptr) clear(particle, *slot);
  }
  void forget_gear(int32_t particle) {
    Slot* const begin = first_slot(particle);
    for (Slot* slot = begin; slot != begin + kSlots; ++slot) {
      if (slot->partner <= kGearPartner) clear(particle, *slot);
    }
  }

 private:
  static constexpr size_t kSlots =
      12;  // the kissing number; a particle keeps about half of its own

  struct Slot {
    int32_t partner = kNoPartner;
    ContactBristle bristle{};
  };

  Slot* first_slot(int32_t particle) { return &slots_[static_cast<size_t>(particle) * kSlots]; }
  Slot* slot_of(int32_t particle, int32_t partner) {
    Slot* const begin = first_slot(particle);
    Slot* const found = std::find_if(begin, begin + kSlots,
                                     [&](const Slot& slot) { return slot.partner == partner; });
    return found == begin + kSlots ? nullptr : found;
  }

  void clear(int32_t particle, Slot& slot) {
    slot = {};
    --kept_[static_cast<size_t>(particle)];
  }

  std::vector<Slot> slots_;
  std::vector<uint8_t> kept_;  // slots in use of each particle
};

// Who is awake, and which contacts must be computed: in groups of neighbouring particles, each of
// which can be computed by itself.
//
// A contact belongs to the group of its first particle: the one that is awake, or of two the one
// with the lower number. Its push on the second particle goes to that particle when it is of the
// same group, else to a row of its own, from which the other group fetches it later, in a fixed
// order. So no two groups write to the same row, and every sum has one order.

/// Contacts of a group in packets, one after the other.
class ContactList {
 public:
  /// What fills up the last packet is a contact of the group's first particle with `partner`.
  void clear(int32_t base, int32_t partner) {
    packets_.clear();
    count_ = 0;
    base_ = base;
    no_partner_ = partner;
  }
  void add(int32_t first, int32_t second);
  size_t size() const { return count_; }
  std::vector<ContactPacket>& packets() { return packets_; }
  int32_t first(size_t i) const {
    return base_ + packets_[i / kPacketContacts].first[i % kPacketContacts];
  }
  int32_t second(size_t i) const {
    return packets_[i / kPacketContacts].second[i % kPacketContacts];
  }
  void set_target(size_t i, size_t row) {
    packets_[i / kPacketContacts].target[i % kPacketContacts] = static_cast<uint16_t>(row);
  }
  /// The state of a contact, `sign` times.
  ContactBristle bristle(size_t i, float sign) const;
  void set_bristle(size_t i, const ContactBristle& bristle, float sign);
  void swap(ContactList& other);

 private:
  std::vector<ContactPacket> packets_;
  size_t count_ = 0;
  int32_t base_ = 0;
  int32_t no_partner_ = 0;
};

/// Rows of pushes while a group is computed: its particles', then one that nobody reads, then those
/// of particles of other groups.
constexpr size_t kNobodysPush = kGroupParticles;
constexpr size_t kFirstForeignPush = kGroupParticles + 1;

/// A push that another group has for a particle: number `row` of its foreign ones.
struct PushAcross {
  int32_t group;
  int32_t row;
  int32_t particle;
};

/// A push from outside: running gear.
struct OuterPush {
  int32_t particle;
  PushRow push;
};

struct ParticleGroup {
  std::vector<int32_t> awake;
  std::vector<int32_t> inner;  ///< of those awake: only contacts of the group push on them
  std::vector<int32_t> edge;   ///< the others
  std::vector<int32_t> slept;  ///< no longer awake, but still in contacts
  ContactList pairs;
  ContactList walls;  ///< the second is the number of a wall
  // Of find(): the lists before, and what remains to be done for those of now.
  ContactList pairs_before;
  ContactList walls_before;
  std::vector<size_t> pairs_to_recall;
  std::vector<size_t> walls_to_recall;
  std::vector<size_t> foreign_pairs;
  std::vector<PushAcross> across;
  size_t foreign = 0;  ///< particles of other groups that this one pushes on
  // Of a step:
  std::vector<OuterPush> outer;
  std::vector<PushRow> foreign_push;
  std::vector<PushRow> edge_push;  ///< what the group's own contacts give to each of `edge`
  std::vector<int32_t> moved;      ///< room for what MotionReport names
  std::vector<int32_t> rested;
  MotionReport report{};
};

class ContactGroups {
 public:
  /// Contacts are looked for between particles nearer than `near_m`, and with walls at half of it.
  ContactGroups(const BedExtent& extent, double near_m, size_t groups, size_t particles);

  /// Groups that have particles awake, in order, when it was last found what touches.
  const std::vector<int32_t>& active() const { return active_; }
  ParticleGroup& group(int32_t number) { return groups_[static_cast<size_t>(number)]; }
  const ParticleGroup& group(int32_t number) const { return groups_[static_cast<size_t>(number)]; }
  size_t awake() const { return awake_; }
  size_t contacts() const { return contacts_; }
  /// Rows of pushes that computing a group takes.
  size_t push_rows() const { return push_rows_; }

  /// Whether find() must be called before contacts can be computed.
  bool stale() const { return stale_; }
  void wake(int32_t particle);
  /// Takes from the lists who is awake no longer.
  void remove_sleepers(const BedParticles& particles);

  /// Looks anew which particles touch, or may before they have moved far. Contacts of sleepers go
  /// to the store, and come back from there.
  void find(const BedParticles& particles, const SphereGrid& grid, ContactStore& store,
            ThreadTeam& team);

 private:
  void put_away(ParticleGroup& group, const BedParticles& particles, ContactStore& store);
  void find_in(size_t number, const BedParticles& particles, const SphereGrid& grid,
               const ContactStore& store);
  void find_pairs(size_t number, const BedParticles& particles, const SphereGrid& grid,
                  const ContactStore& store);
  void find_walls(size_t number, const BedParticles& particles, const ContactStore& store);
  void recall(ParticleGroup& group, ContactStore& store);
  void number_foreign(int32_t number, int32_t& rows);
  void part_edge(ParticleGroup& group);

  /// So many that it is worth while to sort all particles.
  bool most_awake() const { return 2 * awake_ > at_edge_.size(); }

  BedExtent extent_;
  double near_m_;
  CellRuns runs_;
  std::vector<ParticleGroup> groups_;
  std::vector<int32_t> active_;
  std::vector<int32_t>
      foreign_row_;               // of each particle, the row for it in the group in work, or -1
  std::vector<uint8_t> at_edge_;  // of each particle
  size_t awake_ = 0;
  size_t awake_when_found_ = 0;
  size_t contacts_ = 0;
  size_t push_rows_ = 0;
  bool stale_ = true;
};

/// Distance from a wall of the bed, by its number: the floor, then west, east, south, north.
double wall_distance(const BedExtent& extent, size_t wall, const Eigen::Vector3d& at);

}  // namespace screed
