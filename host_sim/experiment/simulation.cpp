// Runs an experiment.
#include "host_sim/experiment/simulation.h"

#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <thread>

#include "boards/a_star_32u4/board.h"
#include "firmware/robot/robot.h"
#include "hal/host/target.h"
#include "host_sim/core/errors.h"
#include "host_sim/experiment/frame_recorder.h"
#include "host_sim/picture/terrain_picture.h"
#include "host_sim/session/csv_export.h"
#include "host_sim/session/record.h"
#include "host_sim/session/run_folder.h"
#include "host_sim/session/session_reader.h"
#include "host_sim/session/session_writer.h"
#include "host_sim/vehicle/urdf_importer.h"

namespace screed {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr uint64_t kProgressTicks = kTickRate_hz / 10;
constexpr uint64_t kPathTicks = kTickRate_hz / 10;  // a point of the drawn path ten times a second

constexpr const char* kStateNames[kRobotStates] = {"disarmed", "armed", "running", "stopped",
                                                   "fault"};
constexpr const char* kLevelingStateNames[kLevelingStates] = {"idle", "walk",   "climb",
                                                              "spin", "return", "drive"};
constexpr const char* kFaultNames[] = {
    "tilt",        "IMU silent", "gyro frozen",   "left track stalled", "right track stalled",
    "battery low", "parameters", "emergency stop"};

/// A text file of the run folder; RunError when the disk is full.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path) : path_(path), file_(path) {
    if (!file_) throw RunError(path.string() + ": cannot be written");
  }
  std::ostream& stream() { return file_; }
  void close() {
    file_.close();
    if (!file_)
      throw RunError(path_.string() + ": cannot be written completely; is the disk full?");
  }

 private:
  std::filesystem::path path_;
  std::ofstream file_;
};

void write_text(const std::filesystem::path& path, const std::string& text) {
  TextFile file(path);
  file.stream() << text;
  file.close();
}

HeightMapView view_of(const HeightField& field, std::vector<int32_t>& heights) {
  heights.clear();
  heights.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) heights.push_back(field.node(ix, iy));
  }
  HeightMapView view;
  view.geometry = {static_cast<uint32_t>(field.nx()),
                   static_cast<uint32_t>(field.ny()),
                   kHeightUnit_m,
                   field.spacing_m(),
                   field.node_x(0),
                   field.node_y(0),
                   field.wrap()};
  view.heights = heights;
  return view;
}

/// The robot in the world, as the firmware's main loop sees it; records every tick.
///
/// Beside the robot of the main loop runs a second one on the same samples. The core is a pure
/// function, so both must give the same bytes; the second one also shows its thoughts to the
/// recorder, which the main loop's robot, behind its HAL, does not.
class RecordingTarget : public hal::Target {
 public:
  RecordingTarget(World& world, const Experiment& experiment, const SimulationOptions& options,
                  SessionWriter& writer)
      : world_(world),
        options_(options),
        parameters_(experiment.parameters),
        shadow_(kBoard, parameters_),
        writer_(writer),
        last_tick_(
            static_cast<uint64_t>(std::llround(experiment.experiment.duration_s * kTickRate_hz))),
        duration_s_(experiment.experiment.duration_s),
        flatness_deg_(experiment.experiment.flatness_deg),
        flatness_(flatness(world.terrain(), flatness_deg_)) {}

  void init() override { begin_ = std::chrono::steady_clock::now(); }
  const BoardConstants& board_constants() override { return kBoard; }
  const Parameters& parameters() override { return parameters_; }

  bool wait_for_tick() override {
    stopped_early_ = options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
    if (stopped_early_ || world_.ticks() >= last_tick_) return false;
    world_.advance();
    if (options_.realtime) {
      std::this_thread::sleep_until(begin_ +
                                    std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                        std::chrono::duration<double>(world_.time_s())));
    }
    return true;
  }

  void read_sensors(SensorSample& sample) override { sample = world_.sample(); }

  void write_outputs(const RobotOutput& output) override {
    shadow_.tick(world_.sample(), expected_);
    check_purity(output);
    const Frame frame = recorder_.record(world_, shadow_);
    writer_.append(frame, world_.sample(), output);
    world_.apply(output);
    if (world_.ticks() % kPathTicks == 1)
      path_.push_back({frame.x, frame.y, static_cast<size_t>(frame.leveling_state)});
    if (options_.progress && world_.ticks() % kProgressTicks == 0) {
      options_.progress({world_.time_s(), duration_s_, flatness_});
    }
  }

  const Robot& robot() const { return shadow_; }
  const FrameRecorder& recorder() const { return recorder_; }
  std::vector<PathPoint>& path() { return path_; }
  bool stopped_early() const { return stopped_early_ && world_.ticks() < last_tick_; }
  double flatness_before() const { return flatness_; }
  double wall_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  void check_purity(const RobotOutput& output) const {
    std::array<uint8_t, kOutputBytes> got{};
    std::array<uint8_t, kOutputBytes> expected{};
    pack(output, got);
    pack(expected_, expected);
    const auto difference = first_difference(kOutputColumns, expected, got);
    if (difference.has_value()) {
      throw RunError("two robots answered the same samples differently in tick " +
                     std::to_string(world_.ticks()) + ": " + *difference);
    }
  }

  World& world_;
  const SimulationOptions& options_;
  Parameters parameters_;
  Robot shadow_;
  RobotOutput expected_{};
  SessionWriter& writer_;
  FrameRecorder recorder_;
  std::vector<PathPoint> path_;
  uint64_t last_tick_;
  double duration_s_;
  double flatness_deg_;
  double flatness_;
  bool stopped_early_ = false;
  std::chrono::steady_clock::time_point begin_;
};

SessionInfo session_info(const Experiment& experiment, const SimulationOptions& options) {
  SessionInfo info;
  info.program_version = options.program_version;
  info.experiment_name = experiment.experiment.name;
  info.experiment_text = experiment.text();
  info.seed = experiment.experiment.seed;
  info.board_name = "a_star_32u4";
  info.board = kBoard;
  info.parameters = experiment.parameters;
  return info;
}

void write_pictures(const std::filesystem::path& folder, const HeightField& before,
                    const World& world, const Experiment& experiment, std::vector<PathPoint> path) {
  PictureOptions options;
  options.title = experiment.experiment.name + ": before";
  write_height_map_picture(folder / "terrain_before.png", before, options);

  options.title = experiment.experiment.name + ": after " +
                  std::to_string(std::lround(world.time_s())) + " s of " +
                  experiment.experiment.algorithm;
  // The legend names the states that occurred, in their order.
  std::array<bool, kLevelingStates> occurred{};
  for (const PathPoint& point : path) occurred.at(point.state) = true;
  std::array<size_t, kLevelingStates> legend{};
  for (size_t state = 0; state < kLevelingStates; ++state) {
    legend.at(state) = options.state_names.size();
    if (occurred.at(state)) options.state_names.emplace_back(kLevelingStateNames[state]);
  }
  for (PathPoint& point : path) point.state = legend.at(point.state);
  options.path = std::move(path);
  const ChassisState chassis = world.vehicle().chassis();
  options.robot = RobotOutline{chassis.pose.translation().x(), chassis.pose.translation().y(),
                               attitude_of(chassis.pose.linear()).heading};
  write_height_map_picture(folder / "terrain_after.png", world.terrain(), options);
}

nlohmann::ordered_json terrain_json(const TerrainStatistics& statistics, double flatness) {
  return {{"lowest_m", statistics.lowest_m},
          {"highest_m", statistics.highest_m},
          {"mean_height_m", statistics.mean_height_m},
          {"height_deviation_m", statistics.height_deviation_m},
          {"mean_slope_deg", statistics.mean_slope_deg},
          {"rms_slope_deg", statistics.rms_slope_deg},
          {"p95_slope_deg", statistics.p95_slope_deg},
          {"max_slope_deg", statistics.max_slope_deg},
          {"steepest_slope_deg", statistics.steepest_slope_deg},
          {"flatness", flatness}};
}

}  // namespace

const char* state_name(RobotState state) {
  const auto index = static_cast<size_t>(state);
  return index < kRobotStates ? kStateNames[index] : "unknown";
}

const char* leveling_state_name(LevelingState state) {
  const auto index = static_cast<size_t>(state);
  return index < kLevelingStates ? kLevelingStateNames[index] : "unknown";
}

std::string fault_names(uint16_t faults) {
  std::string names;
  for (size_t bit = 0; bit < std::size(kFaultNames); ++bit) {
    if ((faults >> bit & 1U) != 0)
      names += (names.empty() ? "" : ", ") + std::string(kFaultNames[bit]);
  }
  return names.empty() ? "none" : names;
}

HeightField make_terrain(const Experiment& experiment) {
  const auto& map = experiment.map;
  if (map.filename.empty()) {
    const double spacing = map.size_m / 64.0;
    return map.ramp_deg == 0.0 ? HeightField::flat(map.size_m, spacing)
                               : HeightField::ramp(map.size_m, spacing, map.ramp_deg);
  }
  HeightFieldOptions options;
  options.size_m = map.size_m;
  options.scale_m = map.scale_m;
  options.smoothing_m = map.smoothing_m;
  options.max_slope_deg = map.max_slope_deg;
  options.wrap = map.wrap;
  return HeightField::from_image(
      read_grey_image(find_data_file(experiment, map.filename, "[map] filename")), options);
}

std::unique_ptr<World> make_world(const Experiment& experiment, std::ostream* telemetry_log) {
  UrdfOptions urdf;
  if (experiment.vehicle.leg_angle_deg.has_value())
    urdf.leg_angle_rad = *experiment.vehicle.leg_angle_deg * kRadPerDeg;
  const Assembly model = import_urdf(find_model_file(experiment), urdf);

  WorldOptions options;
  options.seed = experiment.experiment.seed;
  options.physics_step_s = experiment.physics.step_s;
  options.start.x_m = experiment.vehicle.x_m;
  options.start.y_m = experiment.vehicle.y_m;
  options.start.z_m = experiment.vehicle.z_m;
  options.start.attitude = {experiment.vehicle.roll_deg * kRadPerDeg,
                            experiment.vehicle.pitch_deg * kRadPerDeg,
                            experiment.vehicle.heading_deg * kRadPerDeg};
  options.vehicle.tracks = experiment.vehicle.tracks;
  options.vehicle.track_friction = experiment.vehicle.track_friction;
  options.vehicle.chassis_friction = experiment.vehicle.chassis_friction;
  if (!experiment.sensors.noise) options.imu = ImuErrors::none();
  options.radio.delay_s = experiment.radio.delay_s;
  options.radio.loss = experiment.radio.loss;
  options.ground_station_arms = experiment.radio.ground_station;
  if (experiment.experiment.algorithm == "drive") {
    options.drive = DriveOrder{experiment.drive.speed_m_per_s, experiment.drive.yaw_rate_deg_per_s};
  }
  options.lay_on_side_at_s = experiment.experiment.lay_on_side_at_s;
  return std::make_unique<World>(make_terrain(experiment), model, kBoard, options, telemetry_log);
}

SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options) {
  // Everything that can be wrong with the input is found before the first file is made.
  make_world(experiment, nullptr);

  RunFolder folder =
      options.out.has_value()
          ? RunFolder::at(*options.out)
          : RunFolder::numbered(experiment.output_directory_prefix, experiment.experiment.name);
  write_text(folder.path() / "experiment.ini", experiment.text());
  TextFile telemetry(folder.path() / "telemetry.log");
  const std::unique_ptr<World> world = make_world(experiment, &telemetry.stream());
  const HeightField before = world->terrain();

  SimulationSummary summary;
  summary.before = terrain_statistics(before);
  SessionWriter writer(folder.path() / "session.h5", session_info(experiment, options));
  std::vector<int32_t> heights;
  writer.write_terrain_before(view_of(before, heights));

  RecordingTarget target(*world, experiment, options, writer);
  hal::run_firmware(target);
  summary.wall_s = target.wall_s();

  writer.write_terrain_after(view_of(world->terrain(), heights));
  summary.content_hash = writer.finish();
  telemetry.close();

  summary.folder = folder.final_path();
  summary.leftovers = folder.leftovers();
  summary.stopped_early = target.stopped_early();
  summary.time_s = world->time_s();
  summary.distance_m = target.recorder().distance_m();
  summary.outside_s = target.recorder().outside_s();
  summary.energy_j = world->battery().energy_j;
  summary.battery_v = world->battery().terminal_v;
  summary.peaks = target.robot().leveling().peaks();
  summary.state = state_name(target.robot().supervisor().state());
  summary.faults = target.robot().supervisor().faults();
  summary.telemetry_frames = world->ground_station().frames();
  summary.after = terrain_statistics(world->terrain());
  summary.flatness_before = target.flatness_before();
  summary.flatness_after = flatness(world->terrain(), experiment.experiment.flatness_deg);

  export_frames_csv(SessionReader(folder.path() / "session.h5"), folder.path() / "frames.csv");
  write_pictures(folder.path(), before, *world, experiment, std::move(target.path()));
  write_text(folder.path() / "summary.json", summary_json(summary));
  folder.commit();
  return summary;
}

std::string summary_json(const SimulationSummary& summary) {
  const nlohmann::ordered_json json = {
      {"content_hash", summary.content_hash},
      {"stopped_early", summary.stopped_early},
      {"time_s", summary.time_s},
      {"distance_m", summary.distance_m},
      {"energy_j", summary.energy_j},
      {"outside_bed_s", summary.outside_s},
      {"battery_v", summary.battery_v},
      {"peaks", summary.peaks},
      {"state", summary.state},
      {"faults", fault_names(summary.faults)},
      {"telemetry_frames", summary.telemetry_frames},
      {"terrain_before", terrain_json(summary.before, summary.flatness_before)},
      {"terrain_after", terrain_json(summary.after, summary.flatness_after)},
  };
  return json.dump(2) + "\n";
}

}  // namespace screed
