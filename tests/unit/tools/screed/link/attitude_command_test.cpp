// `screed attitude`: figures on a real recording, and one clear line for every wrong file.
#include "tools/screed/link/attitude_command.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "commands.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "tools/command_line/program.h"

namespace screed {
namespace {

const std::string kExcerpt = "tests/data/imu_broad_excerpt.csv";
const std::string kHeader = "t_ms,gx,gy,gz,ax,ay,az,mx,my,mz,qw,qx,qy,qz,moving\n";
const std::string kRow = "0,0,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n";

/// The file of the running test; gone after it.
std::string own_file() {
  return ::testing::TempDir() + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
         ".csv";
}

std::string write(const std::string& text) {
  std::ofstream(own_file()) << text;
  return own_file();
}

class AttitudeCommand : public ::testing::Test {
 protected:
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove(own_file(), ignored);
  }
};

/// The message of the InputError that this content ends in, or nothing.
std::string error_of(const std::string& text) {
  try {
    score_attitude(write(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST_F(AttitudeCommand, RealRecordingWithinBounds) {
  const AttitudeScore score = score_attitude(kExcerpt);
  EXPECT_EQ(score.samples, 2771);  // rows with moving = 1 and a reference, counted with awk
  EXPECT_LT(score.rms_inclination_deg, 0.9);
  EXPECT_LT(score.rms_heading_deg, 1.5);
}

TEST_F(AttitudeCommand, ErrorsAreMeasuredAsDefined) {
  // The estimate is exact (level, nose to east), so the errors are those of the reference: 3
  // degrees of inclination about x, in the second row 5 degrees about the vertical. 1.5 and 2.5
  // degrees are the half angles.
  const std::string tilted = "0,0,0,0,0,0,4098,0,1000,0,0.99965732,0.02617695,0,0,1\n";
  const std::string turned = "10,0,0,0,0,0,4098,0,1000,0,0.99904822,0,0,-0.04361939,1\n";
  const std::string uncounted =
      "20,0,0,0,0,0,4098,0,1000,0,0,1,0,0,0\n30,0,0,0,0,0,4098,0,1000,0,,,,,1\n";
  const AttitudeScore score = score_attitude(write(kHeader + tilted + turned + uncounted));
  EXPECT_EQ(score.samples, 2);
  EXPECT_NEAR(score.rms_inclination_deg, 3.0 / std::sqrt(2.0), 0.002);
  EXPECT_NEAR(score.rms_heading_deg, 5.0 / std::sqrt(2.0), 0.01);
}

TEST_F(AttitudeCommand, ColumnsAreFoundByName) {
  const std::string shuffled =
      "# a comment\n# another\nmoving,az,gx,gy,gz,ax,ay,my,mx,mz,extra,qz,qw,qx,qy\r\n"
      "1,4098,0,0,0,0,0,1000,0,0,x,0,1,0,0\r\n";
  EXPECT_NEAR(score_attitude(write(shuffled)).rms_inclination_deg, 0.0, 0.01);
}

TEST_F(AttitudeCommand, TakesWhatSpreadsheetsAndPandasWrite) {
  const std::string marked = "\xEF\xBB\xBF" + kHeader;
  EXPECT_EQ(score_attitude(write(marked + kRow)).samples, 1);
  // The mark hides no column: the gap in t_ms is seen.
  EXPECT_NE(error_of(marked + kRow + "90,0,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n").find("t_ms goes"),
            std::string::npos);
  const std::string blanks =
      "gx, gy, gz, ax, ay, az, mx, my, mz, qw, qx, qy, qz, moving\n"
      "0.0, -0.4, 0.4, 0.0, 0.0, 4098.0, 0.0, 999.6, 0.0, 1.0, 0.0, 0.0, 0.0, 1\n";
  EXPECT_NEAR(score_attitude(write(blanks)).rms_inclination_deg, 0.0, 1e-9);
}

TEST_F(AttitudeCommand, UnitsOfRosGiveWhatCountsGive) {
  // The excerpt in rad/s, m/s2 and microtesla, by its own arithmetic.
  std::ifstream in(kExcerpt);
  std::ostringstream si;
  si.precision(12);
  std::vector<std::string> names;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream cells(line);
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (column > 0) si << ',';
      const bool is_head = !std::isdigit(static_cast<unsigned char>(line[0]));
      if (is_head) names.push_back(cell);
      const std::string& name = names[column];
      const bool is_axis = name.size() == 2 && name[1] >= 'x' && name[1] <= 'z' && name[0] != 'q';
      const double size = name[0] == 'g'   ? 0.07 * 3.14159265358979 / 180.0
                          : name[0] == 'a' ? 0.244e-3 * 9.80665
                                           : 16e-3;
      if (is_head || !is_axis) {
        si << cell;
      } else {
        si << std::stod(cell) * size;
      }
    }
    if (line.ends_with(',')) si << ',';
    si << '\n';
  }
  const AttitudeScore counts = score_attitude(kExcerpt);
  const AttitudeScore same = score_attitude(write(si.str()), true);
  EXPECT_EQ(same.samples, counts.samples);
  // The counts of the field are others by a factor, and so their rounding.
  EXPECT_NEAR(same.rms_inclination_deg, counts.rms_inclination_deg, 1e-3);
  EXPECT_NEAR(same.rms_heading_deg, counts.rms_heading_deg, 0.05);
  EXPECT_NE(error_of(si.str()).find("--units si"), std::string::npos);
}

TEST_F(AttitudeCommand, TableHasFilesAndMean) {
  std::ostringstream out;
  EXPECT_EQ(run_attitude({kExcerpt, kExcerpt}, false, false, out), 0);
  const std::string table = out.str();
  EXPECT_NE(table.find(kExcerpt), std::string::npos);
  EXPECT_NE(table.find("\nmean"), std::string::npos);
}

TEST_F(AttitudeCommand, JsonMeanIsTheMeanOverFiles) {
  const std::string other = write(kHeader + kRow);
  std::ostringstream out;
  EXPECT_EQ(run_attitude({kExcerpt, other}, false, true, out), 0);
  const Json result = Json::parse(out.str());
  ASSERT_EQ(result["files"].size(), 2U);
  EXPECT_EQ(result["files"][0]["file"], kExcerpt);
  EXPECT_EQ(result["files"][1]["samples"], 1);
  const double mean = (result["files"][0]["rms_inclination_deg"].get<double>() +
                       result["files"][1]["rms_inclination_deg"].get<double>()) /
                      2;
  EXPECT_DOUBLE_EQ(result["mean"]["rms_inclination_deg"].get<double>(), mean);
}

TEST_F(AttitudeCommand, CallbackSetsTheAction) {
  Command root;
  Program program;
  register_attitude_command(root, program);
  parse(root, {"attitude", "--json", kExcerpt});
  ASSERT_TRUE(program.action);
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(program.action(), 0);
  EXPECT_NO_THROW(Json::parse(::testing::internal::GetCapturedStdout()));

  Command without_files;
  register_attitude_command(without_files, program);
  try {
    parse(without_files, {"attitude"});
    FAIL() << "no file is named";
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "FILES is required");
  }
}

TEST_F(AttitudeCommand, MissingFile) {
  EXPECT_THROW(score_attitude("tests/data/no_such_recording.csv"), InputError);
  EXPECT_THROW(score_attitude("tests/data"), InputError);
}

TEST_F(AttitudeCommand, WrongContentIsNamedWithItsLine) {
  struct Case {
    std::string text;
    std::string line;
    std::string what;
  };
  const std::string good = kHeader + kRow;
  const Case cases[] = {
      {"", ".csv: ", "column names"},
      {"# only a comment\n", ".csv: ", "column names"},
      {"t_ms,gx,gy\n" + kRow, ":1: ", "column gz is missing"},
      {"gx," + kHeader + kRow, ":1: ", "column gx is there twice"},
      {good + "10,0,0,0,0,0,4098,0,1000,0,1,0,0,0\n", ":3: ", "has 14 fields"},
      {good + "x\n", ":3: ", "has 1 fields"},
      {good + "10,x,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n", ":3: ", "gx is 'x'"},
      {good + "10,,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n", ":3: ", "gx is ''"},
      {good + "10,1.5e,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n", ":3: ", "gx is '1.5e'"},
      {good + "10,nan,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n", ":3: ", "gx is nan"},
      {kHeader + "0,0.0049,0,0,0.09,0,9.81,0,155,0,1,0,0,0,1\n", ".csv: ", "--units si"},
      {good + "10,0,0,0,0,0,32768,0,1000,0,1,0,0,0,1\n", ":3: ", "az is 32768"},
      {good + "10,0,0,0,0,-32769,0,0,1000,0,1,0,0,0,1\n", ":3: ", "ay is -32769"},
      {good + "10,0,0,0,0,0,99999999999999999999,0,1000,0,1,0,0,0,1\n", ":3: ", "az is 9999"},
      {good + "10,0,0,0,0,0,4098,0,1000,0,1,,0,0,1\n", ":3: ", "qx is ''"},
      {good + "10,0,0,0,0,0,4098,0,1000,0,nan,0,0,0,1\n", ":3: ", "length"},
      {good + "10,0,0,0,0,0,4098,0,1000,0,0.5,0,0,0,1\n", ":3: ", "length"},
      {good + "10,0,0,0,0,0,4098,0,1000,0,1,0,0,0,2\n", ":3: ", "moving is '2'"},
      {good + "15,0,0,0,0,0,4098,0,1000,0,1,0,0,0,1\n", ":3: ", "steps of 10"},
      {kHeader + "0,0,0,0,0,0,4098,0,1000,0,1,0,0,0,0\n", ".csv: ", "no row counts"},
      {kHeader + "0,0,0,0,0,0,4098,0,1000,0,,,,,1\n", ".csv: ", "no row counts"},
  };
  for (const Case& c : cases) {
    const std::string message = error_of(c.text);
    EXPECT_NE(message.find(c.line), std::string::npos) << c.text << "-> " << message;
    EXPECT_NE(message.find(c.what), std::string::npos) << c.text << "-> " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace screed
