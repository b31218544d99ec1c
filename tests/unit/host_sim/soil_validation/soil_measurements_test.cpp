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

}  // namespace
}  // namespace screed
