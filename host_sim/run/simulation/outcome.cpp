// Names, measures and ends of a run.
#include "host_sim/run/simulation/outcome.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "schema/class_values.h"

namespace screed {

namespace {

const char* name_of(const SignalInfo& signal, int64_t value) {
  const char* const name = signal.value_name(value);
  return name == nullptr ? "unknown" : name;
}

}  // namespace

const char* state_name(RobotState state) {
  static const SignalInfo& signal = *find_signal("heartbeat.state").signal;
  return name_of(signal, static_cast<int64_t>(state));
}

const char* leveling_state_name(message::LevelingState state) {
  static const SignalInfo& signal = *find_signal("leveling.state").signal;
  return name_of(signal, static_cast<int64_t>(state));
}

std::vector<std::string> leveling_state_names() {
  std::vector<std::string> names;
  names.reserve(kLevelingStates);
  for (size_t state = 0; state < kLevelingStates; ++state) {
    names.emplace_back(leveling_state_name(static_cast<message::LevelingState>(state)));
  }
  return names;
}

std::string fault_names(uint16_t faults) {
  const std::string names = flag_names("heartbeat", "faults", faults);
  return names.empty() ? "none" : names;
}

// One way to measure, whoever asks.

namespace {

TerrainFigures figures_of(const HeightField& surface, double flat_deg) {
  return {terrain_statistics(surface), flatness(surface, flat_deg),
          robot_scale_figures(surface, flat_deg)};
}

TerrainFigures figures_of(const TerrainStatistics& statistics, const LevelingPoint& point) {
  return {statistics,
          point.flatness,
          {point.level_deviation, point.relief, point.roughness, point.robot_scale_flatness}};
}

}  // namespace

TerrainMeasure::TerrainMeasure(const Experiment& experiment)
    : grain_m_(experiment.map.of_particles() ? experiment.map.particle_radius_m : 0.0),
      flat_deg_(experiment.experiment.flatness_deg) {}

HeightField TerrainMeasure::surface(const HeightField& terrain) const {
  return is_filtered() ? low_passed(terrain, grain_m_) : terrain;
}

TerrainOutcome TerrainMeasure::outcome(const HeightField& before, const HeightField& after) const {
  return {figures_of(before, flat_deg_), figures_of(after, flat_deg_),
          terrain_change(before, after)};
}

TerrainOutcome TerrainMeasure::outcome(const HeightField& before, const HeightField& after,
                                       const LevelingPoint& first, const LevelingPoint& last) {
  const TerrainChange change = terrain_change(before, after);
  const TerrainStatistics statistics = terrain_statistics(before);
  return {figures_of(statistics, first),
          figures_of(change.is_none() ? statistics : terrain_statistics(after), last), change};
}

// Counting ticks, and who ends a run.

namespace {

// How long a training drive may take beyond its frames: to arm and to start.
constexpr uint64_t kMaxIdleTicks = 60U * uint64_t{kTickRate_hz};

}  // namespace

const char* end_text(RunEnd end) {
  switch (end) {
    case RunEnd::kDone:
      return "done";
    case RunEnd::kFault:
      return "a fault stopped the training drive";
    case RunEnd::kLeftBed:
      return "the robot left the bed";
    case RunEnd::kStopped:
      return "stopped on request";
  }
  return "unknown";
}

uint64_t frames_to_drive(const Experiment& experiment) {
  if (experiment.experiment.algorithm != kTrainingDriveName) return 0;
  const uint64_t all = experiment.experiment.frames.value();
  if (!experiment.experiment.stop_after_s.has_value()) return all;
  const auto some = std::llround(*experiment.experiment.stop_after_s * kTickRate_hz);
  return std::min(all, static_cast<uint64_t>(some));
}

bool left_bed(const HeightField& bed, const RobotView& robot) {
  const Eigen::Vector3d place = robot.vehicle().chassis().pose.translation();
  return !bed.wrap() && !bed.inside(place.x(), place.y());
}

StopCondition::StopCondition(const Experiment& experiment, const std::atomic<bool>* stop)
    : training_frames_(frames_to_drive(experiment)),
      duration_s_(experiment.experiment.duration_s),
      stop_(stop) {}

void StopCondition::count_tick(RobotState state, message::LevelingState leveling) {
  ++ticks_;
  fault_ = state == RobotState::kFault;
  if (leveling == message::LevelingState::kTrainingDrive && state == RobotState::kRunning)
    ++driven_;
}

uint64_t StopCondition::ticks_to_run() const {
  return static_cast<uint64_t>(std::llround(duration_s_ * kTickRate_hz));
}

bool StopCondition::is_over(double time_s) const {
  constexpr double kRounding_s = 1e-9;
  return training_frames_ == 0 &&
         time_s > static_cast<double>(ticks_to_run()) / kTickRate_hz + kRounding_s;
}

bool StopCondition::done() const {
  if (training_frames_ == 0) return ticks_ >= ticks_to_run();
  return driven_ == training_frames_ || ticks_ >= training_frames_ + kMaxIdleTicks;
}

std::optional<RunEnd> StopCondition::reason(bool off_bed) const {
  if (done()) return RunEnd::kDone;
  if (training_frames_ != 0 && fault_) return RunEnd::kFault;
  if (off_bed) return RunEnd::kLeftBed;
  if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) return RunEnd::kStopped;
  return std::nullopt;
}

double StopCondition::counted_s(double time_s) const {
  return training_frames_ != 0 ? static_cast<double>(driven_) / kTickRate_hz : time_s;
}

// When to measure.

namespace {

constexpr double kRounding_s = 1e-6;  ///< of times that are sums of steps

TraversabilityLimits limits_of(const Experiment& experiment, double tread_m) {
  constexpr double kRadPerCentidegree = std::numbers::pi / 18000.0;
  return {0.5 * tread_m, experiment.parameters.tilt_limit() * kRadPerCentidegree,
          experiment.parameters.site_radius() * 1e-3, BedBounds{}};
}

bool returns_to_site(const SimFrame& frame) {
  return frame.state == static_cast<int>(message::HeartbeatState::kRunning) &&
         frame.leveling_state == static_cast<int>(message::LevelingState::kReturn);
}

/// The first whole multiple of the interval behind this time; never for an interval of 0.
double next_after(double time_s, double interval_s) {
  if (interval_s <= 0.0) return std::numeric_limits<double>::infinity();
  return (std::floor((time_s + kRounding_s) / interval_s) + 1.0) * interval_s;
}

Traversability mean_shares(const std::vector<TraversabilityMeter>& robots) {
  Traversability mean;
  mean.visited = 0.0;
  for (const TraversabilityMeter& robot : robots) {
    const Traversability shares = robot.shares();
    mean.stuck += shares.stuck;
    mean.tilted += shares.tilted;
    mean.off_site += shares.off_site;
    mean.returning += shares.returning;
    mean.visited += shares.visited;
    mean.slip += shares.slip;
  }
  const auto count = static_cast<double>(robots.size());
  mean.stuck /= count;
  mean.tilted /= count;
  mean.off_site /= count;
  mean.returning /= count;
  mean.visited /= count;
  mean.slip /= count;
  return mean;
}

}  // namespace

LevelingMonitor::LevelingMonitor(const Experiment& experiment, double tread_m, bool deformable)
    : measure_(experiment),
      meter_(measure_.flat_deg()),
      robots_(experiment.robots.count),
      limits_(limits_of(experiment, tread_m)),
      interval_s_(experiment.metrics.interval_s),
      transport_interval_s_(experiment.metrics.transport_interval_s),
      deformable_(deformable),
      next_s_(next_after(0.0, interval_s_)),
      next_transport_s_(next_after(0.0, transport_interval_s_)) {}

void LevelingMonitor::begin(const HeightField& before, const Sink& sink) {
  limits_.bed = bounds_of(before);
  traversability_.assign(robots_, TraversabilityMeter(limits_));
  outcome_.before = measure(before, deformable_);
  sink(outcome_.before);
}

void LevelingMonitor::on_tick(std::span<const SimFrame> frames, double distance_m,
                              const Surface& terrain, const Sink& sink) {
  cost_.energy_j = 0.0;
  for (size_t i = 0; i < frames.size(); ++i) {
    traversability_[i].on_tick(frames[i], returns_to_site(frames[i]));
    cost_.energy_j += frames[i].energy;
  }
  const double time_s = frames.front().time;
  cost_.time_s = time_s;
  cost_.distance_m = distance_m;
  if (time_s < next_s_ - kRounding_s) return;
  next_s_ = next_after(time_s, interval_s_);
  const bool with_transport = deformable_ && time_s >= next_transport_s_ - kRounding_s;
  if (with_transport) next_transport_s_ = next_after(time_s, transport_interval_s_);
  sink(deformable_ ? measure(terrain(), with_transport)
                   : LevelingMeter::unchanged(outcome_.before, cost()));
}

void LevelingMonitor::end(const HeightField& after, const Sink& sink) {
  outcome_.after =
      deformable_ ? measure(after, true) : LevelingMeter::unchanged(outcome_.before, cost());
  sink(outcome_.after);
}

LevelingCost LevelingMonitor::cost() const {
  LevelingCost cost = cost_;
  cost.traversability = mean_shares(traversability_);
  return cost;
}

LevelingPoint LevelingMonitor::measure(const HeightField& terrain, bool with_transport) {
  if (!measure_.is_filtered()) return meter_.measure(terrain, cost(), with_transport);
  return meter_.measure(measure_.surface(terrain), cost(), with_transport);
}

}  // namespace screed
