// Scenarios drawn, driven by several threads, and kept.
#include "nn/slip/slip_drive.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <numbers>
#include <thread>

#include "firmware/robot/robot.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"

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
  e.soil.overrides.slip_bearing = draw.between(0.1, 1.0);
  e.soil.overrides.slip_layer_m = draw.between(0.0, 0.003);
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

// ---- drives and their threads

namespace {

constexpr std::size_t kReportTicks = kTickRate_hz / 5;
constexpr double kHalfTread_m = 0.0975;
constexpr const char* kTask = "driving";

/// What all threads have driven.
class SharedProgress {
 public:
  SharedProgress(const TaskProgress& progress, double all_s) : progress_(progress), all_s_(all_s) {}

  /// Of one drive of that duration, by the thread that drives it.
  TaskProgress of_drive(double duration_s) {
    return [this, duration_s, counted_s = 0.0](std::string_view task, double share) mutable {
      const std::scoped_lock lock(mutex_);
      done_s_ += share * duration_s - counted_s;
      counted_s = share * duration_s;
      report_progress(progress_, task, std::min(1.0, done_s_ / all_s_));
    };
  }

 private:
  const TaskProgress& progress_;
  double all_s_;
  std::mutex mutex_;
  double done_s_ = 0.0;
};

SlipDrive recorded_drive(const StuckScenario& scenario, const TaskProgress& progress,
                         const std::filesystem::path& folder) {
  if (folder.empty()) return drive(scenario, progress);
  const std::filesystem::path file = folder / archive_name(scenario);
  if (std::optional<SlipDrive> found = read_drive(file, scenario)) return *std::move(found);
  SlipDrive driven = drive(scenario, progress);
  write_drive(file, driven);
  return driven;
}

}  // namespace

SlipTick slip_tick_of(const World& world) {
  const SensorSample& sample = world.sample();
  const Robot& robot = world.firmware();
  const VehicleState& vehicle = world.vehicle();
  const ChassisState chassis = vehicle.chassis();
  const Eigen::Vector3d velocity = chassis.pose.linear().transpose() * chassis.velocity;
  const DriveControl& drive = robot.drive();
  SlipTick tick{};
  tick.speed_left = drive.left().speed_dmm_per_s;
  tick.effort_left = drive.left().effort;
  tick.speed_right = drive.right().speed_dmm_per_s;
  tick.effort_right = drive.right().effort;
  std::copy_n(sample.imu.gyro(), tick.gyro.size(), tick.gyro.begin());
  std::copy_n(sample.imu.accel(), tick.accel.size(), tick.accel.begin());
  tick.sin_pitch_q14 = robot.attitude().angles().sin_pitch_q14;
  tick.yaw_rate = robot.attitude().yaw_rate();
  tick.running = robot.supervisor().running();
  tick.speed = static_cast<float>(velocity.x());
  tick.turn = static_cast<float>(chassis.omega_body.z() * kHalfTread_m);
  tick.track_left = static_cast<float>(vehicle.track_speed_m_per_s(kLeft));
  tick.track_right = static_cast<float>(vehicle.track_speed_m_per_s(kRight));
  return tick;
}

SlipDrive drive_of(const StuckScenario& scenario) {
  const Experiment& e = scenario.experiment;
  return {e.experiment.seed, scenario.kind, scenario.ground, e.trap.kind, {}, {}};
}

SlipDrive drive(const StuckScenario& scenario, const TaskProgress& progress) {
  SlipDrive driven = drive_of(scenario);
  const Experiment& e = scenario.experiment;
  try {
    const std::unique_ptr<World> world = make_world(e);
    const auto ticks =
        static_cast<std::size_t>(std::lround(e.experiment.duration_s * kTickRate_hz));
    driven.ticks.reserve(ticks);
    for (std::size_t i = 0; i < ticks; ++i) {
      if (i % kReportTicks == 0) report_progress(progress, kTask, i, ticks);
      world->advance();
      driven.ticks.push_back(slip_tick_of(*world));
      if (world->firmware().supervisor().faults() != 0) break;
    }
  } catch (const RunError& error) {
    driven.failure = error.what();
  }
  return driven;
}

std::vector<SlipDrive> drive_all(const std::vector<StuckScenario>& scenarios, unsigned threads,
                                 const TaskProgress& progress,
                                 const std::filesystem::path& folder) {
  MadeFolders folders;
  if (!folder.empty()) folders.make(folder);
  std::vector<SlipDrive> runs(scenarios.size());
  double all_s = 0.0;
  for (const StuckScenario& scenario : scenarios)
    all_s += scenario.experiment.experiment.duration_s;
  SharedProgress shared(progress, all_s);
  in_threads(scenarios.size(), threads, [&](std::size_t i) {
    const TaskProgress of_drive = shared.of_drive(scenarios[i].experiment.experiment.duration_s);
    runs[i] = recorded_drive(scenarios[i], of_drive, folder);
    of_drive(kTask, 1.0);  // of one that ended early
  });
  return runs;
}

void in_threads(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto take_turns = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    } catch (...) {
      const std::scoped_lock lock(mutex);
      failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::jthread> others;
  for (unsigned i = 1; i < threads; ++i) others.emplace_back(take_turns);
  take_turns();
  others.clear();  // joins
  if (failure) std::rethrow_exception(failure);
}

// ---- archive: recorded drives as files

// A file: "SCRSLIP1", u32 ticks, u32 length of the failure's text, the text, then the ticks, 42
// bytes each, fields in the order of SlipTick, little endian.

namespace {

static_assert(std::endian::native == std::endian::little, "files are little endian");
constexpr std::string_view kMagic = "SCRSLIP1";

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }
  void text(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Reader {
 public:
  Reader(std::vector<char> bytes, std::string file)
      : bytes_(std::move(bytes)), file_(std::move(file)) {}
  template <class T>
  void operator()(T& value) {
    std::memcpy(&value, take(sizeof value), sizeof value);
  }
  std::string text(std::size_t length) { return {take(length), length}; }
  bool at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail() const {
    throw InputError(file_ + ": no recorded drive of this version; remove it");
  }

 private:
  const char* take(std::size_t length) {
    if (bytes_.size() - at_ < length) fail();
    at_ += length;
    return bytes_.data() + at_ - length;
  }

  std::vector<char> bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

template <class Tick, class Visitor>
void visit(Tick& tick, Visitor& field) {
  field(tick.speed_left);
  field(tick.effort_left);
  field(tick.speed_right);
  field(tick.effort_right);
  field(tick.gyro);
  field(tick.accel);
  field(tick.sin_pitch_q14);
  field(tick.yaw_rate);
  field(tick.running);
  field(tick.speed);
  field(tick.turn);
  field(tick.track_left);
  field(tick.track_right);
}

}  // namespace

std::string archive_name(const StuckScenario& scenario) {
  ContentHash hash;
  hash.add(scenario.experiment.text());
  return std::string(name_of(scenario.kind)) + "-" +
         std::to_string(scenario.experiment.experiment.seed) + "-" + hash.hex().substr(0, 12) +
         ".drive";
}

std::optional<SlipDrive> read_drive(const std::filesystem::path& file,
                                    const StuckScenario& scenario) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  Reader reader({std::istreambuf_iterator<char>(stream), {}}, file.string());
  if (reader.text(kMagic.size()) != kMagic) reader.fail();
  SlipDrive drive = drive_of(scenario);
  std::uint32_t ticks = 0;
  std::uint32_t failure = 0;
  reader(ticks);
  reader(failure);
  drive.failure = reader.text(failure);
  for (std::uint32_t i = 0; i < ticks; ++i) visit(drive.ticks.emplace_back(), reader);
  if (!reader.at_end()) reader.fail();
  return drive;
}

void write_drive(const std::filesystem::path& file, const SlipDrive& drive) {
  Writer writer;
  writer.text(kMagic);
  writer(static_cast<std::uint32_t>(drive.ticks.size()));
  writer(static_cast<std::uint32_t>(drive.failure.size()));
  writer.text(drive.failure);
  for (const SlipTick& tick : drive.ticks) visit(tick, writer);
  AtomicFile out(file);
  out.write(writer.bytes());
  out.commit();
}

}  // namespace screed::nn
