// A world as plain data: what an experiment comes to once its files are read and its keys checked.
// Bodies of robots, ground, options; anybody can make the world of any seed from it, without files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/relief.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/world/world.h"

namespace screed {

struct PreparedWorld {
  HeightField ground;  ///< without relief and walls
  /// Laid on it. Its seed is the world's.
  std::optional<ReliefOptions> relief = {};
  bool walled = false;
  Assembly model = {};
  /// Pointers to whoever listens to the robots are nobody's yet.
  WorldOptions options = {};
  /// Why no other seed can be had than options.seed; empty: any can.
  std::string one_seed = {};

  /// The ground of options.seed.
  HeightField terrain() const { return dressed(ground); }
  /// The same where nobody needs `ground` any more: a large bed is there once.
  HeightField take_terrain() { return dressed(std::move(ground)); }

 private:
  HeightField dressed(HeightField field) const;
};

/// Throws InputError for another seed than that of a world that has one alone.
void check_seed(uint64_t seed, const PreparedWorld& world);

/// Of the stand-in. Throws InputError as StandInPlant and World do.
std::unique_ptr<World> make_standin_world(const PreparedWorld& prepared);

/// As bytes and back: what a world of the stand-in needs. Throws InputError for bytes that are
/// damaged or of another version.
std::string to_bytes(const PreparedWorld& world);
PreparedWorld prepared_from(std::string_view bytes);

}  // namespace screed
