// Ground, robot and options out of an experiment's keys.
#include "host_sim/run/world/world_setup.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <string>
#include <system_error>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/physics/terrain/elevation_file.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/experiment/robot_sections.h"
#include "host_sim/run/world/image_robot.h"
#include "host_sim/run/world/placement.h"
#include "host_sim/standin/standin_plant.h"

namespace screed {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kLevelCells = 64;  // a side, of rigid ground or a bed of particles without an image

/// The same surface on another grid. With wrap-around the cells still divide the bed.
HeightField resampled(const HeightField& field, double cell_m) {
  const double width = field.x_max() - field.x_min();
  const double depth = field.y_max() - field.y_min();
  const int extra = field.wrap() ? 0 : 1;
  const int nx = static_cast<int>(std::lround(width / cell_m)) + extra;
  const int ny = static_cast<int>(std::lround(depth / cell_m)) + extra;
  return HeightField::from_function(nx, ny, width / (nx - extra), field.wrap(),
                                    [&](double x, double y) { return field.at(x, y).height; });
}

void raise(HeightField& field, double by_m) {
  const auto units = static_cast<Height>(std::lround(by_m / kHeightUnit_m));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) field.set_node(ix, iy, field.node(ix, iy) + units);
  }
}

/// Length of the longer side, of so many pixels: given as such or by a pixel's width; of particles
/// by the stacks a pixel (thesis 5.1.3 and Table 5.2: as many particles side by side).
double size_of_bed(const Experiment& experiment, int pixels) {
  const auto& map = experiment.map;
  if (!map.xy_scale.has_value()) return map.size_m;
  if (map.of_particles()) return pixels * *map.xy_scale * 2.0 * map.particle_radius_m;
  return (map.wrap() ? pixels : pixels - 1) * *map.xy_scale;
}

/// The length of the longer side of a bed of so many heights, by their file's cells where it has
/// some.
double size_of_bed(const Experiment& experiment, const Elevation& elevation) {
  const int longer = std::max(elevation.width, elevation.height);
  if (!elevation.cell_m.has_value() || experiment.map.xy_scale.has_value())
    return size_of_bed(experiment, longer);
  return *elevation.cell_m * (experiment.map.wrap() ? longer : longer - 1);
}

/// The bed that a file holds.
HeightField terrain_of(const Experiment& experiment, const std::filesystem::path& file) {
  const auto& map = experiment.map;
  HeightFieldOptions options;
  options.scale_m = map.scale_m;
  options.smoothing_m = map.smoothing_m;
  options.max_slope_deg = map.max_slope_deg;
  options.wrap = map.wrap();
  if (!is_elevation_file(file)) {
    const GreyImage image = read_grey_image(file);
    options.size_m = size_of_bed(experiment, std::max(image.width, image.height));
    return HeightField::from_image(image, options);
  }
  const Elevation elevation = read_elevation(file);
  const bool is_of_file = elevation.cell_m.has_value() && !map.xy_scale.has_value();
  const std::string where = "[map] filename = " + map.filename + ": ";
  if (map.scale_m != MapSection().scale_m) {
    throw InputError(where +
                     "its heights are in metres, so scale, the height of an image's white, "
                     "does not apply");
  }
  if (is_of_file && map.size_m != MapSection().size_m) {
    throw InputError(where +
                     "it says how wide its cells are, so size does not apply; xy_scale "
                     "gives its cells another width");
  }
  options.size_m = size_of_bed(experiment, elevation);
  try {
    return HeightField::from_heights(elevation.width, elevation.height, elevation.heights_m,
                                     options);
  } catch (const InputError& error) {
    throw InputError(where + error.what());
  }
}

HeightField untrapped_terrain(const Experiment& experiment) {
  const auto& map = experiment.map;
  const bool soft = map.is_soil();
  if (map.filename.empty() && map.of_particles()) {
    const double rise = portable::tan(map.ramp_deg * kRadPerDeg);
    const int nodes = kLevelCells + 1;
    return HeightField::from_function(nodes, nodes, map.size_m / (nodes - (map.wrap() ? 0 : 1)),
                                      map.wrap(), [&](double x, double /*y*/) {
                                        return std::max(0.0,
                                                        experiment.particles.depth_m + x * rise);
                                      });
  }
  if (map.filename.empty()) {
    const double spacing = soft ? experiment.soil.cell_m : map.size_m / kLevelCells;
    return map.ramp_deg == 0.0 ? HeightField::flat(map.size_m, spacing, map.wrap())
                               : HeightField::ramp(map.size_m, spacing, map.ramp_deg);
  }
  HeightField field =
      terrain_of(experiment, find_data_file(experiment, map.filename, "[map] filename"));
  if (map.of_particles()) raise(field, experiment.particles.depth_m);
  return soft ? resampled(field, experiment.soil.cell_m) : field;
}

/// What the ground station commands.
std::optional<DriveCommand> drive_of(const Experiment& experiment) {
  if (experiment.experiment.algorithm != "drive") return std::nullopt;
  return DriveCommand{experiment.drive.speed_m_per_s, experiment.drive.yaw_rate_deg_per_s};
}

WorldOptions world_options(const Experiment& experiment, const std::string& board) {
  WorldOptions options;
  options.vehicle = vehicle_options(experiment, board);
  options.encoder_counts_per_turn = board_motor(board).counts_per_turn;
  options.battery = make_battery(experiment, board);
  options.seed = experiment.experiment.seed;
  options.physics_step_s = experiment.physics.step_s;
  options.robot_friction = experiment.robots.friction;
  options.imu = experiment.sensors.imu_errors();
  options.calibration_motion = experiment.sensors.calibration_motion;
  options.radio.delay_s = experiment.radio.delay_s;
  options.radio.loss = experiment.radio.loss;
  options.radio.bit_errors = experiment.radio.bit_errors;
  options.radio.duplication = experiment.radio.duplication;
  options.radio.range_m = experiment.radio.range_m;
  options.radio.bytes_per_s = experiment.radio.baud / 10.0;
  options.radio.pause_characters = experiment.radio.packet_pause;
  options.ground_station_arms = experiment.radio.ground_station;
  options.fixes = {experiment.fixes.period_s, experiment.fixes.sigma_m,
                   experiment.fixes.outage_every_s, experiment.fixes.outage_s};
  options.robots = robot_options(experiment, board);
  if (experiment.map.is_soil()) {
    options.soil = make_soil(experiment);
    options.soil_options.bulldozing = experiment.soil.bulldozing;
    options.soil_options.avalanches = experiment.soil.avalanches;
    options.soil_options.follow_slopes = experiment.soil.follow_slopes;
  }
  if (experiment.map.of_particles()) options.particles = make_particles(experiment);
  return options;
}

/// Where the robots start on a bed of this size: at these places, all at the height and as inclined
/// as [vehicle] says.
std::vector<StartPose> start_poses(const Experiment& experiment, const HeightField& terrain) {
  const VehicleSection& vehicle = experiment.vehicle;
  std::vector<StartPose> starts;
  for (const RobotPlace& place : robot_places(experiment, terrain)) {
    starts.push_back({place.x_m,
                      place.y_m,
                      vehicle.z_m,
                      {vehicle.roll_deg * kRadPerDeg, vehicle.pitch_deg * kRadPerDeg,
                       place.heading_deg * kRadPerDeg}});
  }
  return starts;
}

/// Threads of a bed of particles. No key of an experiment: nothing in a run depends on it.
int threads_of_environment() {
  const char* const text = std::getenv("SCREED_THREADS");
  if (text == nullptr) return 1;
  int threads = 0;
  const char* const end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, threads);
  if (error != std::errc{} || stop != end || threads < 1 || threads > kMaxBedThreads) {
    throw InputError("SCREED_THREADS = \"" + std::string(text) + "\"; allowed: 1 to " +
                     std::to_string(kMaxBedThreads));
  }
  return threads;
}

}  // namespace

EnvironmentFactory stand_in_environment() {
  return [](HeightField terrain, const Assembly& robot, const PlantOptions& options) {
    return std::make_unique<StandInPlant>(terrain, robot, options);
  };
}

ParticleOptions make_particles(const Experiment& experiment) {
  ParticleOptions particles;
  particles.threads = threads_of_environment();
  particles.material.radius_m = experiment.map.particle_radius_m;
  particles.material.density_kg_per_m3 = experiment.particles.density_kg_per_m3;
  particles.material.friction = experiment.particles.friction;
  particles.material.rolling = experiment.particles.rolling;
  particles.ray_spacing_m = 1.0 / experiment.raygrid.resolution_per_m;
  particles.seed = experiment.experiment.seed;
  particles.fixed = experiment.map.model == "static_particles";
  return particles;
}

SoilParameters make_soil(const Experiment& experiment) {
  SoilParameters soil = soil_preset(experiment.soil.preset);
  experiment.soil.overrides.apply_to(soil);
  check_soil(soil);
  return soil;
}

namespace {

/// Ground, relief and walls.
PreparedWorld prepare_ground(const Experiment& experiment) {
  PreparedWorld world{.ground = untrapped_terrain(experiment)};
  world.walled = experiment.map.edge() == BedEdge::kWalled;
  world.options.seed = experiment.experiment.seed;
  if (experiment.relief.is_there()) {
    world.relief = experiment.relief.options;
    const bool trapped = experiment.trap.kind != "none";
    if (trapped || experiment.relief.seed.has_value()) {  // it lies in the ground for good
      world.relief->seed = experiment.relief.seed.value_or(experiment.experiment.seed);
      add_relief(*world.relief, world.ground);
      world.relief.reset();
      if (!experiment.relief.seed.has_value()) world.one_seed = "a trap lies on its relief";
    }
  }
  set_trap(experiment, world.ground);
  return world;
}

}  // namespace

HeightField make_terrain(const Experiment& experiment) {
  return prepare_ground(experiment).take_terrain();
}

std::optional<std::string> large_bed_note(const Experiment& experiment, double least_cell_m) {
  // As measured on one core of a server; another machine takes another time, hence `about`.
  constexpr double kLargeCells = 1e7;
  constexpr double kCellBytes = 65.0;
  constexpr double kCellSetup_s = 7e-7;    // to lay the bed, and its figures before and after
  constexpr double kCellMeasure_s = 1e-7;  // each [metrics] interval
  constexpr double kDrive_s = 0.05;        // of a simulated second, of one robot
  constexpr double kLargeParticles = 3e5;
  constexpr double kParticleBytes = 900.0;
  constexpr double kParticleSetup_s = 2e-4;
  const auto& map = experiment.map;
  if (!map.is_soil() && !map.of_particles()) return std::nullopt;
  Elevation nodes{1, 1, {}, {}};
  if (!map.filename.empty()) {
    const std::filesystem::path file = find_data_file(experiment, map.filename, "[map] filename");
    if (is_elevation_file(file)) {
      nodes = read_elevation(file);
    } else {
      const GreyImage image = read_grey_image(file);
      nodes = {image.width, image.height, {}, {}};
    }
  }
  const double pixel_m = size_of_bed(experiment, nodes) / std::max(nodes.width, nodes.height);
  const double element_m =
      map.is_soil() ? std::max(experiment.soil.cell_m, least_cell_m) : 2.0 * map.particle_radius_m;
  const double x = std::round(nodes.width * pixel_m / element_m);
  const double y = std::round(nodes.height * pixel_m / element_m);
  if (map.is_soil()) {
    const double cells = x * y;
    if (cells < kLargeCells || std::max(x, y) >= kLargestImageSide) return std::nullopt;
    return filled(
        "a large bed, {:.0f} x {:.0f} = {*1e-6:.0f} million cells: about {*1e-9:.1f} GB of memory, "
        "{:.0f} s to lay and measure it, {:.2g} s for a simulated second",
        x, y, cells, kCellBytes * cells, kCellSetup_s * cells,
        kDrive_s * experiment.robots.count +
            kCellMeasure_s * cells / experiment.metrics.interval_s);
  }
  const double particles = x * y * std::max(1.0, experiment.particles.depth_m / element_m);
  if (particles < kLargeParticles) return std::nullopt;
  return filled(
      "a large bed, at least {*1e-6:.1f} million particles: about {*1e-9:.1f} GB of memory, "
      "{*0.0166667:.0f} min to lay them; a simulated second takes as long as particles move in it",
      particles, kParticleBytes * particles, kParticleSetup_s * particles);
}

VehicleOptions vehicle_options(const Experiment& experiment, const std::string& board) {
  const VehicleSection& section = experiment.vehicle;
  VehicleOptions options;
  options.motor = board_motor(board).motor;
  options.tracks = section.tracks;
  options.track_model = section.track_model == "chain" ? TrackModel::kChain : TrackModel::kBelt;
  options.chain.links = section.track_links;
  options.chain.tension_n = section.track_tension_n;
  options.track_friction = section.track_friction;
  options.lug_height_m = section.lug_height_m;
  options.chassis_friction = section.chassis_friction;
  options.wall_friction = experiment.map.wall_friction;
  return options;
}

std::vector<RobotOptions> robot_options(const Experiment& experiment, const std::string& board) {
  const BoardConstants& constants = board_constants_of(board);
  const Credentials credentials = credentials_of(experiment);
  const CommandKey ground_key = ground_key_of(experiment);
  std::vector<RobotOptions> robots;
  for (size_t i = 0; i < experiment.robots.count; ++i) {
    const Experiment its = experiment_of_robot(experiment, i);
    RobotOptions own;
    own.settings = {constants, its.parameters, credentials_of_robot(credentials, i)};
    if (!robot_has_own(experiment, i, "parameters", "random_seed"))
      own.settings.parameters = parameters_of_robot(its.parameters, i);
    own.drive = drive_of(its);
    own.changes = experiment.later.changes();
    own.ground_key = key_of_robot(ground_key, i);
    robots.push_back(own);
  }
  // A script is one robot's, the others go on.
  robots[0].lay_on_side_at_s = experiment.experiment.lay_on_side_at_s;
  return robots;
}

namespace {

PreparedWorld prepare(const Experiment& experiment, const std::string& board) {
  PreparedWorld world = prepare_ground(experiment);
  world.options = world_options(experiment, board);
  world.model = make_robot_model(experiment, board);
  world.options.starts = start_poses(experiment, world.ground);
  if (experiment.robots.count > 1 && experiment.robots.placement == "random")
    world.one_seed = "robots stand at random places";
  return world;
}

std::unique_ptr<World> world_of(const Experiment& experiment, const WorldSetup& setup) {
  PreparedWorld prepared = prepare(experiment, setup.board);
  WorldOptions& options = prepared.options;
  options.progress = setup.progress;
  RobotOptions& first = options.robots[0];
  first.ground_port = setup.ground_port;
  for (size_t i = 0; i < setup.telemetry_logs.size(); ++i)
    options.robots[i].telemetry_log = setup.telemetry_logs[i];
  if (setup.image.has_value()) {
    if (experiment.experiment.algorithm == kTrainingDriveName) {
      throw InputError(
          "[experiment] algorithm = training_drive is not part of the microcontroller's image; it "
          "runs without --hal mcu");
    }
    first.image = RobotImage{*setup.image, setup.board, setup.gdb_port};
    check_image(first);
  }
  std::unique_ptr<Environment> plant =
      setup.environment ? setup.environment(prepared.take_terrain(), prepared.model, options)
                        : std::make_unique<Plant>(prepared.take_terrain(), prepared.model, options);
  return std::make_unique<World>(std::move(plant), options);
}

}  // namespace

PreparedWorld prepare_standin(const Experiment& experiment, const std::string& board) {
  try {
    Experiment coarse = experiment;
    coarse.soil.cell_m = std::max(coarse.soil.cell_m, kStandInCell_m);
    PreparedWorld world = prepare(coarse, board);
    make_standin_world(world);  // throws what does not suit it
    return world;
  } catch (const InputError& error) {
    throw with_place(experiment, error);
  }
}

std::unique_ptr<World> make_world(const Experiment& experiment, const WorldSetup& setup) {
  try {
    return world_of(experiment, setup);
  } catch (const InputError& error) {
    throw with_place(experiment, error);
  }
}

}  // namespace screed
