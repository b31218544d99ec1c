// The seam between a bed of particles and the kernels that compute its contacts and motion with the
// vector instructions of a processor. All kernels give the same bits. A kernel's file includes
// nothing of the standard library's templates, so no code for a newer processor can reach the rest
// of the program.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "host_sim/physics/particles/contact_law.h"

namespace screed {

// ---- particles: a row each, as wide as a vector register

struct alignas(32) PlaceRow {
  double at[3];    ///< m
  double strayed;  ///< m: it is not further than this from its anchor
};
struct alignas(64) MotionRow {
  double velocity[3];  ///< m/s
  double since_s;      ///< it has been near its anchor since then
  double spin[3];      ///< rad/s
  double awake;        ///< 1, or 0: a particle that sleeps does not move
};
/// What pushes on a particle in a step.
struct alignas(64) PushRow {
  double force[3];  ///< N
  double zero;
  double moment[3];  ///< N m
  double zero_too;
};
/// Where a particle was when it last woke its neighbours, m.
struct AnchorRow {
  double at[3];
};

/// Rows of all particles, and the pushes on a group of them.
struct BedRows {
  PlaceRow* place;
  MotionRow* motion;
  const AnchorRow* anchor;
  PushRow* push;  ///< that of the group's particle i is number i - base; zero between steps
  int32_t base;   ///< the group's first particle
};

// ---- contacts

constexpr size_t kPacketContacts = 16;

/// Contacts of a group with the state that they keep; a contact is a number of each array. Contacts
/// push in the order of their numbers: that is what makes sums equal in all kernels.
struct alignas(64) ContactPacket {
  uint16_t first[kPacketContacts];   ///< a particle of the group, from its base
  uint16_t target[kPacketContacts];  ///< the push row that gets the opposite force
  int32_t second[kPacketContacts];   ///< the partner, from 0; in a packet of walls, the wall
  float slide[3][kPacketContacts];   ///< ContactBristle
  float roll[3][kPacketContacts];
};

/// A plane that particles stand on, along an axis of the world.
struct alignas(32) WallRow {
  double point[4];    ///< of the plane
  double normal[4];   ///< unit length, into the bed
  double nearest[4];  ///< a centre's least distance along the normal; what is beyond is lifted
};
constexpr size_t kBedWalls = 5;         ///< the floor, then west, east, south, north
constexpr int32_t kNoWall = kBedWalls;  ///< one that nothing touches

/// What all contacts and particles have in common in a step.
struct alignas(64) StepConstants {
  double period[4];     ///< of a bed that repeats, m; 0 along what does not
  double frequency[4];  ///< 1 / period, or 0
  double dt_row[4];     ///< dt, and 0 for what is no place
  double kept[8];       ///< share of the motion that drag leaves; 1 for what is no motion
  double per_push[8];   ///< dt / mass, dt / inertia; 0 for what is none
  double pull[8];       ///< dt times gravity
  WallRow walls[kBedWalls + 1];
  LawConstants<float> law;
  float dt;
  float diameter;
  float friction;
  bool periodic;
  int32_t nobody;         ///< a particle that is not there, at rest
  double noticed_m;       ///< a distance from the anchor that is reported
  double rested_since_s;  ///< who has been at the anchor since then is reported
};

/// What becomes of particles that have moved. The lists have room for all of them.
struct MotionReport {
  int32_t* moved;  ///< those further than noticed_m from their anchor
  size_t moved_count;
  int32_t* rested;  ///< others, that have been at their anchor since rested_since_s
  size_t rested_count;
  double fastest2;  ///< the square of the greatest velocity, (m/s)^2
};

/// The functions of a kernel.
struct BedFunctions {
  /// Adds the pushes of all contacts between particles to both of them.
  void (*collide_pairs)(const BedRows&, const StepConstants&, ContactPacket*, size_t count);
  /// The same for contacts with walls.
  void (*collide_walls)(const BedRows&, const StepConstants&, ContactPacket*, size_t count);
  /// Moves the particles with these numbers and clears what pushed on them. Goes on with `report`.
  void (*move)(const BedRows&, const StepConstants&, const int32_t* particles, size_t count,
               MotionReport& report);
};

extern const BedFunctions kScalarBedFunctions;
extern const BedFunctions kAvx2BedFunctions;
extern const BedFunctions kAvx512BedFunctions;

}  // namespace screed
