// Storing a calibration: all values or none where that can be known before, and a message that says
// what is stored where not.
#include "tools/screed/link/calibrate_command.h"

#include <gtest/gtest.h>

#include <sstream>

#include "host_sim/core/errors.h"
#include "host_sim/core/task_progress.h"
#include "tools/screed/link/named_parameters.h"

namespace screed {
namespace {

constexpr std::size_t kValues = 9;

ImuCalibration some_calibration() {
  ImuCalibration calibration;
  calibration.gyro.bias = {1.0, 2.0, 3.0};
  calibration.accelerometer.correction.offset = {4.0, 5.0, 6.0};
  calibration.magnetometer.correction.offset = {7.0, 8.0, 9.0};
  return calibration;
}

class StoreCalibration : public ::testing::Test {
 protected:
  /// Stores; the message of what ended it, with "stopped: " before that of TaskStopped.
  std::string store(const ImuCalibration& calibration) {
    try {
      store_calibration(calibration, robot_, out_);
    } catch (const RunError& error) {
      return error.what();
    } catch (const TaskStopped& stopped) {
      return std::string("stopped: ") + stopped.what();
    }
    return "";
  }

  std::vector<int32_t> stored_;
  std::function<void()> at_third_;  ///< in place of the wait before the third value
  std::ostringstream out_;
  ParameterWriter robot_{[this] {
                           if (at_third_ && stored_.size() == 2) at_third_();
                         },
                         [this](uint16_t, int32_t value) {
                           stored_.push_back(value);
                           return std::optional<CommandAnswer>(CommandAnswer{});
                         },
                         [](const CommandAnswer& answer) -> std::string {
                           return answer.done() ? "done" : "refused";
                         }};
};

constexpr char kTwoStored[] =
    "; stored: gyro_offset_x, gyro_offset_y; not stored: the other 7; calibrate again";

TEST_F(StoreCalibration, StoresAllAndSaysEach) {
  EXPECT_EQ(store(some_calibration()), "");
  EXPECT_EQ(stored_, (std::vector<int32_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(out_.str().rfind("gyro_offset_x = 0.07 deg/s: done\n", 0), 0U) << out_.str();
}

TEST_F(StoreCalibration, AValueOutOfItsRangeIsFoundBeforeTheFirstIsStored) {
  ImuCalibration calibration = some_calibration();
  calibration.magnetometer.correction.offset.z() = 30000.0;
  const std::string said = store(calibration);
  EXPECT_EQ(said.rfind("mag_offset_z = '", 0), 0U) << said;
  EXPECT_NE(said.find("; nothing was changed"), std::string::npos) << said;
  EXPECT_TRUE(stored_.empty());
  EXPECT_EQ(out_.str(), "");
}

TEST_F(StoreCalibration, SaysWhatIsStoredWhenTheRobotIsNotReadyAnyMore) {
  at_third_ = [] { throw RunError("the robot is not disarmed but 'armed'"); };
  EXPECT_EQ(store(some_calibration()),
            std::string("the robot is not disarmed but 'armed'") + kTwoStored);
  robot_.wait_until_ready = at_third_;
  stored_.clear();
  EXPECT_EQ(store(some_calibration()),
            "the robot is not disarmed but 'armed'; nothing was changed");
}

TEST_F(StoreCalibration, SaysWhatIsStoredWhenItIsStopped) {
  at_third_ = [] { throw TaskStopped("waiting"); };
  EXPECT_EQ(store(some_calibration()), std::string("stopped: waiting") + kTwoStored);
}

TEST_F(StoreCalibration, SaysWhatIsStoredWhenTheRobotRefusesOrIsSilent) {
  const auto write = robot_.write;
  for (const std::optional<CommandAnswer>& answer :
       {std::optional<CommandAnswer>(CommandAnswer{0, 1, 0}), std::optional<CommandAnswer>()}) {
    stored_.clear();
    out_.str("");
    robot_.write = [&](uint16_t index, int32_t value) {
      return stored_.size() == 2 ? answer : write(index, value);
    };
    EXPECT_EQ(store(some_calibration()), std::string("gyro_offset_z was not stored") + kTwoStored);
    EXPECT_NE(out_.str().find(answer.has_value() ? "gyro_offset_z = 0.21 deg/s: refused\n"
                                                 : "gyro_offset_z = 0.21 deg/s: no answer\n"),
              std::string::npos)
        << out_.str();
  }
  EXPECT_LT(stored_.size(), kValues);
}

}  // namespace
}  // namespace screed
