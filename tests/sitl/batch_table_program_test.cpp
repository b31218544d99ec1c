// Batches from a table, as a user meets them: `screed record FILE --table CSV` and what it leaves
// out when it is run again.

#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class BatchTable : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("level.ini", "[map]\nsize = 4\n[experiment]\nframes = 8\n");
    write("level.csv",
          "# of all kinds\nexperiment.name,vehicle.h,experiment.seed + parameters.random_seed\n"
          "a_1,30,5\na_2,,6\nb_1,90,7\n");
  }
  bool exists(const std::string& path) const { return std::filesystem::exists(root_ / path); }
  std::string hash_of(const std::string& folder) const {
    return Json::parse(run("session info --json " + folder).out)["content_hash"].text();
  }
};

TEST_F(BatchTable, ARowIsTheSessionOfAFileWithItsValues) {
  const Result result = run("record level.ini --table level.csv --out sets --quiet --no-pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  write("b.ini",
        "[vehicle]\nh = 90\n[map]\nsize = 4\n[experiment]\nname = b_1\nframes = 8\nseed = 7\n"
        "[parameters]\nrandom_seed = 7\n");
  ASSERT_EQ(run("record b.ini --out b --quiet --no-pictures").exit_code, 0);
  EXPECT_EQ(hash_of("sets/b_1-0001"), hash_of("b"));
  EXPECT_EQ(read(root_ / "sets/b_1-0001/experiment.ini"), read(root_ / "b/experiment.ini"));
  EXPECT_TRUE(exists("sets/a_1-0001/session.h5"));
  EXPECT_TRUE(exists("sets/a_2-0001/session.h5"));
}

TEST_F(BatchTable, MissingRunsAreMadeAndOthersStay) {
  const std::string command = "record level.ini --no-pictures --table level.csv --out sets --json ";
  // One row alone goes into the folder as well, and is a list of one.
  const Result first = run(command + "--rows 'b*'");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(Json::parse(first.out).size(), 1U);
  ASSERT_TRUE(exists("sets/b_1-0001"));
  EXPECT_FALSE(exists("sets/a_1-0001"));

  const Result second = run(command + "--missing");
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(Json::parse(second.out).size(), 2U);
  EXPECT_NE(second.err.find("note: 1 of 3 have a run already\n"), std::string::npos) << second.err;
  EXPECT_FALSE(exists("sets/b_1-0002"));

  const Result third = run(command + "--missing --quiet");
  EXPECT_EQ(third.exit_code, 0) << third.err;
  EXPECT_EQ(Json::parse(third.out), Json::array());
  EXPECT_EQ(third.err, "note: 3 of 3 have a run already\n");
}

TEST_F(BatchTable, MissingTellsWhatIsNotTheRunThatIsAskedFor) {
  const std::string command =
      "record level.ini --table level.csv --missing --out sets --quiet --no-pictures ";
  ASSERT_EQ(run(command).exit_code, 0);
  const std::string summary = "sets/a_1-0001/summary.json";
  Json ended = Json::parse(read(root_ / summary));
  ended["stopped_early"] = true;
  write(summary, ended.dump());
  EXPECT_EQ(run(command).err,
            "note: sets/a_1-0001 ended early; remove it, then --missing runs it again\n"
            "note: 3 of 3 have a run already\n");
  EXPECT_EQ(run(command + "--rows a_2 --frames 16").err,
            "note: sets/a_2-0001 is a run of other values; remove it, then --missing runs it "
            "again\nnote: 1 of 1 have a run already\n");

  std::filesystem::rename(root_ / "sets/b_1-0001", root_ / "sets/b_1-0001.partial");
  const Result left = run(command);
  EXPECT_EQ(left.exit_code, 2);
  EXPECT_NE(left.err.find("sets/b_1-0001.partial: left over"), std::string::npos) << left.err;
  std::filesystem::remove_all(root_ / "sets/b_1-0001.partial");
  std::filesystem::create_directories(root_ / "sets/b_1-0001");
  const Result empty = run(command);
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_NE(empty.err.find("sets/b_1-0001: is no run"), std::string::npos) << empty.err;
}

TEST_F(BatchTable, SimulationsTakeTablesToo) {
  const Result result = run(
      "sim level.ini --table level.csv --rows a_1 --duration 0.1 --out sims --quiet --no-pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists("sims/a_1-0001/session.h5"));
}

TEST_F(BatchTable, NothingIsRunWhenARowIsWrong) {
  write("wrong.csv", "experiment.name,vehicle.h\ngood,1\nbad,400\n");
  expect_refused(run("record level.ini --table wrong.csv"), 2,
                 {"wrong.csv:3: row 'bad', column 'vehicle.h'", "expected a number -360..360"});
  write("image.csv", "experiment.name,map.filename\ngood,\nbad,nothing.png\n");
  expect_refused(run("record level.ini --table image.csv"), 2,
                 {"experiment bad: [map] filename = 'nothing.png'", "no such file"});
  expect_refused(run("record level.ini --table none.csv"), 2, {"none.csv: no such table"});
  expect_refused(run("record level.ini level.ini --table level.csv"), 2,
                 {"--table needs one FILE"});
  expect_refused(run("record level.ini --table level.csv --rows c*"), 2,
                 {"--rows c*: no row has such a name; names are a_1, a_2, b_1"});
  expect_refused(run("record level.ini --rows a_1"), 2, {"--rows", "--table"});
}

}  // namespace
}  // namespace screed::testing
