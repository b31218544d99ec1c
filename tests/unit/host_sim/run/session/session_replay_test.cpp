// A recorded run replays to the byte, and the command says what differs.
#include <algorithm>

#include "commands.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/json.h"
#include "host_sim/run/session/replay.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"
#include "tools/command_line/program.h"

namespace screed {
namespace {

/// A run of the real core over made-up samples that move, with something on the radio now and then.
Recording robot_run(std::size_t ticks) {
  Recording run = random_run(ticks);
  run.info.parameters = Parameters{};
  run.info.parameters.standalone() = 1;
  Robot robot(run.info.board, run.info.parameters, run.info.credentials);
  RobotOutput output{};
  for (std::size_t i = 0; i < ticks; ++i) {
    SensorSample& sample = run.samples[i];
    sample.time_us = static_cast<std::uint32_t>(i * kTickPeriod_us);
    for (int axis = 0; axis < 3; ++axis) {
      sample.imu.gyro()[axis] = static_cast<std::int16_t>(sample.imu.gyro()[axis] / 256);
      sample.imu.accel()[axis] =
          static_cast<std::int16_t>(sample.imu.accel()[axis] / 256 + (axis == 2 ? 4096 : 0));
    }
    sample.encoder_left = static_cast<std::uint16_t>(i * 3);
    sample.encoder_right = static_cast<std::uint16_t>(i * 2);
    sample.battery = 4000;
    robot.tick(sample, output);
    run.outputs[i] = output;
  }
  return run;
}

TEST_F(SessionTest, ARecordedRunReplaysToTheByte) {
  const Recording run = robot_run(1500);
  ASSERT_TRUE(std::any_of(run.outputs.begin(), run.outputs.end(),
                          [](const RobotOutput& output) { return output.radio_out_count > 0; }));
  write_run(file_, run);
  const ReplayResult result = replay_session(file_);
  EXPECT_EQ(result.ticks, 1500U);
  EXPECT_FALSE(result.first_difference_tick) << result.first_difference;
  EXPECT_TRUE(result.complete);
  EXPECT_TRUE(result.unchanged);
  ContentHash hash;
  for (const RobotOutput& output : run.outputs) hash.add_bytes(packed<kOutputBytes>(output));
  EXPECT_EQ(result.output_hash, hash.hex());
}

TEST_F(SessionTest, ReplayFindsTheFirstChangedByte) {
  Recording run = robot_run(1500);
  const auto report = std::find_if(run.outputs.begin() + 1100, run.outputs.end(),
                                   [](const RobotOutput& o) { return o.radio_out_count > 0; });
  ASSERT_NE(report, run.outputs.end());
  const int last = report->radio_out_count - 1;
  const int value = report->radio_out[last];
  report->radio_out[last] ^= 1;
  run.outputs.back().duty_right ^= 1;
  write_run(file_, run);
  const ReplayResult result = replay_session(file_);
  EXPECT_EQ(result.ticks, 1500U);
  EXPECT_EQ(result.first_difference_tick, static_cast<std::uint64_t>(report - run.outputs.begin()));
  EXPECT_EQ(result.first_difference, "radio_out[" + std::to_string(last) + "]: expected " +
                                         std::to_string(value ^ 1) + ", got " +
                                         std::to_string(value));
}

TEST_F(SessionTest, ReplayIgnoresRadioBytesThatAreNotValid) {
  Recording run = robot_run(50);
  for (RobotOutput& output : run.outputs) {
    for (int i = output.radio_out_count; i < kRadioOutCapacity; ++i) output.radio_out[i] = 0xEE;
  }
  write_run(file_, run);
  EXPECT_FALSE(replay_session(file_).first_difference_tick);
}

TEST_F(SessionTest, ReplayRefusesWhatItCannotReplay) {
  write_run(file_, random_run(0));
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_, "no tick");
  fs::remove(file_);
  Recording run = robot_run(3);
  run.info.tick_rate_hz = 50;
  write_run(file_, run);
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_, "50 ticks per second");
  fs::remove(file_);
  run = robot_run(3);
  run.info.board.motor_nominal_mv = 0;
  write_run(file_, run);
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_,
              "'motor_nominal_mv' is 0");
}

struct CommandResult {
  int status = -1;
  std::string out;
  std::string err;
};

CommandResult replay_command(const std::vector<std::string>& arguments) {
  Command app;
  Program program;
  register_replay_command(app, program);
  std::vector<std::string> words = {"replay"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  parse(app, words);
  CommandResult result;
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  try {
    result.status = program.action();
  } catch (const InputError&) {
    result.status = 2;
  }
  result.out = ::testing::internal::GetCapturedStdout();
  result.err = ::testing::internal::GetCapturedStderr();
  return result;
}

TEST_F(SessionTest, TheReplayCommandTellsTheResult) {
  Recording run = robot_run(40);
  write_run(file_, run);
  for (const fs::path& name : {base_, file_}) {  // run folder and file
    const CommandResult result = replay_command({name.string()});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, "40 ticks replayed, outputs identical\n");
    EXPECT_EQ(result.err, "");
  }
  const std::string hash = replay_session(file_).output_hash;
  EXPECT_EQ(replay_command({file_.string(), "--json"}).out,
            "{\"run\":\"" + file_.string() +
                "\",\"ticks\":40,\"identical\":true,\"first_difference_tick\":null,"
                "\"first_difference\":null,\"output_hash\":\"" +
                hash + "\",\"complete\":true,\"unchanged\":true}\n");

  const int leds = run.outputs[7].leds;
  run.outputs[7].leds ^= 1;
  fs::remove(file_);
  write_run(file_, run);
  const std::string difference =
      "leds: expected " + std::to_string(leds ^ 1) + ", got " + std::to_string(leds);
  CommandResult result = replay_command({file_.string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "40 ticks replayed, first difference at tick 7: " + difference + "\n");
  result = replay_command({"--json", file_.string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("\"identical\":false,\"first_difference_tick\":7,"
                            "\"first_difference\":\"" +
                            difference + "\""),
            std::string::npos)
      << result.out;
}

TEST_F(SessionTest, TheReplayCommandNotesEditedAndUnfinishedRuns) {
  const Recording run = robot_run(SessionWriter::kBlockRows);
  {
    SessionWriter writer(file_, run.info);
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    }
  }
  EXPECT_NE(replay_command({file_.string()}).err.find("did not end"), std::string::npos);
  fs::remove(file_);
  write_run(file_, run);
  edit([](hid_t file) { h5::write_attribute(file, "seed", std::uint64_t{1}); });
  EXPECT_NE(replay_command({file_.string()}).err.find("content"), std::string::npos);
}

TEST_F(SessionTest, TheReplayCommandRefusesWrongInput) {
  EXPECT_EQ(replay_command({(base_ / "missing").string()}).status, 2);
  EXPECT_EQ(replay_command({base_.string()}).status, 2);  // a folder without a session
  EXPECT_EQ(message_of<UsageError>([] { replay_command({}); }), "RUN is required");
}

TEST_F(SessionTest, WhatIfComparesTheOutputsOfOtherParameters) {
  const Recording run = robot_run(1500);
  write_run(file_, run);
  const std::string same =
      "parameters.gyro_offset_x=" + std::to_string(run.info.parameters.gyro_offset_x());
  CommandResult result = replay_command({file_.string(), "--set", same});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out.find("1500 ticks replayed, outputs identical\nopen loop"), 0U) << result.out;

  // Another zero of the gyroscope is another attitude, which goes down by radio; no motor runs.
  const std::string other = "parameters.gyro_offset_x=300";
  const fs::path picture = base_ / "what_if.svg";
  result = replay_command({file_.string(), "--set", other, "--picture", picture.string()});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.out.find("first difference at tick "), std::string::npos);
  EXPECT_NE(result.out.find("\n  radio_out "), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("\n  duty_left "), std::string::npos) << result.out;
  EXPECT_NE(read_text(picture).find("what if"), std::string::npos);

  const Json json = Json::parse(replay_command({file_.string(), "--set", other, "--json"}).out);
  EXPECT_EQ(json["open_loop"], true);
  ASSERT_EQ(json["changes"].size(), 1U);
  EXPECT_EQ(json["changes"][0]["column"], "radio_out");
  EXPECT_EQ(json["changes"][0]["first_tick"], json["first_difference_tick"]);
  EXPECT_GT(json["changes"][0]["ticks"].get<int>(), 10);
  EXPECT_TRUE(json["changes"][0]["largest"].is_null());
}

TEST_F(SessionTest, WhatIfTakesAnotherAlgorithm) {
  write_run(file_, robot_run(300));
  const CommandResult result =
      replay_command({file_.string(), "--set", "experiment.algorithm=random_walk"});
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.out.find("open loop"), std::string::npos);
  EXPECT_EQ(replay_command({file_.string(), "--set", "experiment.algorithm=random_walk",
                            "--picture", (base_ / "a.jpg").string()})
                .status,
            2);
}

TEST_F(SessionTest, WhatIfRefusesWhatARecordedDriveCannotChange) {
  write_run(file_, robot_run(3));
  for (const char* set : {"map.size=3", "parameters.gyro_offset_x=40000", "parameters.no_such=1",
                          "experiment.algorithm=nothing", "experiment.algorithm=training_drive"}) {
    EXPECT_EQ(replay_command({file_.string(), "--set", set}).status, 2) << set;
  }
  EXPECT_EQ(replay_command({file_.string(), "--set", "parameters.walk_speed_min=200", "--set",
                            "parameters.walk_speed_max=100"})
                .status,
            2);
}

}  // namespace
}  // namespace screed
