// Messages to rows.
#include "host_sim/run/scene/log_session.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/protocol/messages.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/track_slip.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_writer.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kRowRate_hz = 20;
constexpr std::uint64_t kRow_us = 1'000'000 / kRowRate_hz;
constexpr std::uint64_t kLongestSilence_us = 10'000'000;
constexpr double kMargin_m = 0.5;  ///< of ground around all paths
constexpr double kNode_m = 0.1;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kTurn_rad = 2.0 * std::numbers::pi;

/// What one kind of message said, over time.
template <typename Value>
using Said = std::vector<std::pair<std::uint64_t, Value>>;

/// The place of the last entry at or before that time, the first one for earlier times.
template <typename Value>
std::size_t last_at(const Said<Value>& said, std::uint64_t time_us) {
  const auto behind =
      std::upper_bound(said.begin(), said.end(), time_us,
                       [](std::uint64_t time, const auto& entry) { return time < entry.first; });
  return behind == said.begin() ? 0 : static_cast<std::size_t>(behind - said.begin()) - 1;
}

template <typename Value>
Value held(const Said<Value>& said, std::uint64_t time_us, Value unknown) {
  return said.empty() ? unknown : said[last_at(said, time_us)].second;
}

/// On the line between the two entries around that time.
template <size_t kSize>
std::array<double, kSize> between(const Said<std::array<double, kSize>>& said,
                                  std::uint64_t time_us) {
  std::array<double, kSize> value;
  value.fill(kUnknown);
  if (said.empty()) return value;
  const std::size_t i = last_at(said, time_us);
  value = said[i].second;
  if (i + 1 == said.size() || time_us <= said[i].first) return value;
  const auto& [next_us, next] = said[i + 1];
  const double share =
      static_cast<double>(time_us - said[i].first) / static_cast<double>(next_us - said[i].first);
  for (size_t k = 0; k < kSize; ++k) value[k] += share * (next[k] - value[k]);
  return value;
}

double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

/// The turn nearest to the one before, so that a line between them takes the short way.
double unwrapped(double angle_rad, double before_rad) {
  return before_rad + std::remainder(angle_rad - before_rad, kTurn_rad);
}

class RobotTrace {
 public:
  explicit RobotTrace(const BoardConstants& board)
      : count_m_(board.count_um_q4 / 16.0 * 1e-6), slip_estimate_(board) {}

  void add(const RobotLogFrame& it, std::uint64_t time_us) {
    const RobotHistory& robot = it.robot;
    const std::string_view name = it.message.name;
    const std::array<std::uint8_t, 8> data = frame_bytes(it.frame.frame);
    if (name == "ODOMETRY") {
      const double before = place_.empty() ? 0.0 : place_.back().second[2];
      add(place_, time_us,
          {*robot.value("odometry.x") * 1e-3, *robot.value("odometry.y") * 1e-3,
           unwrapped(radians(*robot.value("odometry.heading")), before)});
    } else if (name == "ATTITUDE") {
      const std::array<double, 3> before =
          attitude_.empty() ? std::array<double, 3>{} : attitude_.back().second;
      add(attitude_, time_us,
          {unwrapped(radians(*robot.value("attitude.roll")), before[0]),
           radians(*robot.value("attitude.pitch")),
           unwrapped(radians(*robot.value("attitude.heading")), before[2])});
    } else if (name == "LEVELING") {
      add(wanted_, time_us,
          {*robot.value("leveling.speed") * 1e-3, radians(*robot.value("leveling.turn_rate"))});
      add(activity_, time_us, static_cast<std::int32_t>(*robot.raw("leveling.state")));
      algorithm = robot.text("leveling.algorithm");
    } else if (name == "HEARTBEAT") {
      const auto heartbeat = message::Heartbeat::unpack(data.data());
      add(state_, time_us, {heartbeat.state, heartbeat.faults});
    } else if (name == "POWER") {
      add(battery_, time_us, {*robot.value("power.battery") * 1e-3});
    } else if (name == "ENCODERS") {
      add_counts(message::Encoders::unpack(data.data()), time_us);
    }
    const auto slip = slip_estimate_.add(time_us, it.message, message_bits(data.data()));
    if (slip.has_value())
      add(slip_, time_us, {slip->left.value_or(kUnknown), slip->right.value_or(kUnknown)});
  }

  /// `before`: the row before, null for the first one.
  SimFrame row(std::uint64_t time_us, double height_m, const SimFrame* before) const {
    SimFrame row;
    row.time = static_cast<double>(time_us) * 1e-6;
    const auto [x, y, heading] = between(place_, time_us);
    const auto [roll, pitch, attitude_heading] = between(attitude_, time_us);
    row.x = row.odometry_x = x;
    row.y = row.odometry_y = y;
    row.z = height_m;
    row.yaw = std::remainder(std::isfinite(heading) ? heading : attitude_heading, kTurn_rad);
    row.roll = row.est_roll = roll;
    row.pitch = row.est_pitch = pitch;
    row.est_heading = row.yaw;
    if (before != nullptr) {
      row.delta_x = row.x - before->x;
      row.delta_y = row.y - before->y;
      row.delta_theta = std::remainder(row.yaw - before->yaw, kTurn_rad);
    }
    const double forward_m =
        row.delta_x * portable::cos(row.yaw) + row.delta_y * portable::sin(row.yaw);
    row.velocity_x = forward_m * kRowRate_hz;
    row.rate_z = row.delta_theta * kRowRate_hz;
    const std::array<double, 2> wanted = held(wanted_, time_us, {kUnknown, kUnknown});
    row.linear = wanted[0];
    row.angular = wanted[1];
    const std::array<double, 2> tracks = held(tracks_, time_us, {kUnknown, kUnknown});
    row.track_left = tracks[0];
    row.track_right = tracks[1];
    const std::array<double, 2> slip = held(slip_, time_us, {kUnknown, kUnknown});
    row.slip_left = slip[0];
    row.slip_right = slip[1];
    row.battery = between(battery_, time_us)[0];
    for (double* unknown :
         {&row.v_left, &row.v_right, &row.velocity_y, &row.velocity_z, &row.rate_x, &row.rate_y,
          &row.sinkage_left, &row.sinkage_right, &row.load_left, &row.load_right, &row.current_left,
          &row.current_right, &row.energy})
      *unknown = kUnknown;
    row.leveling_state = held(activity_, time_us, 0);
    const std::array<std::int32_t, 2> state = held(state_, time_us, {0, 0});
    row.state = state[0];
    row.faults = state[1];
    return row;
  }

  const Said<std::array<double, 3>>& places() const { return place_; }

  std::string algorithm;

 private:
  /// Of two with one time the later one counts.
  template <typename Value>
  static void add(Said<Value>& said, std::uint64_t time_us, const Value& value) {
    if (!said.empty() && said.back().first >= time_us) {
      said.back().second = value;
    } else {
      said.emplace_back(time_us, value);
    }
  }

  void add_counts(const message::Encoders& counts, std::uint64_t time_us) {
    constexpr std::uint64_t kGap_us = 1'000'000;
    if (last_counts_.has_value() && time_us > counts_us_ && time_us < counts_us_ + kGap_us) {
      const double seconds = static_cast<double>(time_us - counts_us_) * 1e-6;
      const auto speed = [&](std::uint16_t now, std::uint16_t before) {
        return static_cast<std::int16_t>(now - before) * count_m_ / seconds;
      };
      add(tracks_, time_us,
          {speed(counts.left, last_counts_->left), speed(counts.right, last_counts_->right)});
    }
    last_counts_ = counts;
    counts_us_ = time_us;
  }

  double count_m_;
  Said<std::array<double, 3>> place_;     ///< m, m, rad
  Said<std::array<double, 3>> attitude_;  ///< roll, pitch, heading
  Said<std::array<double, 2>> wanted_;    ///< m/s, rad/s
  Said<std::array<double, 2>> tracks_;    ///< m/s
  Said<std::array<double, 2>> slip_;
  Said<std::array<double, 1>> battery_;  ///< V
  Said<std::array<std::int32_t, 2>> state_;
  Said<std::int32_t> activity_;
  TrackSlipEstimate slip_estimate_;
  std::optional<message::Encoders> last_counts_;
  std::uint64_t counts_us_ = 0;
};

/// A flat bed below all paths.
HeightMap ground_below(const std::map<RobotKey, RobotTrace>& robots) {
  double half_m = 0.0;
  for (const auto& [key, robot] : robots) {
    for (const auto& [time_us, place] : robot.places())
      half_m = std::max({half_m, std::abs(place[0]), std::abs(place[1])});
  }
  const double side_m = 2.0 * (std::ceil(half_m / kMargin_m) * kMargin_m + kMargin_m);
  HeightMap map;
  const auto nodes = static_cast<std::uint32_t>(std::lround(side_m / kNode_m)) + 1;
  map.geometry = {nodes, nodes, kHeightUnit_m, kNode_m, -0.5 * side_m, -0.5 * side_m};
  map.heights.assign(static_cast<std::size_t>(nodes) * nodes, 0);
  return map;
}

SessionInfo info_of(const fs::path& log, const std::string& board, const std::string& algorithm) {
  SessionInfo info;
  info.program_version = "telemetry log";
  info.experiment_name = log.filename().string();
  info.experiment_text =
      "[experiment]\nname = telemetry log\nalgorithm = " + algorithm + "\n\n[map]\nmodel = rigid\n";
  info.tick_rate_hz = kRowRate_hz;
  info.board_name = board;
  info.board = board_constants_of(board);
  return info;
}

/// Of the chassis over the ground, as the robot stands.
double chassis_height_m(const SessionInfo& info) {
  const Assembly robot = robot_model(setup_of(info, {}), info.board_name);
  const AssemblyWheel& wheel = robot.wheels[0][0];
  return wheel.radius_m - wheel.centre.z();
}

}  // namespace

void write_log_sessions(const fs::path& log, const fs::path& folder, const std::string& board) {
  const BoardConstants& constants = board_constants_of(board);
  std::map<RobotKey, RobotTrace> robots;
  LogClock clock;
  std::uint64_t now_us = 0;
  read_robot_log(log.string(), [&](const RobotLogFrame& it) {
    now_us += std::min(clock.add(it.frame.time_us, 0), kLongestSilence_us);
    robots.try_emplace(it.key, constants).first->second.add(it, now_us);
  });
  const HeightMap ground = ground_below(robots);
  std::size_t number = 0;
  for (const auto& [key, robot] : robots) {
    const fs::path of_robot = folder_of_robot(folder, number++);
    fs::create_directories(of_robot);
    const SessionInfo info = info_of(log, board, robot.algorithm);
    const double height_m = chassis_height_m(info);
    SessionWriter writer(of_robot / "session.h5", info);
    writer.write_terrain_before(ground.view());
    SimFrame row;
    for (std::uint64_t i = 0; i == 0 || i * kRow_us <= now_us; ++i) {
      row = robot.row(i * kRow_us, height_m, i == 0 ? nullptr : &row);
      writer.append(row, {}, {});
    }
    writer.write_terrain_after(ground.view());
    writer.finish();
  }
}

ShownRun::ShownRun(const fs::path& named, const std::string& board) : path_(named) {
  std::error_code error;
  const bool is_log =
      !fs::is_directory(named, error) && named.extension() != ".h5" && fs::exists(named, error);
  if (!is_log) return;
  std::string folder = (fs::temp_directory_path() / "screed-log.XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr)
    throw RunError(folder + ": cannot be made: " + std::strerror(errno));
  temporary_ = folder;
  path_ = temporary_;
  try {
    write_log_sessions(named, temporary_, board);
  } catch (...) {
    fs::remove_all(temporary_, error);
    throw;
  }
}

ShownRun::~ShownRun() {
  std::error_code ignored;
  if (is_log()) fs::remove_all(temporary_, ignored);
}

}  // namespace screed
