// A run's bytes on another processor: with what the C library chooses on an older one, and without
// its wide vector instructions.
#include <string>

#include "host_sim/core/data_folders.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class Processor : public Program {
 protected:
  std::string content_hash(const std::string& arguments, const std::string& processor) const {
    const Result result = run("sim " + arguments + " --out run --quiet --no-pictures", processor);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::string hash =
        Json::parse(read(root_ / "run" / "summary.json"))["content_hash"].get<std::string>();
    std::filesystem::remove_all(root_ / "run");
    return hash;
  }
  void expect_no_difference(const std::string& arguments) const {
    EXPECT_EQ(content_hash(arguments, ""),
              content_hash(arguments,
                           "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F "
                           "SCREED_INSTRUCTIONS=baseline"))
        << arguments;
  }
};

TEST_F(Processor, ChangesNoDriveOnRigidGround) {
  expect_no_difference("first_drive --duration 3");
}

TEST_F(Processor, ChangesNoDriveOnSoil) {
  expect_no_difference("soft_bed --duration 0.7");
}

TEST_F(Processor, ChangesNoDriveOfSeveralRobots) {
  expect_no_difference("level_bed --duration 1 --set robots.count=4");
}

TEST_F(Processor, ChangesNoDriveOnParticles) {
  expect_no_difference("gravel_bed --duration 0.1 --set map.size=0.8");
}

TEST_F(Processor, ChangesNoDriveOfTheStandIn) {
  expect_no_difference("soft_bed --hal surrogate --duration 10");
}

TEST_F(Processor, ChangesNoDriveOfANetwork) {
  expect_no_difference("soft_bed --hal surrogate --model '" +
                       (data_folders().models / "v2.json").string() + "' --duration 5");
}

// A replay says when the world of a session was computed in another way than now.
TEST_F(Processor, IsNamedInASession) {
  ASSERT_EQ(run("sim first_drive --duration 0.2 --out run --quiet --no-pictures").exit_code, 0);
  EXPECT_EQ(run("replay run").err, "");
  const std::filesystem::path session = root_ / "run" / "session.h5";
  {
    const h5::Handle file(H5Fopen(session.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "opens");
    EXPECT_EQ(h5::read_string(file.get(), "arithmetic"), "portable 1");
    ASSERT_GE(H5Adelete(file.get(), "arithmetic"), 0);
  }
  const Result result = run("replay run");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("arithmetic 'the C library's', not this program's 'portable 1'"),
            std::string::npos)
      << result.err;
}

TEST_F(Processor, ThatIsNoneIsRefused) {
  expect_refused(run("sim soft_bed --out run", "SCREED_INSTRUCTIONS=SSE9"), 2,
                 {"SCREED_INSTRUCTIONS", "SSE9", "baseline, AVX2, AVX-512"});
}

}  // namespace
}  // namespace screed::testing
