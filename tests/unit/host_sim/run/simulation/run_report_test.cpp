// summary.json, key by key.
#include "host_sim/run/simulation/run_report.h"

#include <gtest/gtest.h>

#include "host_sim/core/json.h"

namespace screed {
namespace {

/// Every number another one, so that none can stand in another's place.
SimulationSummary summary() {
  SimulationSummary s;
  s.identity = {"hill", "spin_on_peak", 7, "native", "a_star_32u4", "scm", "viper", "1.2.3"};
  s.folder = "out/hill-0001";
  s.content_hash = "0123456789abcdef";
  s.end = RunEnd::kLeftBed;
  s.left_bed = true;
  s.training_frames = 11;
  s.height_changes = 12;
  s.time_s = 13.5;
  s.wall_s = 14.5;
  s.distance_m = 15.5;
  s.energy_j = 16.5;
  s.battery_v = 18.5;
  s.battery_charge = 0.875;
  s.charge_lasts_h = 10.5;
  s.peaks = 19;
  s.state = "fault";
  s.faults = 0x0081;
  s.cannot_be_armed = {"one reason", "another"};
  s.telemetry_frames = 20;
  s.telemetry_frames_sent = 21;
  s.telemetry_frames_damaged = 22;
  s.telemetry_share = 0.25;
  s.terrain.before.heights.lowest_m = 31.5;
  s.terrain.before.heights.highest_m = 32.5;
  s.terrain.before.heights.mean_height_m = 33.5;
  s.terrain.before.heights.height_deviation_m = 34.5;
  s.terrain.before.heights.mean_slope_deg = 35.5;
  s.terrain.before.heights.rms_slope_deg = 36.5;
  s.terrain.before.heights.p95_slope_deg = 37.5;
  s.terrain.before.heights.steepest_slope_deg = 38.5;
  s.terrain.before.flatness = 0.5;
  s.terrain.before.robot_scale = {29.5, 39.5, 40.5, 0.625};
  s.terrain.after = s.terrain.before;
  s.terrain.after.heights.mean_slope_deg = 45.5;
  s.terrain.after.flatness = 0.75;
  s.terrain.change = {46.5, 47.5, 48.5, 49.5};
  s.leveling.before.transport = 61.5;
  s.leveling.before.transport_error = 2.5;
  s.leveling.before.transport_squared = 64.0;
  s.leveling.after.transport = 63.5;
  s.leveling.after.transport_error = 1.5;
  s.leveling.after.transport_squared = 16.0;
  s.leveling.after.progress = 0.375;
  s.leveling.after.transport_per_joule = 65.5;
  s.leveling.after.slip = 0.125;
  s.leveling.after.stuck = 0.0625;
  s.leveling.after.tilted = 0.03125;
  s.leveling.after.off_site = 0.015625;
  s.leveling.after.returning = 0.0078125;
  s.leveling.after.visited = 0.75;
  return s;
}

TEST(Summary, OnlyARunThatIsDoneWasNotStoppedEarly) {
  SimulationSummary s;
  for (const RunEnd end : {RunEnd::kDone, RunEnd::kFault, RunEnd::kLeftBed, RunEnd::kStopped}) {
    s.end = end;
    EXPECT_EQ(Json::parse(summary_json(s))["stopped_early"], end != RunEnd::kDone);
  }
}

/// Of a run of 60 s in which the robot ran.
SimulationSummary good_run() {
  SimulationSummary s;
  s.time_s = 60.0;
  s.ran = true;
  s.state = "running";
  return s;
}

TEST(Shortfall, IsWhatTheExperimentOrdersAndTheRobotDidNot) {
  EXPECT_EQ(shortfall_of(good_run()), std::nullopt);
  SimulationSummary s = good_run();
  s.end = RunEnd::kLeftBed;
  EXPECT_EQ(shortfall_of(s), "ended after 60.0 s: the robot left the bed");
  s = good_run();
  s.state = "fault";
  s.faults = Fault::kTilt | Fault::kStuck;
  EXPECT_EQ(shortfall_of(s), "the robot is stopped by a fault: tilt, stuck");
  s = good_run();
  s.ran = false;
  s.state = "disarmed";
  EXPECT_EQ(shortfall_of(s), "the robot never ran: it is disarmed");
  s.cannot_be_armed = {"this", "that"};
  EXPECT_EQ(shortfall_of(s), "the robot never ran: this; that");
}

TEST(Shortfall, IsNoneWhereNobodyOrderedOrSomebodyStoppedIt) {
  SimulationSummary s = good_run();
  s.ran = false;
  s.time_s = 9.9;
  EXPECT_EQ(shortfall_of(s), std::nullopt) << "it had no time to";
  s.time_s = 60.0;
  s.ordered = false;
  EXPECT_EQ(shortfall_of(s), std::nullopt);
  s = good_run();
  s.ran = false;
  s.end = RunEnd::kStopped;
  EXPECT_EQ(shortfall_of(s), std::nullopt);
  s = good_run();
  s.state = "fault";
  s.faults = Fault::kEmergencyStop;
  EXPECT_EQ(shortfall_of(s), std::nullopt);
}

TEST(Shortfall, NamesTheRobotOfSeveral) {
  SimulationSummary s = good_run();
  s.robots = {good_run(), good_run()};
  EXPECT_EQ(shortfall_of(s), std::nullopt);
  s.robots[1].ran = false;
  s.robots[1].state = "ready";
  EXPECT_EQ(shortfall_of(s), "robot 1 never ran: it is ready");
}

TEST(RunReport, SaysWhatIsPartOfTheResultInAFixedOrder) {
  const std::string terrain =
      R"("lowest_m": 31.5, "highest_m": 32.5, "mean_height_m": 33.5, "height_deviation_m": 34.5,)";
  const std::string slopes =
      R"("rms_slope_deg": 36.5, "p95_slope_deg": 37.5, "steepest_slope_deg": 38.5,)";
  const std::string robot_scale =
      R"("level_deviation_m": 29.5, "relief_m": 39.5, "roughness_m": 40.5, "robot_scale_flatness": 0.625})";
  const Json expected =
      Json::parse(R"({"name": "hill", "algorithm": "spin_on_peak", "seed": 7,
      "world": {"hal": "native", "board": "a_star_32u4", "terrain": "scm", "soil": "viper"},
      "version": "1.2.3", "content_hash": "0123456789abcdef", "stopped_early": true,
      "left_bed": true, "time_s": 13.5, "distance_m": 15.5, "energy_j": 16.5,
      "battery_v": 18.5, "battery_charge": 0.875, "charge_lasts_h": 10.5, "peaks": 19, "training_frames": 11,
      "height_changes": 12, "state": "fault", "faults": "tilt, emergency_stop",
      "cannot_be_armed": ["one reason", "another"],
      "telemetry_frames": 20, "telemetry_frames_sent": 21, "telemetry_frames_damaged": 22,
      "telemetry_share": 0.25,
      "terrain_before": {)" +
                  terrain + R"("mean_slope_deg": 35.5,)" + slopes + R"("flatness": 0.5,)" +
                  robot_scale + R"(, "terrain_after": {)" + terrain + R"("mean_slope_deg": 45.5,)" +
                  slopes + R"("flatness": 0.75,)" + robot_scale +
                  R"(, "terrain_change": {"moved_m3": 46.5, "cut_m3": 46.5, "fill_m3": 47.5,
                  "deepest_cut_m": 48.5, "deepest_fill_m": 49.5},
                  "leveling": {"progress": 0.375, "progress_w2": 0.5, "transport_before_m4": 61.5,
                  "transport_after_m4": 63.5, "transport_error_m4": 2.5,
                  "squared_transport_before_m5": 64.0, "squared_transport_after_m5": 16.0,
                  "transport_per_joule_m4": 65.5, "slip": 0.125, "stuck": 0.0625,
                  "tilted": 0.03125, "off_site": 0.015625,
                  "returning": 0.0078125, "visited": 0.75}})");
  EXPECT_EQ(summary_json(summary()), expected.dump(2) + "\n");
}

TEST(RunReport, WhatWasNotMeasuredIsNull) {
  SimulationSummary s = summary();
  s.leveling = {};
  const Json leveling = Json::parse(summary_json(s)).at("leveling");
  EXPECT_TRUE(leveling.at("progress").is_null());
  EXPECT_TRUE(leveling.at("transport_error_m4").is_null());
}

TEST(RunReport, TerrainThatIsNoSoilNamesNone) {
  SimulationSummary s = summary();
  s.identity.soil.reset();
  EXPECT_TRUE(Json::parse(summary_json(s)).at("world").at("soil").is_null());
}

TEST(RunReport, NamesTheFolderOnlyToWhomStartedTheRun) {
  Json with_folder = summary_json_with_folder(summary());
  EXPECT_EQ(with_folder.items().front().name, "run_folder");
  EXPECT_EQ(with_folder["run_folder"], "out/hill-0001");
  with_folder.erase("run_folder");
  EXPECT_EQ(with_folder.dump(2) + "\n", summary_json(summary()));
}

TEST(RunReport, ARunWithAnImageSaysWhatTheMicrocontrollersTimeWentInto) {
  SimulationSummary s = summary();
  CycleReport cycles;
  cycles.ticks = 51;
  cycles.longest_tick_cycles = 52;
  cycles.mean_tick_cycles = 53.5;
  cycles.missed_ticks = 54;
  cycles.load = 0.125;
  cycles.encoder_latency_cycles = 55;
  cycles.encoder_edges = 56;
  cycles.encoder_missing = -57;
  cycles.uart_received = 58;
  cycles.uart_overruns = 59;
  cycles.uart_sent = 60;
  cycles.resets = 61;
  cycles.interrupts = {{"timer", 62, 63, 64.5}};
  s.cycles = cycles;
  const Json expected = Json::parse(R"({"ticks": 51, "longest_tick_cycles": 52,
      "mean_tick_cycles": 53.5, "missed_ticks": 54, "load": 0.125, "encoder_latency_cycles": 55,
      "encoder_edges": 56, "encoder_edges_missed": -57, "uart_bytes_received": 58,
      "uart_bytes_lost": 59, "uart_bytes_sent": 60, "resets": 61,
      "interrupts": {"timer": {"count": 62, "longest_cycles": 63, "mean_cycles": 64.5}}})");
  EXPECT_EQ(Json::parse(summary_json(s)).at("microcontroller").dump(), expected.dump());
}

}  // namespace
}  // namespace screed
