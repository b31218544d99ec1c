// Drives and their threads.
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
#include <thread>

#include "firmware/robot/robot.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"

namespace screed::nn {
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
