// Runs an experiment.
#include "host_sim/run/simulation/simulation.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <thread>

#include "firmware/robot/robot.h"
#include "hal/host/target.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/session/csv_export.h"
#include "host_sim/run/session/record.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/session/session_writer.h"
#include "host_sim/run/simulation/frame_recorder.h"
#include "host_sim/run/simulation/height_watch.h"
#include "host_sim/run/simulation/names.h"

namespace screed {
namespace {

constexpr double kLineBytesPerS = 5760.0;  // 57,600 baud
constexpr uint64_t kProgressTicks = kTickRate_hz / 10;
constexpr uint64_t kFlatnessTicks =
    5U * uint64_t{kTickRate_hz};  // a look at the whole bed costs milliseconds
// How long a training drive may take beyond its frames: to arm and to start.
constexpr uint64_t kMaxIdleTicks = 60U * uint64_t{kTickRate_hz};
constexpr uint64_t kPathTicks = kTickRate_hz / 10;  // a point of the drawn path ten times a second

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

/// The soil as it is used: the preset with what the experiment changed.
std::vector<SoilAttribute> attributes_of(const SoilParameters& soil) {
  return {{"k_phi", "N/m^(n+2)", soil.k_phi},
          {"k_c", "N/m^(n+1)", soil.k_c},
          {"n", "", soil.exponent},
          {"c", "Pa", soil.cohesion_pa},
          {"phi", "deg", soil.friction_deg},
          {"K", "m", soil.shear_modulus_m},
          {"E", "Pa/m", soil.elastic_pa_per_m},
          {"R", "Pa s/m", soil.damping_pa_s_per_m},
          {"shear_damping", "s", soil.shear_damping_s},
          {"repose", "deg", soil.repose_deg},
          {"compaction", "", soil.compaction},
          {"drag_depth", "m", soil.drag_depth_m},
          {"slip_sinkage", "", soil.slip_sinkage}};
}

/// Takes what every tick gives and keeps it: frames, path, progress.
///
/// Beside the robot that drives runs a second one on the same samples. The core is a pure function,
/// so both must give the same bytes; the second one also shows its thoughts, which the other,
/// behind its HAL or in its microcontroller, does not.
class Recorder {
 public:
  Recorder(const Environment& plant, const Experiment& experiment, const SimulationOptions& options,
           SessionWriter& writer)
      : plant_(plant),
        options_(options),
        shadow_(board_constants_of(options.board), experiment.parameters,
                credentials_of(experiment)),
        writer_(writer),
        training_frames_(frames_to_drive(experiment)),
        duration_s_(experiment.experiment.duration_s),
        flatness_deg_(experiment.experiment.flatness_deg),
        flatness_(flatness(plant.terrain(), flatness_deg_)),
        flatness_now_(flatness_),
        begin_(std::chrono::steady_clock::now()) {
    if (options.observer != nullptr) options.observer->on_begin(plant.terrain());
    if (!options.heights) return;
    watch_.emplace(plant.terrain());
    std::vector<int32_t> heights;
    writer.record_heights(view_of(plant.terrain(), heights));
  }

  /// The run has lasted as long as it was to: Algorithm 5 has driven all its frames, any other
  /// algorithm the duration.
  bool done() const {
    if (training_frames_ == 0)
      return ticks_ >= static_cast<uint64_t>(std::llround(duration_s_ * kTickRate_hz));
    return driven_ == training_frames_ || ticks_ >= training_frames_ + kMaxIdleTicks;
  }

  /// A training drive that a fault has ended: nobody clears it.
  bool given_up() const {
    return training_frames_ != 0 && shadow_.supervisor().state() == RobotState::kFault;
  }

  /// The run is to end, in time or before.
  bool stop_asked() const {
    return done() || given_up() || left_bed() ||
           (options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed));
  }

  /// A bed of soil or particles ends at its edges: who drives over them falls.
  bool left_bed() const {
    const Eigen::Vector3d place = plant_.vehicle().chassis().pose.translation();
    return plant_.is_deformable() && !plant_.terrain().wrap() &&
           !plant_.terrain().inside(place.x(), place.y());
  }

  /// The robot has read its sensors; the world stands as they saw it.
  void begin_tick(const SensorSample& sample) {
    sample_ = sample;
    shadow_.tick(sample, expected_);
    frame_ = recorder_.record(plant_, shadow_);
    if (shadow_.leveling().state() == LevelingState::kTrainingDrive &&
        shadow_.supervisor().running())
      ++driven_;
    if (watch_) changes_ = watch_->changes(plant_.terrain());
  }

  /// The robot has answered.
  void end_tick(const RobotOutput& output) {
    ++ticks_;
    radio_bytes_ += output.radio_out_count;
    radio_lines_ += static_cast<uint64_t>(
        std::count(output.radio_out, output.radio_out + output.radio_out_count, '\r'));
    check_purity(output);
    writer_.append(frame_, sample_, output, changes_);
    height_changes_ += changes_.size();
    if (ticks_ % kPathTicks == 1)
      path_.push_back({frame_.x, frame_.y, static_cast<size_t>(frame_.leveling_state)});
    if (plant_.is_deformable() && ticks_ % kFlatnessTicks == 0) {
      flatness_now_ = flatness(plant_.terrain(), flatness_deg_);
    }
    if (options_.progress && (ticks_ % kProgressTicks == 0 || done())) {
      options_.progress(
          {training_frames_ != 0 ? static_cast<double>(driven_) / kTickRate_hz : frame_.time,
           duration_s_, flatness_now_});
    }
    if (options_.observer != nullptr) options_.observer->on_tick(frame_, plant_.terrain());
    if (options_.realtime) {
      std::this_thread::sleep_until(begin_ +
                                    std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                        std::chrono::duration<double>(plant_.time_s())));
    }
  }

  const Robot& robot() const { return shadow_; }
  const FrameRecorder& frames() const { return recorder_; }
  std::vector<PathPoint>& path() { return path_; }
  double flatness_before() const { return flatness_; }
  uint64_t radio_lines() const { return radio_lines_; }
  uint64_t radio_bytes() const { return radio_bytes_; }
  uint64_t driven() const { return driven_; }
  uint64_t height_changes() const { return height_changes_; }
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
                     std::to_string(ticks_) + ": " + *difference);
    }
  }

  const Environment& plant_;
  const SimulationOptions& options_;
  Robot shadow_;
  SensorSample sample_{};
  RobotOutput expected_{};
  SimFrame frame_;
  SessionWriter& writer_;
  FrameRecorder recorder_;
  std::vector<PathPoint> path_;
  uint64_t radio_lines_ = 0;
  uint64_t radio_bytes_ = 0;
  std::optional<HeightWatch> watch_;
  std::span<const HeightChange> changes_;
  uint64_t height_changes_ = 0;
  uint64_t ticks_ = 0;
  uint64_t training_frames_;  ///< of Algorithm 5; 0 under another algorithm
  uint64_t driven_ = 0;       ///< of them, so far
  double duration_s_;
  double flatness_deg_;
  double flatness_;      ///< before the run
  double flatness_now_;  ///< a few seconds old at most
  std::chrono::steady_clock::time_point begin_;
};

/// The robot in the world, as the firmware's main loop sees it.
class NativeTarget : public hal::Target {
 public:
  NativeTarget(World& world, const Experiment& experiment, const SimulationOptions& options,
               Recorder& recorder)
      : world_(world),
        board_(board_constants_of(options.board)),
        parameters_(experiment.parameters),
        credentials_(credentials_of(experiment)),
        recorder_(recorder) {}

  void init() override {}
  const BoardConstants& board_constants() override { return board_; }
  const Parameters& parameters() override { return parameters_; }
  const Credentials& credentials() override { return credentials_; }

  bool wait_for_tick() override {
    if (recorder_.stop_asked()) return false;
    world_.advance();
    return true;
  }

  void read_sensors(SensorSample& sample) override {
    sample = world_.sample();
    recorder_.begin_tick(sample);
  }

  void write_outputs(const RobotOutput& output) override {
    recorder_.end_tick(output);
    world_.apply(output);
  }

 private:
  World& world_;
  const BoardConstants& board_;
  Parameters parameters_;
  Credentials credentials_;
  Recorder& recorder_;
};

/// Runs the experiment to its end or until told to stop, with the firmware as it is compiled for
/// the host or as the image. Built before the first file is made, so that wrong input leaves none.
class Run {
 public:
  Run(const Experiment& experiment, const SimulationOptions& options, std::ostream* telemetry_log)
      : experiment_(experiment), options_(options) {
    if (options.image.has_value()) {
      if (experiment.experiment.algorithm == kTrainingDriveName) {
        throw InputError(
            "[experiment] algorithm = training_drive is not part of the microcontroller's image; "
            "it runs "
            "without --hal mcu");
      }
      image_ = make_co_simulation(experiment, telemetry_log, options.board, *options.image,
                                  options.ground_port);
    } else {
      world_ = make_world(experiment, telemetry_log, options.board, options.ground_port,
                          options.environment);
    }
  }

  const Environment& plant() const { return image_ ? image_->plant() : world_->plant(); }
  const GroundStation& ground_station() const {
    return image_ ? image_->ground_station() : std::as_const(*world_).ground_station();
  }
  std::optional<CycleReport> cycles() const {
    return image_ ? std::optional(image_->cycles()) : std::nullopt;
  }

  void drive(Recorder& recorder) {
    if (!image_) {
      NativeTarget target(*world_, experiment_, options_, recorder);
      hal::run_firmware(target);
      return;
    }
    while (!recorder.stop_asked()) {
      const SensorSample& sample = image_->run_to_sample();
      if (plant().time_s() > experiment_.experiment.duration_s) break;
      recorder.begin_tick(sample);
      recorder.end_tick(image_->run_to_output());
    }
  }

 private:
  const Experiment& experiment_;
  const SimulationOptions& options_;
  std::unique_ptr<World> world_;
  std::unique_ptr<CoSimulation> image_;
};

SessionInfo session_info(const Experiment& experiment, const SimulationOptions& options) {
  SessionInfo info;
  info.program_version = options.program_version;
  info.experiment_name = experiment.experiment.name;
  info.experiment_text = experiment.text();
  info.seed = experiment.experiment.seed;
  info.board_name = options.board;
  info.board = board_constants_of(options.board);
  info.parameters = experiment.parameters;
  info.credentials = credentials_of(experiment);
  return info;
}

void write_pictures(const std::filesystem::path& folder, const HeightField& before,
                    const Environment& plant, const Experiment& experiment,
                    std::vector<PathPoint> path) {
  PictureOptions options;
  options.title = experiment.experiment.name + ": before";
  write_height_map_picture(folder / "terrain_before.png", before, options);

  options.title = experiment.experiment.name + ": after " +
                  std::to_string(std::lround(plant.time_s())) + " s of " +
                  experiment.experiment.algorithm;
  // The legend names the states that occurred, in their order.
  std::array<bool, kLevelingStates> occurred{};
  for (const PathPoint& point : path) occurred.at(point.state) = true;
  std::array<size_t, kLevelingStates> legend{};
  for (size_t state = 0; state < kLevelingStates; ++state) {
    legend.at(state) = options.state_names.size();
    if (occurred.at(state))
      options.state_names.emplace_back(leveling_state_name(static_cast<LevelingState>(state)));
  }
  for (PathPoint& point : path) point.state = legend.at(point.state);
  options.path = std::move(path);
  const ChassisState chassis = plant.vehicle().chassis();
  options.robot = RobotOutline{chassis.pose.translation().x(), chassis.pose.translation().y(),
                               attitude_of(chassis.pose.linear()).heading};
  write_height_map_picture(folder / "terrain_after.png", plant.terrain(), options);
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

uint64_t frames_to_drive(const Experiment& experiment) {
  if (experiment.experiment.algorithm != kTrainingDriveName) return 0;
  const uint64_t all = experiment.experiment.frames.value();
  if (!experiment.experiment.stop_after_s.has_value()) return all;
  const auto some = std::llround(*experiment.experiment.stop_after_s * kTickRate_hz);
  return std::min(all, static_cast<uint64_t>(some));
}

void check_simulation(const Experiment& experiment, const SimulationOptions& options) {
  const Run trial(experiment, options, nullptr);
}

SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options) {
  // Everything that can be wrong with the input is found before the first file is made; the log
  // gets its file afterwards.
  std::ostream telemetry_log(nullptr);
  Run run(experiment, options, &telemetry_log);

  RunFolder folder =
      options.out.has_value()
          ? RunFolder::at(*options.out)
          : RunFolder::numbered(options.root.value_or(experiment.output_directory_prefix),
                                experiment.experiment.name);
  write_file(folder.path() / "experiment.ini", experiment.text());
  TextFile telemetry(folder.path() / "telemetry.log");
  telemetry_log.rdbuf(telemetry.stream().rdbuf());
  const Environment& plant = run.plant();
  // As the experiment lays it out; the robot has settled into plant.terrain() already. Particles
  // lie as they fell.
  const HeightField before =
      plant.particles() != nullptr ? plant.terrain() : make_terrain(experiment);

  SimulationSummary summary;
  summary.before = terrain_statistics(before);
  SessionWriter writer(folder.path() / "session.h5", session_info(experiment, options));
  std::vector<int32_t> heights;
  writer.write_terrain_before(view_of(before, heights));
  if (experiment.map.model == "scm") writer.write_soil(attributes_of(make_soil(experiment)));

  Recorder recorder(plant, experiment, options, writer);
  run.drive(recorder);
  summary.wall_s = recorder.wall_s();
  if (options.observer != nullptr) options.observer->on_end();

  writer.write_terrain_after(view_of(plant.terrain(), heights));
  summary.content_hash = writer.finish();
  if (!telemetry_log) telemetry.stream().setstate(std::ios::failbit);
  telemetry.close();

  summary.folder = folder.final_path();
  summary.leftovers = folder.leftovers();
  summary.left_bed = recorder.left_bed();
  summary.stopped_early = !recorder.done();
  summary.training_frames = recorder.driven();
  summary.height_changes = recorder.height_changes();
  summary.time_s = plant.time_s();
  summary.distance_m = recorder.frames().distance_m();
  summary.outside_s = recorder.frames().outside_s();
  summary.energy_j = plant.battery().energy_j;
  summary.battery_v = plant.battery().terminal_v;
  summary.peaks = recorder.robot().leveling().peaks();
  summary.state = state_name(recorder.robot().supervisor().state());
  summary.faults = recorder.robot().supervisor().faults();
  summary.telemetry_frames = run.ground_station().frames();
  summary.telemetry_frames_damaged = run.ground_station().rejected_frames();
  summary.telemetry_frames_sent = recorder.radio_lines();
  summary.telemetry_share =
      static_cast<double>(recorder.radio_bytes()) / (plant.time_s() * kLineBytesPerS);
  summary.after = terrain_statistics(plant.terrain());
  summary.cycles = run.cycles();
  summary.flatness_before = recorder.flatness_before();
  summary.flatness_after = flatness(plant.terrain(), experiment.experiment.flatness_deg);

  if (options.table)
    export_frames_csv(SessionReader(folder.path() / "session.h5"), folder.path() / "frames.csv");
  write_pictures(folder.path(), before, plant, experiment, std::move(recorder.path()));
  write_file(folder.path() / "summary.json", summary_json(summary));
  folder.commit();
  return summary;
}

namespace {

nlohmann::ordered_json json_of(const CycleReport& cycles) {
  nlohmann::ordered_json interrupts;
  for (const CycleReport::Interrupt& it : cycles.interrupts) {
    interrupts[it.name] = {{"count", it.count},
                           {"longest_cycles", it.longest_cycles},
                           {"mean_cycles", it.mean_cycles}};
  }
  return {{"ticks", cycles.ticks},
          {"longest_tick_cycles", cycles.longest_tick_cycles},
          {"mean_tick_cycles", cycles.mean_tick_cycles},
          {"missed_ticks", cycles.missed_ticks},
          {"load", cycles.load},
          {"encoder_latency_cycles", cycles.encoder_latency_cycles},
          {"encoder_edges", cycles.encoder_edges},
          {"encoder_edges_missed", cycles.encoder_missing},
          {"uart_bytes_received", cycles.uart_received},
          {"uart_bytes_lost", cycles.uart_overruns},
          {"uart_bytes_sent", cycles.uart_sent},
          {"resets", cycles.resets},
          {"interrupts", interrupts}};
}

}  // namespace

std::string cycles_json(const CycleReport& cycles) {
  return json_of(cycles).dump(2) + "\n";
}

std::string summary_json(const SimulationSummary& summary) {
  nlohmann::ordered_json json = {
      {"content_hash", summary.content_hash},
      {"stopped_early", summary.stopped_early},
      {"left_bed", summary.left_bed},
      {"time_s", summary.time_s},
      {"distance_m", summary.distance_m},
      {"energy_j", summary.energy_j},
      {"outside_bed_s", summary.outside_s},
      {"battery_v", summary.battery_v},
      {"peaks", summary.peaks},
      {"training_frames", summary.training_frames},
      {"height_changes", summary.height_changes},
      {"state", summary.state},
      {"faults", fault_names(summary.faults)},
      {"telemetry_frames", summary.telemetry_frames},
      {"telemetry_frames_sent", summary.telemetry_frames_sent},
      {"telemetry_frames_damaged", summary.telemetry_frames_damaged},
      {"telemetry_share", summary.telemetry_share},
      {"terrain_before", terrain_json(summary.before, summary.flatness_before)},
      {"terrain_after", terrain_json(summary.after, summary.flatness_after)},
  };
  if (summary.cycles.has_value()) json["microcontroller"] = json_of(*summary.cycles);
  return json.dump(2) + "\n";
}

}  // namespace screed
