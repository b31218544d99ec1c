// The summary as JSON.
#include "host_sim/run/simulation/run_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/core/content_hash.h"
#include "host_sim/run/simulation/outcome.h"

namespace screed {
namespace {

constexpr double kStartTime_s = 10.0;  ///< attitude and battery are known after 5 s

Json json_of(const RunIdentity& run) {
  Json json = {{"name", run.experiment}, {"algorithm", run.algorithm}, {"seed", run.seed}};
  Json& world = json["world"];
  world = {{"hal", run.hal}, {"board", run.board}, {"terrain", run.terrain}, {"soil", nullptr}};
  if (run.soil.has_value()) world["soil"] = *run.soil;
  json["version"] = run.version;
  return json;
}

Json json_of(const TerrainFigures& terrain) {
  const TerrainStatistics& heights = terrain.heights;
  return {{"lowest_m", heights.lowest_m},
          {"highest_m", heights.highest_m},
          {"mean_height_m", heights.mean_height_m},
          {"height_deviation_m", heights.height_deviation_m},
          {"mean_slope_deg", heights.mean_slope_deg},
          {"rms_slope_deg", heights.rms_slope_deg},
          {"p95_slope_deg", heights.p95_slope_deg},
          {"steepest_slope_deg", heights.steepest_slope_deg},
          {"flatness", terrain.flatness},
          {"level_deviation_m", terrain.robot_scale.level_deviation_m},
          {"relief_m", terrain.robot_scale.relief_m},
          {"roughness_m", terrain.robot_scale.roughness_m},
          {"robot_scale_flatness", terrain.robot_scale.flatness}};
}

/// What is not a number becomes null.
Json json_of(const LevelingOutcome& leveling) {
  const LevelingPoint& before = leveling.before;
  const LevelingPoint& after = leveling.after;
  return {{"progress", after.progress},
          {"progress_w2", 1.0 - std::sqrt(after.transport_squared / before.transport_squared)},
          {"transport_before_m4", before.transport},
          {"transport_after_m4", after.transport},
          {"transport_error_m4", std::max(before.transport_error, after.transport_error)},
          {"squared_transport_before_m5", before.transport_squared},
          {"squared_transport_after_m5", after.transport_squared},
          {"transport_per_joule_m4", after.transport_per_joule},
          {"slip", after.slip},
          {"stuck", after.stuck},
          {"tilted", after.tilted},
          {"off_site", after.off_site},
          {"returning", after.returning},
          {"visited", after.visited}};
}

Json json_of(const CycleReport& cycles) {
  Json interrupts;
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

Json json_of(const std::optional<double>& value) {
  return value.has_value() ? Json(*value) : Json(nullptr);
}

Json json_of(const RobotSummary& robot) {
  return {{"content_hash", robot.content_hash},
          {"left_bed", robot.left_bed},
          {"distance_m", robot.distance_m},
          {"energy_j", robot.energy_j},
          {"battery_v", robot.battery_v},
          {"battery_charge", robot.battery_charge},
          {"charge_lasts_h", json_of(robot.charge_lasts_h)},
          {"peaks", robot.peaks},
          {"state", robot.state},
          {"faults", fault_names(robot.faults)},
          {"cannot_be_armed", robot.cannot_be_armed},
          {"telemetry_frames", robot.telemetry_frames},
          {"telemetry_frames_sent", robot.telemetry_frames_sent},
          {"telemetry_frames_damaged", robot.telemetry_frames_damaged},
          {"telemetry_share", robot.telemetry_share}};
}

Json json_of(const SimulationSummary& summary) {
  Json json = json_of(summary.identity);
  json.update({
      {"content_hash", summary.content_hash},
      {"stopped_early", summary.stopped_early()},
      {"left_bed", summary.left_bed},
      {"time_s", summary.time_s},
      {"distance_m", summary.distance_m},
      {"energy_j", summary.energy_j},
      {"battery_v", summary.battery_v},
      {"battery_charge", summary.battery_charge},
      {"charge_lasts_h", json_of(summary.charge_lasts_h)},
      {"peaks", summary.peaks},
      {"training_frames", summary.training_frames},
      {"height_changes", summary.height_changes},
      {"state", summary.state},
      {"faults", fault_names(summary.faults)},
      {"cannot_be_armed", summary.cannot_be_armed},
      {"telemetry_frames", summary.telemetry_frames},
      {"telemetry_frames_sent", summary.telemetry_frames_sent},
      {"telemetry_frames_damaged", summary.telemetry_frames_damaged},
      {"telemetry_share", summary.telemetry_share},
      {"terrain_before", json_of(summary.terrain.before)},
      {"terrain_after", json_of(summary.terrain.after)},
      {"terrain_change", json_of(summary.terrain.change)},
      {"leveling", json_of(summary.leveling)},
  });
  for (const RobotSummary& robot : summary.robots) json["robots"].push_back(json_of(robot));
  if (summary.cycles.has_value()) json["microcontroller"] = json_of(*summary.cycles);
  return json;
}

}  // namespace

std::optional<std::string> shortfall_of(const SimulationSummary& summary) {
  if (summary.end == RunEnd::kStopped) return std::nullopt;
  if (summary.stopped_early()) {
    char after[32];
    std::snprintf(after, sizeof after, "ended after %.1f s: ", summary.time_s);
    return std::string(after) + end_text(summary.end);
  }
  const bool several = !summary.robots.empty();
  const std::vector<RobotSummary> one = {summary};
  const std::vector<RobotSummary>& robots = several ? summary.robots : one;
  for (size_t i = 0; i < robots.size(); ++i) {
    const RobotSummary& robot = robots[i];
    const std::string name = several ? "robot " + std::to_string(i) : "the robot";
    if (robot.state == state_name(RobotState::kFault) && robot.faults != Fault::kEmergencyStop)
      return name + " is stopped by a fault: " + fault_names(robot.faults);
    if (summary.ordered && !robot.ran && summary.time_s >= kStartTime_s) {
      std::string text = name + " never ran: ";
      if (robot.cannot_be_armed.empty()) text.append("it is ").append(robot.state);
      const char* between = "";
      for (const std::string& obstacle : robot.cannot_be_armed) {
        text.append(between).append(obstacle);
        between = "; ";
      }
      return text;
    }
  }
  return std::nullopt;
}

Json json_of(const TerrainChange& change) {
  return {{"moved_m3", change.moved_m3()},
          {"cut_m3", change.cut_m3},
          {"fill_m3", change.fill_m3},
          {"deepest_cut_m", change.deepest_cut_m},
          {"deepest_fill_m", change.deepest_fill_m}};
}

RobotSummary total_of(const std::vector<RobotSummary>& robots) {
  RobotSummary total = robots.front();
  if (robots.size() == 1) return total;
  std::vector<std::string> hashes;
  hashes.reserve(robots.size());
  for (const RobotSummary& robot : robots) hashes.push_back(robot.content_hash);
  total.content_hash = combined_hash(hashes);
  for (size_t i = 1; i < robots.size(); ++i) {
    const RobotSummary& robot = robots[i];
    total.left_bed = total.left_bed || robot.left_bed;
    total.distance_m += robot.distance_m;
    total.energy_j += robot.energy_j;
    total.battery_v = std::min(total.battery_v, robot.battery_v);
    total.battery_charge = std::min(total.battery_charge, robot.battery_charge);
    if (total.charge_lasts_h.has_value() && robot.charge_lasts_h.has_value())
      total.charge_lasts_h = std::min(*total.charge_lasts_h, *robot.charge_lasts_h);
    total.peaks += robot.peaks;
    if (robot.state != total.state) total.state = "several";
    total.faults = static_cast<uint16_t>(total.faults | robot.faults);
    total.cannot_be_armed.clear();
    total.telemetry_frames += robot.telemetry_frames;
    total.telemetry_frames_sent += robot.telemetry_frames_sent;
    total.telemetry_frames_damaged += robot.telemetry_frames_damaged;
    total.telemetry_share = std::max(total.telemetry_share, robot.telemetry_share);
  }
  return total;
}

std::string summary_json(const SimulationSummary& summary) {
  return json_of(summary).dump(2) + "\n";
}

Json summary_json_with_folder(const SimulationSummary& summary) {
  Json json = {{"run_folder", summary.folder.string()}};
  json.update(json_of(summary));
  return json;
}

}  // namespace screed
