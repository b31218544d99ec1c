// Motions between moments.
#include "host_sim/soil_validation/wheel_schedule.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/core/csv_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

constexpr double kMaxSpeed_m_per_s = 10.0;
constexpr double kMaxDuration_s = 3600.0;

WheelMotion motion_of(double travel, double slip_angle_rad, double rim) {
  const auto [sin, cos] = portable::sine_cosine(slip_angle_rad);
  return {travel * cos, travel * sin, rim};
}

}  // namespace

WheelSchedule::WheelSchedule(std::vector<Moment> moments) : moments_(std::move(moments)) {
  if (moments_.empty() || moments_.front().time_s != 0.0)
    throw InputError("schedule of a wheel: its first moment must be at 0 s");
  for (size_t i = 0; i < moments_.size(); ++i) {
    const WheelMotion& motion = moments_[i].motion;
    for (const double speed : {motion.ahead, motion.left, motion.rim})
      check_range("schedule of a wheel", "speed", speed, -kMaxSpeed_m_per_s, kMaxSpeed_m_per_s);
    if (i > 0 && !(moments_[i].time_s > moments_[i - 1].time_s))
      throw InputError("schedule of a wheel: its times must rise");
  }
  check_range("schedule of a wheel", "duration", duration_s(), 0.0, kMaxDuration_s);
}

WheelMotion WheelSchedule::at(double time_s) const {
  const auto after =
      std::upper_bound(moments_.begin(), moments_.end(), time_s,
                       [](double time, const Moment& moment) { return time < moment.time_s; });
  if (after == moments_.begin()) return moments_.front().motion;
  if (after == moments_.end()) return moments_.back().motion;
  const Moment& from = *std::prev(after);
  const double share = (time_s - from.time_s) / (after->time_s - from.time_s);
  const auto between = [&](double WheelMotion::*speed) {
    return from.motion.*speed + share * (after->motion.*speed - from.motion.*speed);
  };
  return {between(&WheelMotion::ahead), between(&WheelMotion::left), between(&WheelMotion::rim)};
}

WheelSchedule read_wheel_schedule(const std::string& file) {
  CsvReader reader(file);
  CsvLine line;
  if (!reader.next(line)) throw InputError(file + ": is empty");
  const std::vector<std::string> names = line.cells;
  std::vector<WheelSchedule::Moment> moments;
  while (reader.next(line)) {
    const CsvRow row(file, names, line);
    const double time = row.number("time_s", 0.0, kMaxDuration_s);
    if (moments.empty() ? time != 0.0 : !(time > moments.back().time_s))
      row.refuse(moments.empty() ? "the first time_s must be 0" : "time_s must rise");
    const double travel = row.number("travel_m_s", -kMaxSpeed_m_per_s, kMaxSpeed_m_per_s);
    const double angle = row.number_if_any("slip_angle_deg", -180.0, 180.0).value_or(0.0);
    const double rim = row.number("rim_m_s", -kMaxSpeed_m_per_s, kMaxSpeed_m_per_s);
    moments.push_back({time, motion_of(travel, angle * kDegree, rim)});
  }
  if (moments.empty()) throw InputError(file + ": no moment");
  return WheelSchedule(std::move(moments));
}

WheelSchedule step_of_slip(double travel_m_per_s, double slip_angle_rad, double rim_m_per_s,
                           double time_constant_s, double duration_s) {
  const WheelMotion end = motion_of(travel_m_per_s, slip_angle_rad, rim_m_per_s);
  // So finely that no speed is wrong by more than 1 % of the step.
  constexpr double kFineness = 0.25;
  constexpr int kSteps = 24;
  std::vector<WheelSchedule::Moment> moments;
  for (int i = 0; i < kSteps; ++i) {
    WheelMotion motion = end;
    motion.rim += (end.ahead - end.rim) * portable::exp(-kFineness * i);
    moments.push_back({kFineness * i * time_constant_s, motion});
  }
  moments.push_back({std::max(duration_s, kFineness * kSteps * time_constant_s), end});
  return WheelSchedule(std::move(moments));
}

}  // namespace screed
