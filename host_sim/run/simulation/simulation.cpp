// A run from its input to its folder, step by step.
#include "host_sim/run/simulation/simulation.h"

#include <optional>

#include "firmware/parameters/parameter_table.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/render/picture/robot_shape.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/simulation/names.h"
#include "host_sim/run/simulation/run_files.h"
#include "host_sim/run/simulation/run_loop.h"
#include "host_sim/run/simulation/run_pictures.h"
#include "host_sim/run/simulation/run_world.h"
#include "host_sim/run/simulation/session_recorder.h"

namespace screed {
namespace {

SessionInfo session_info(const Experiment& experiment, const SimulationOptions& options,
                         const RobotSettings& robot) {
  SessionInfo info;
  info.program_version = options.program_version;
  info.experiment_name = experiment.experiment.name;
  info.experiment_text = experiment.text();
  info.seed = experiment.experiment.seed;
  info.board_name = options.board;
  info.board = robot.board;
  info.parameters = robot.parameters;
  info.credentials = robot.credentials;
  return info;
}

const char* hal_name(const SimulationOptions& options) {
  if (options.image.has_value()) return "mcu";
  return options.environment ? "surrogate" : "native";
}

RunIdentity identity_of(const Experiment& experiment, const SimulationOptions& options,
                        const std::optional<SoilParameters>& soil) {
  RunIdentity run;
  run.experiment = experiment.experiment.name;
  run.algorithm = experiment.experiment.algorithm;
  run.seed = experiment.experiment.seed;
  run.hal = hal_name(options);
  run.board = options.board;
  run.terrain = experiment.map.model;
  if (soil.has_value()) run.soil = soil->name;
  run.version = options.program_version;
  return run;
}

/// As the experiment lays it out: the session begins with it, and the figures before the run are
/// its. The robot has settled into plant.terrain() already. Particles lie as they fell.
HeightField terrain_before(const Experiment& experiment, const Environment& plant) {
  return experiment.map.of_particles() ? plant.terrain() : make_terrain(experiment);
}

std::optional<SoilParameters> soil_of(const Experiment& experiment) {
  if (!experiment.map.is_soil()) return std::nullopt;
  return make_soil(experiment);
}

/// What the world says at the end of the run.
void report_world(const RunWorld& world, SimulationSummary& summary) {
  const Environment& plant = world.plant();
  summary.time_s = plant.time_s();
  summary.left_bed = left_bed(plant);
  summary.energy_j = plant.battery().energy_j;
  summary.battery_v = plant.battery().terminal_v;
  summary.telemetry_frames = world.ground_station().frames();
  summary.telemetry_frames_damaged = world.ground_station().rejected_frames();
  summary.cycles = world.cycles();
}

/// Why the robot could not be armed at the end of the run, from its own telemetry; its limits are
/// known here.
std::vector<std::string> obstacles_of(const WatchedRobot& robot, double time_s) {
  const Robot& shadow = robot.parity.shadow();
  const RobotState state = shadow.supervisor().state();
  if (state != RobotState::kDisarmed && state != RobotState::kFault) return {};
  LatestTelemetry said = robot.telemetry.latest();
  for (const ParameterInfo& info : kParameterTable)
    said.set_parameter(info.name, shadow.parameters().*(info.field));
  return arming_obstacles(said, static_cast<uint64_t>(time_s * 1e6));
}

/// What the robot did and says at the end of the run.
void report_robot(const WatchedRobot& robot, SimulationSummary& summary) {
  const Robot& shadow = robot.parity.shadow();
  summary.distance_m = robot.frames.distance_m();
  summary.peaks = shadow.leveling().peaks();
  summary.state = state_name(shadow.supervisor().state());
  summary.faults = shadow.supervisor().faults();
  summary.cannot_be_armed = obstacles_of(robot, summary.time_s);
  summary.telemetry_frames_sent = robot.telemetry.frames();
  summary.telemetry_share = robot.telemetry.line_share(summary.time_s);
}

}  // namespace

void check_simulation(const Experiment& experiment, const SimulationOptions& options) {
  const RunWorld trial(experiment, options, nullptr);
}

SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options) {
  // Everything that can be wrong with the input is found before the first file is made.
  TelemetryLog telemetry;
  RunWorld world(experiment, options, &telemetry.stream());
  const Environment& plant = world.plant();
  const RobotShape shape =
      shape_of(make_robot_model(experiment, options.board), experiment.vehicle.tracks);

  RunFiles files(experiment, options);
  telemetry.open(files.telemetry_log());
  const HeightField before = terrain_before(experiment, plant);
  const std::optional<SoilParameters> soil = soil_of(experiment);
  SessionRecorder recorder(files.session(),
                           session_info(experiment, options, world.robot_settings()), before, soil);
  if (options.heights) recorder.record_heights(plant.terrain());
  recorder.record_particles_before(plant.spheres());

  SimulationSummary summary;
  summary.identity = identity_of(experiment, options, soil);
  const TerrainMeasure measure(experiment);

  WatchedRobot robot(world.robot_settings());
  StopCondition stop(experiment, options.stop);
  Progress progress(options.progress, measure, before);
  WallClock clock;
  Pacer pacer(clock, options.realtime);
  LevelingMonitor leveling(experiment, world.robot_settings().board.tread_mm * 1e-3,
                           plant.is_deformable());
  RunLoop loop(world, {robot, recorder, leveling, stop, progress, pacer, options.observer, before});
  summary.end = loop.run();
  summary.wall_s = pacer.elapsed_s();

  recorder.record_particles_after(plant.spheres());
  summary.content_hash = recorder.finish(plant.terrain());
  telemetry.close();

  summary.folder = files.final_folder();
  summary.leftovers = files.leftovers();
  summary.training_frames = stop.training_frames();
  summary.height_changes = recorder.height_changes();
  const RunSurfaces surfaces{measure.surface(before), measure.surface(plant.terrain())};
  summary.terrain = measure.outcome(surfaces.before, surfaces.after);
  summary.leveling = leveling.outcome();
  report_world(world, summary);
  report_robot(robot, summary);

  try {
    files.write_summary(summary_json(summary));
    if (options.table) files.write_tables();
    write_run_pictures(files.folder(), experiment, surfaces,
                       driven_run(recorder.path(), robot.frame, shape));
  } catch (const RunError& error) {
    // What took the time is saved; where there is room, `session export` makes table and pictures
    // again.
    files.commit();
    throw RunError(error.what() + ("; the session is whole, in " + summary.folder.string()));
  }
  files.commit();
  return summary;
}

}  // namespace screed
