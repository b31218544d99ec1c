// Tables of measurements: what is read, and what is said about a table that is wrong.
#include "host_sim/soil_validation/soil_measurements.h"

#include <gtest/gtest.h>

#include <fstream>

#include "host_sim/core/errors.h"
#include "paths.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

TEST(SoilMeasurementsTest, SayWhatIsWrongAndWhere) {
  const TempFolder folder;
  const std::string file = (folder.path() / "rows.csv").string();
  const auto message = [&](const std::string& text) {
    std::ofstream(file) << text;
    try {
      read_soil_measurements(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const std::string head = "case,wheel_radius_m,wheel_width_m,load_n,slip,sinkage_m\n";
  EXPECT_EQ(message(head + "a,0.1,0.05,20,0.2,0.01\n"), "none");
  EXPECT_EQ(message(head + "a,0.1,0.05,20,1.2,0.01\n"),
            file + ":2: slip is '1.2', a number from -1 to 0.99 is needed");
  EXPECT_EQ(message(head + "a,0.1,0.05,20,0.2,0.01\nb,0.1,0.05,much,0,\n"),
            file + ":3: load_n is 'much', a number from 0.001 to 1e+06 is needed");
  EXPECT_EQ(message(head + "a,0.1,0.05\n"), file + ":2: no load_n");
  EXPECT_EQ(message(head), file + ": no case begins with ''");
  EXPECT_EQ(message("a,b\n1,2\n"),
            file + ":1: neither a column wheel_radius_m (wheels) nor plate_width_m (plates)");
  EXPECT_EQ(message(""), file + ": cannot be read");
  EXPECT_EQ(read_soil_measurements(std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv",
                                   "ding2011_lug10")
                .wheels.size(),
            6U);
}

TEST(SoilMeasurementsTest, ErrorsAreColumnsThatMayBeThere) {
  const TempFolder folder;
  const std::string file = (folder.path() / "rows.csv").string();
  std::ofstream(file) << "case,wheel_radius_m,wheel_width_m,load_n,slip,drawbar_pull_n,"
                         "drawbar_pull_error_n,side_force_n,side_force_error_n,sinkage_m,"
                         "sinkage_error_m\n"
                         "a,0.1,0.05,20,0.2,3,0.5,2,0.25,0.01,0.001\n"
                         "b,0.1,0.05,20,0.2,3,,2,,0.01,\n";
  const std::vector<MeasuredWheel> wheels = read_soil_measurements(file).wheels;
  ASSERT_EQ(wheels.size(), 2U);
  EXPECT_EQ(wheels[0].drawbar_pull_error_n, 0.5);
  EXPECT_EQ(wheels[0].side_force_error_n, 0.25);
  EXPECT_EQ(wheels[0].sinkage_error_m, 0.001);
  EXPECT_EQ(wheels[1].drawbar_pull_error_n, std::nullopt);
  EXPECT_EQ(wheels[1].side_force_error_n, std::nullopt);
  EXPECT_EQ(wheels[1].sinkage_error_m, std::nullopt);
  // As readable as the figure that was digitised.
  const std::string ding = std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv";
  for (const MeasuredWheel& wheel : read_soil_measurements(ding).wheels) {
    EXPECT_EQ(wheel.drawbar_pull_error_n, 0.5) << wheel.name;
    EXPECT_EQ(wheel.sinkage_error_m, 0.0005) << wheel.name;
  }
  std::ofstream(file) << "case,wheel_radius_m,wheel_width_m,load_n,slip,sinkage_error_m\n"
                         "a,0.1,0.05,20,0.2,-0.001\n";
  EXPECT_THROW(read_soil_measurements(file), InputError);
}

}  // namespace
}  // namespace screed
