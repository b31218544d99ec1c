// Extremes of buckets.
#include "host_sim/run/report/page_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/core/elementary.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/run/simulation/outcome.h"

namespace screed {

CurveSampling::CurveSampling(std::uint64_t tick_count)
    : ticks(tick_count),
      bucket_ticks(
          tick_count <= kMaxSamples ? 1 : (tick_count + kMaxSamples / 2 - 1) / (kMaxSamples / 2)) {}

std::vector<std::uint64_t> CurveSampling::rows() const {
  std::vector<std::uint64_t> rows;
  for (std::uint64_t first = 0; first < ticks; first += bucket_ticks) {
    rows.push_back(first);
    if (bucket_ticks == 1) continue;
    // A last bucket of one tick has its middle at its only row.
    const std::uint64_t count = std::min(bucket_ticks, ticks - first);
    rows.push_back(first + count / 2);
  }
  return rows;
}

void CurveSampler::add(double value) {
  if (std::isfinite(value)) {
    if (!any_) {
      low_ = high_ = value;
      high_first_ = false;
    } else if (value > high_) {
      high_ = value;
      high_first_ = false;
    } else if (value < low_) {
      low_ = value;
      high_first_ = true;
    }
    any_ = true;
  }
  if (++in_bucket_ == sampling_.bucket_ticks) finish_bucket();
}

void CurveSampler::finish_bucket() {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const float low = any_ ? static_cast<float>(low_) : kNone;
  const float high = any_ ? static_cast<float>(high_) : kNone;
  samples_.push_back(high_first_ ? high : low);
  if (sampling_.bucket_ticks > 1) samples_.push_back(high_first_ ? low : high);
  in_bucket_ = 0;
  any_ = false;
}

std::vector<float> CurveSampler::samples() {
  if (in_bucket_ > 0) finish_bucket();
  return samples_;
}

// Points by distance, states by their changes.

void PageTrack::add(std::uint64_t row, const SimFrame& frame) {
  if (!std::isfinite(frame.x) || !std::isfinite(frame.y) || !std::isfinite(frame.z)) return;
  if (!points_.empty()) {
    const Point& last = points_.back();
    const bool same_bed = last.beds_x == frame.beds_x && last.beds_y == frame.beds_y;
    if (same_bed && portable::hypot(frame.x - last.x, frame.y - last.y) < spacing_m_) return;
  }
  points_.push_back({static_cast<std::uint32_t>(row), frame.x, frame.y, frame.z,
                     static_cast<std::uint32_t>(frame.leveling_state), frame.beds_x, frame.beds_y});
  if (points_.size() > kMaxPoints) thin();
}

void PageTrack::thin() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); i += 2) points_[kept++] = points_[i];
  points_.resize(kept);
  spacing_m_ *= 2.0;
}

Json PageTrack::finish(PageFile& page, const std::string& block) const {
  std::vector<std::uint32_t> rows;
  std::vector<float> places;
  std::vector<std::uint32_t> states;
  Json breaks = Json::array();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& it = points_[i];
    rows.push_back(it.row);
    for (const double place : {it.x, it.y, it.z}) places.push_back(static_cast<float>(place));
    states.push_back(it.state);
    if (i > 0 && (it.beds_x != points_[i - 1].beds_x || it.beds_y != points_[i - 1].beds_y)) {
      breaks.push_back(i);
    }
  }
  page.add_numbers(block + "-rows", std::span<const std::uint32_t>(rows));
  page.add_numbers(block + "-places", std::span<const float>(places));
  page.add_numbers(block + "-states", std::span<const std::uint32_t>(states));
  return {
      {"block", block}, {"points", points_.size()}, {"spacing_m", spacing_m_}, {"breaks", breaks}};
}

void PageEvents::extend(std::vector<Band>& bands, double time_s, std::int32_t state) {
  if (!bands.empty()) bands.back().end_s = time_s;
  if (bands.empty() || bands.back().state != state) bands.push_back({time_s, time_s, state});
}

void PageEvents::add(const SimFrame& frame) {
  const std::int32_t before = supervisor_.empty() ? -1 : supervisor_.back().state;
  extend(leveling_, frame.time, frame.leveling_state);
  extend(supervisor_, frame.time, frame.state);
  if (frame.state != before) {
    events_.push_back({frame.time, state_name(static_cast<RobotState>(frame.state))});
  }
  if (frame.faults == faults_) return;
  const auto appeared = static_cast<std::uint16_t>(frame.faults & ~faults_);
  const auto cleared = static_cast<std::uint16_t>(faults_ & ~frame.faults);
  if (appeared != 0) events_.push_back({frame.time, "fault: " + fault_names(appeared), true});
  if (cleared != 0) events_.push_back({frame.time, "fault cleared: " + fault_names(cleared)});
  faults_ = frame.faults;
}

void PageEvents::finish(Json& json) const {
  const auto list = [](const std::vector<Band>& bands) {
    Json all = Json::array();
    for (const Band& it : bands) all.push_back({it.begin_s, it.end_s, it.state});
    return all;
  };
  json["leveling"] = list(leveling_);
  json["supervisor"] = list(supervisor_);
  json["supervisor_states"] = value_names("heartbeat.state");
  json["events"] = Json::array();
  for (const Event& it : events_)
    json["events"].push_back({{"time_s", it.time_s}, {"text", it.text}});
}

}  // namespace screed
