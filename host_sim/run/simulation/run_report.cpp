// The summary as JSON.
#include "host_sim/run/simulation/run_report.h"

#include <nlohmann/json.hpp>

#include "host_sim/run/simulation/names.h"

namespace screed {
namespace {

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

std::string summary_json(const SimulationSummary& summary) {
  nlohmann::ordered_json json = {
      {"content_hash", summary.content_hash},
      {"stopped_early", summary.stopped_early()},
      {"left_bed", summary.left_bed},
      {"time_s", summary.time_s},
      {"distance_m", summary.distance_m},
      {"energy_j", summary.energy_j},
      {"battery_v", summary.battery_v},
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
      {"terrain_before", terrain_json(summary.before, summary.flatness_before)},
      {"terrain_after", terrain_json(summary.after, summary.flatness_after)},
  };
  if (summary.cycles.has_value()) json["microcontroller"] = json_of(*summary.cycles);
  return json.dump(2) + "\n";
}

}  // namespace screed
