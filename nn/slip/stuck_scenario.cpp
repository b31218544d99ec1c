// Draws the soil, the kind of drive and the trap.
#include "nn/slip/stuck_scenario.h"

#include <cmath>
#include <numbers>

#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed::nn {
namespace {

constexpr std::size_t kRigidShares = 2;  ///< of rigid ground, where each named soil has one
constexpr const char* kTerrains[] = {"terrain_a.png", "terrain_b.png"};
constexpr const char* kTraps[] = {"wall", "slope", "hump", "trench", "ruts", "ruts"};
constexpr std::size_t kStartsInRuts = 4;  ///< the first of the two "ruts"
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

enum class DriveKind : std::uint8_t { kRandom, kArc, kStraight };

class Draw {
 public:
  explicit Draw(std::uint64_t seed, ScenarioKind kind)
      : random_(seed, std::string(name_of(kind)) + " drive") {}
  double between(double low, double high) { return random_.uniform(low, high); }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>((std::uint64_t{random_.next()} * count) >> 32U);
  }
  bool one_in_two() { return below(2) == 0; }

 private:
  WorldRandom random_;
};

void choose_soil(Draw& draw, Experiment& e, std::string& ground) {
  const std::size_t drawn = draw.below(kRigidShares + soil_presets().size());
  ground = drawn < kRigidShares ? "rigid" : soil_presets()[drawn - kRigidShares].soil.name;
  e.vehicle.track_friction = draw.between(0.6, 0.9);
  if (ground == "rigid") return;
  e.map.model = "scm";
  e.soil.preset = ground;
  e.soil.cell_m = 0.02;
  e.soil.overrides.slip_sinkage = draw.between(0.0, 0.4);
  e.soil.overrides.drag_depth_m = draw.between(0.0, 0.003);
}

double max_slope_deg(ScenarioKind kind) {
  if (kind == ScenarioKind::kTrapped) return 4.0;
  return kind == ScenarioKind::kOrdinary ? 20.0 : 8.0;
}

void choose_terrain(Draw& draw, Experiment& e, ScenarioKind kind) {
  e.map.filename = kTerrains[draw.below(std::size(kTerrains))];
  e.map.size_m = kind == ScenarioKind::kTrapped ? 6.0 : 10.0;
  e.map.smoothing_m = draw.between(0.05, 0.2);
  e.map.max_slope_deg = draw.between(0.5, max_slope_deg(kind));
  e.map.edges = "wrap";
  e.vehicle.x_m = draw.between(-1.0, 1.0);
  e.vehicle.y_m = draw.between(-1.0, 1.0);
  e.vehicle.heading_deg = draw.between(-180.0, 180.0);
}

void choose_trap(Draw& draw, Experiment& e, const std::string& ground, DriveKind& drive_kind,
                 bool& spins) {
  const std::size_t trap = draw.below(std::size(kTraps));
  e.trap.kind = kTraps[trap];
  e.trap.distance_m = trap == kStartsInRuts ? -0.25 : draw.between(0.25, 0.6);
  if (e.trap.kind == "wall") {
    e.trap.size = draw.between(0.08, 0.2);
  } else if (e.trap.kind == "slope") {
    e.trap.size = ground == "rigid"
                      ? std::atan(e.vehicle.track_friction) * kDegPerRad + draw.between(2.0, 6.0)
                      : draw.between(26.0, 34.0);
  } else {
    e.trap.size = draw.between(0.045, 0.08);
  }
  // A hump and ruts are met straight on; who stands in ruts may try to turn.
  if (e.trap.kind == "hump" || e.trap.kind == "ruts") drive_kind = DriveKind::kStraight;
  spins = trap == kStartsInRuts && draw.one_in_two();
}

/// A bed with walls and steep relief, as those that are leveled: the robot meets walls, its own
/// ruts and slopes that slide.
void choose_bed(Draw& draw, Experiment& e) {
  constexpr const char* kAlgorithms[] = {"hill_sensing", "spin_on_peak", "random_walk"};
  e.experiment.algorithm = kAlgorithms[draw.below(std::size(kAlgorithms))];
  e.map.edges = "walls";
  e.map.size_m = draw.between(1.6, 3.0);
  e.map.max_slope_deg = draw.between(8.0, 25.0);
  e.vehicle.x_m = draw.between(-0.3, 0.3);
  e.vehicle.y_m = draw.between(-0.3, 0.3);
  // Half of them turn before they meet a wall.
  if (draw.one_in_two()) e.parameters.site_radius() = 450;
}

/// Leveling algorithms on open ground or in a bed, or straight on along the bed, again and again
/// through the same ruts.
void choose_ordinary_drive(Draw& draw, Experiment& e) {
  if (draw.one_in_two()) {
    choose_bed(draw, e);
    return;
  }
  constexpr const char* kAlgorithms[] = {"hill_sensing", "spin_on_peak", "training_drive", "drive"};
  e.experiment.algorithm = kAlgorithms[draw.below(std::size(kAlgorithms))];
  if (e.experiment.algorithm != "drive") return;
  e.map.size_m = draw.between(2.0, 3.0);
  e.vehicle.heading_deg = draw.one_in_two() ? 0.0 : 90.0;
}

}  // namespace

const char* name_of(ScenarioKind kind) {
  if (kind == ScenarioKind::kTrapped) return "trapped";
  return kind == ScenarioKind::kOrdinary ? "ordinary" : "free";
}

StuckScenario stuck_scenario(std::uint64_t seed, ScenarioKind kind, double duration_s) {
  const bool trapped = kind == ScenarioKind::kTrapped;
  Draw draw(seed, kind);
  StuckScenario scenario;
  scenario.kind = kind;
  Experiment& e = scenario.experiment;
  e.experiment.name = name_of(kind);
  e.experiment.seed = seed;
  e.experiment.duration_s = duration_s;
  choose_soil(draw, e, scenario.ground);
  choose_terrain(draw, e, kind);
  DriveKind drive_kind = static_cast<DriveKind>(draw.below(3));
  bool spins = false;
  if (trapped) choose_trap(draw, e, scenario.ground, drive_kind, spins);
  e.drive.speed_m_per_s = draw.between(0.08, 0.2);
  const double side = draw.one_in_two() ? 1.0 : -1.0;
  const double rate = draw.between(5.0, 30.0);
  if (kind == ScenarioKind::kOrdinary) {
    choose_ordinary_drive(draw, e);
  } else {
    if (drive_kind == DriveKind::kArc) e.drive.yaw_rate_deg_per_s = side * rate;
    if (spins) {
      if (draw.one_in_two()) e.drive.speed_m_per_s = 0.0;
      e.drive.yaw_rate_deg_per_s = side * (rate + 20.0);
    }
    e.experiment.algorithm = drive_kind == DriveKind::kRandom ? "hill_sensing" : "drive";
  }
  e.parameters.algorithm() = algorithm_number(e.experiment.algorithm);
  e.parameters.random_seed() = static_cast<int16_t>(seed % 32767 + 1);
  e.parameters.escape_attempts() = 0;  // what is stuck stays so
  return scenario;
}

}  // namespace screed::nn
