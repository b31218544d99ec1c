// The contacts that particles remember while they are in no list: those of sleepers, and those with
// running gear.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/contact_law.h"

namespace screed {

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

}  // namespace screed
