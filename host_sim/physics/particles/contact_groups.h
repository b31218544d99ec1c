// Who is awake, and which contacts must be computed: in groups of neighbouring particles, each of
// which can be computed by itself.
//
// A contact belongs to the group of its first particle: the one that is awake, or of two the one
// with the lower number. Its push on the second particle goes to that particle when it is of the
// same group, else to a row of its own, from which the other group fetches it later, in a fixed
// order. So no two groups write to the same row, and every sum has one order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/cell_runs.h"
#include "host_sim/physics/particles/contact_store.h"
#include "host_sim/physics/particles/sphere_grid.h"
#include "host_sim/physics/particles/thread_team.h"

namespace screed {

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
