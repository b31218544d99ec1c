// A run from its input to its folder, step by step.
#include "host_sim/run/simulation/simulation.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/simulation/run_files.h"
#include "host_sim/run/simulation/run_loop.h"
#include "host_sim/run/simulation/run_pictures.h"

namespace screed {

namespace {

SessionInfo session_info(const Experiment& experiment, const SimulationOptions& options,
                         const RobotSettings& robot) {
  SessionInfo info;
  info.program_version = options.program_version;
  info.arithmetic = arithmetic();
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

std::optional<SoilParameters> soil_of(const Experiment& experiment) {
  if (!experiment.map.is_soil()) return std::nullopt;
  return make_soil(experiment);
}

RunIdentity identity_of(const Experiment& experiment, const SimulationOptions& options) {
  RunIdentity run;
  run.experiment = experiment.experiment.name;
  run.algorithm = experiment.experiment.algorithm;
  run.seed = experiment.experiment.seed;
  run.hal = hal_name(options);
  run.board = options.board;
  run.terrain = experiment.map.model;
  if (const auto soil = soil_of(experiment)) run.soil = soil->name;
  run.version = options.program_version;
  return run;
}

/// The experiment as the environment can run it.
Experiment as_run(Experiment experiment, const SimulationOptions& options) {
  experiment.soil.cell_m = std::max(experiment.soil.cell_m, options.least_cell_m);
  return experiment;
}

/// As the experiment lays it out: the session begins with it, and the figures before the run are
/// its. The robot has settled into plant.terrain() already, where that can deform. Particles lie as
/// they fell.
HeightField terrain_before(const Experiment& experiment, const Environment& plant) {
  return experiment.map.of_particles() || !plant.is_deformable() ? plant.terrain()
                                                                 : make_terrain(experiment);
}

/// Why the robot could not be armed at the end of the run, from its own telemetry; its limits are
/// known here.
std::vector<std::string> obstacles_of(const WatchedRobot& robot, double time_s) {
  const Robot& shadow = robot.parity.shadow();
  const RobotState state = shadow.supervisor().state();
  if (state != RobotState::kDisarmed && state != RobotState::kFault) return {};
  LatestTelemetry said = robot.telemetry.latest();
  for (const ParameterInfo& info : kParameterTable)
    said.set_parameter(info.name, shadow.parameters().values[info.number]);
  return arming_obstacles(said, static_cast<uint64_t>(time_s * 1e6));
}

/// A robot of a run, and where what it does goes.
struct RobotOfRun {
  RobotOfRun(const World& world, size_t number, const std::filesystem::path& session,
             const SessionInfo& info, const HeightField& before,
             const std::optional<SoilParameters>& soil)
      : robot(world.robot(number).settings()), recorder(session, info, before, soil) {}

  WatchedRobot robot;
  SessionRecorder recorder;
};
using RobotsOfRun = std::vector<std::unique_ptr<RobotOfRun>>;

/// The telemetry logs of a run's robots, made before their files are.
class TelemetryLogs {
 public:
  explicit TelemetryLogs(size_t robots) : logs_(robots) {
    for (TelemetryLog& log : logs_) streams_.push_back(&log.stream());
  }
  const std::vector<std::ostream*>& streams() const { return streams_; }
  void open(const RunFiles& files) {
    for (size_t i = 0; i < logs_.size(); ++i) logs_[i].open(files.telemetry_log(i));
  }
  void close() {
    for (TelemetryLog& log : logs_) log.close();
  }

 private:
  std::vector<TelemetryLog> logs_;
  std::vector<std::ostream*> streams_;
};

RobotsOfRun make_robots(const Experiment& experiment, const SimulationOptions& options,
                        const World& world, const RunFiles& files, const HeightField& before) {
  const std::optional<SoilParameters> soil = soil_of(experiment);
  RobotsOfRun robots;
  for (size_t i = 0; i < world.robots(); ++i) {
    robots.push_back(std::make_unique<RobotOfRun>(
        world, i, files.session(i), session_info(experiment, options, world.robot(i).settings()),
        before, soil));
  }
  return robots;
}

/// What a robot did and says at the end of the run.
RobotSummary report_robot(const World& world, size_t number, const WatchedRobot& robot,
                          const std::string& content_hash) {
  const Robot& shadow = robot.parity.shadow();
  const RobotView& view = world.plant().robot(number);
  const double time_s = world.plant().time_s();
  const GroundStation& ground = world.ground_station(number);
  RobotSummary summary;
  summary.content_hash = content_hash;
  summary.left_bed = left_bed(world.terrain(), view);
  summary.distance_m = robot.frames.distance_m();
  summary.energy_j = view.battery().energy_j;
  summary.battery_v = view.battery().terminal_v;
  summary.battery_charge = std::max(0.0, view.battery().charge());
  if (const auto lasts_s = view.battery().lasts_s(time_s); lasts_s.has_value())
    summary.charge_lasts_h = *lasts_s / kSecondsPerHour;
  summary.peaks = shadow.leveling().peaks();
  summary.ran = robot.ran;
  summary.state = state_name(shadow.supervisor().state());
  summary.faults = shadow.supervisor().faults();
  summary.cannot_be_armed = obstacles_of(robot, time_s);
  summary.telemetry_frames = ground.frames();
  summary.telemetry_frames_damaged = ground.rejected_frames();
  summary.telemetry_frames_sent = robot.telemetry.frames();
  summary.telemetry_share = robot.telemetry.line_share(time_s);
  return summary;
}

/// The robots between the terrains of a run whose sessions are closed.
DrivenRun driven_by(const RobotsOfRun& robots, const RobotShape& shape, const RunFiles& files) {
  DrivenRun all;
  for (const auto& it : robots) add_robot(it->recorder.path(), it->robot.frame, shape, all);
  all.leveling = SessionReader(files.session()).leveling();
  return all;
}

/// Closes the sessions with the terrain as the run left it.
void finish_robots(const World& world, RobotsOfRun& robots, SimulationSummary& summary) {
  const Environment& plant = world.plant();
  std::vector<RobotSummary> all;
  for (size_t i = 0; i < robots.size(); ++i) {
    SessionRecorder& recorder = robots[i]->recorder;
    if (i == 0) recorder.record_particles_after(plant.spheres());
    all.push_back(report_robot(world, i, robots[i]->robot, recorder.finish(plant.terrain())));
  }
  static_cast<RobotSummary&>(summary) = total_of(all);
  if (all.size() > 1) summary.robots = std::move(all);
}

/// What the options say of the world.
WorldSetup world_setup(const SimulationOptions& options) {
  WorldSetup setup;
  setup.board = options.board;
  setup.image = options.image;
  setup.gdb_port = options.gdb_port;
  setup.ground_port = options.ground_port;
  setup.environment = options.environment;
  setup.progress = options.setup_progress;
  return setup;
}

}  // namespace

void check_simulation(const Experiment& experiment, const SimulationOptions& options) {
  make_world(as_run(experiment, options), world_setup(options));
}

SimulationSummary run_simulation(const Experiment& asked, const SimulationOptions& options) {
  const Experiment experiment = as_run(asked, options);
  // Everything that can be wrong with the input is found before the first file is made.
  TelemetryLogs telemetry(experiment.robots.count);
  WorldSetup setup = world_setup(options);
  setup.telemetry_logs = telemetry.streams();
  const std::unique_ptr<World> world = make_world(experiment, setup);
  const Environment& plant = world->plant();
  const RobotShape shape =
      shape_of(make_robot_model(experiment, options.board), experiment.vehicle.tracks);

  RunFiles files(experiment, options);
  telemetry.open(files);
  const HeightField before = terrain_before(experiment, plant);
  RobotsOfRun robots = make_robots(experiment, options, *world, files, before);
  SessionRecorder& recorder = robots[0]->recorder;
  if (options.heights) recorder.record_heights(plant.terrain());
  recorder.record_particles_before(plant.spheres());

  SimulationSummary summary;
  summary.identity = identity_of(experiment, options);
  const TerrainMeasure measure(experiment);

  StopCondition stop(experiment, options.stop);
  Progress progress(options.progress);
  WallClock clock;
  Pacer pacer(clock, options.realtime);
  LevelingMonitor leveling(experiment, world->robot().settings().board.tread_mm * 1e-3,
                           plant.is_deformable());
  std::vector<RecordedRobot> recorded;
  for (const auto& it : robots) recorded.push_back({it->robot, it->recorder});
  RunLoop loop(*world, {recorded, leveling, stop, progress, pacer, options.observer, before});
  summary.end = loop.run();
  summary.wall_s = pacer.elapsed_s();

  finish_robots(*world, robots, summary);
  telemetry.close();

  summary.folder = files.final_folder();
  summary.leftovers = files.leftovers();
  summary.time_s = plant.time_s();
  summary.cycles = world->robot().cycles();
  summary.training_frames = stop.training_frames();
  summary.ordered = experiment.radio.ground_station;
  summary.height_changes = recorder.height_changes();
  const RunSurfaces surfaces{measure.surface(before), measure.surface(plant.terrain())};
  summary.leveling = leveling.outcome();
  summary.terrain = TerrainMeasure::outcome(surfaces.before, surfaces.after,
                                            summary.leveling.before, summary.leveling.after);

  try {
    files.write_summary(summary_json(summary));
    if (options.table) files.write_tables();
    if (options.pictures)
      write_run_pictures(files.folder(), experiment, surfaces, driven_by(robots, shape, files));
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
