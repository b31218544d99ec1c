// Tables of experiments.
#include <gtest/gtest.h>
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment_table.h"
#include "tests/temp_folder.h"

namespace screed {

namespace {

// Tables of experiments: what a row's experiment is, every complaint, and the tables that come with
// the project.

class ExperimentTable : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(family(), "[vehicle]\nx = 1\ny = 2\n[experiment]\nname = family\nseed = 7\n");
  }

  std::filesystem::path family() const { return folder_.path() / "f.ini"; }
  std::filesystem::path table() const { return folder_.path() / "t.csv"; }
  std::vector<ExperimentRow> rows(const std::string& text,
                                  const std::vector<std::string>& patterns = {}) const {
    write_text(table(), text);
    return select_rows(read_experiment_table(table()), patterns);
  }
  /// The experiments of all rows.
  std::vector<Experiment> read(const std::string& text,
                               const std::vector<std::string>& overrides = {}) const {
    const std::vector<ExperimentRow> all = rows(text);
    std::vector<Experiment> experiments;
    experiments.reserve(all.size());
    for (const ExperimentRow& row : all)
      experiments.push_back(read_experiment_row(family(), row, overrides));
    return experiments;
  }
  /// What is said of a table with this text; its path is left out.
  std::string refusal(const std::string& text,
                      const std::vector<std::string>& overrides = {}) const {
    try {
      read(text, overrides);
    } catch (const InputError& error) {
      std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      const std::string path = folder_.path().string() + "/";
      if (what.rfind(path, 0) == 0) what.erase(0, path.size());
      return what;
    }
    return "";
  }

  const TempFolder folder_;
};

std::vector<std::string> names_of(const std::vector<ExperimentRow>& rows) {
  std::vector<std::string> names;
  names.reserve(rows.size());
  for (const ExperimentRow& row : rows) names.push_back(row.name);
  return names;
}

TEST_F(ExperimentTable, ARowGivesTheExperimentThatItsValuesInTheFileGive) {
  const std::vector<Experiment> all =
      read("# two\nvehicle.x,experiment.name,soil.preset,map.model\n3,a,clay,scm\n-0,b,,\n");
  ASSERT_EQ(all.size(), 2U);
  write_text(folder_.path() / "a.ini",
             "[vehicle]\nx = 3\ny = 2\n[map]\nmodel = scm\n[soil]\npreset = clay\n[experiment]\n"
             "name = a\nseed = 7\n");
  EXPECT_EQ(all[0].text(), read_experiment(folder_.path() / "a.ini").text());
  EXPECT_EQ(all[0].folder, folder_.path());  // of the experiment file
  write_text(folder_.path() / "b.ini",
             "[vehicle]\nx = -0\ny = 2\n[experiment]\nname = b\nseed = 7\n");
  EXPECT_EQ(all[1].text(), read_experiment(folder_.path() / "b.ini").text());
}

TEST_F(ExperimentTable, AnEmptyCellLeavesTheFilesValueAndTheCommandLineHoldsAboveBoth) {
  const std::string text = "experiment.name,vehicle.x,vehicle.y\nrow,3,\n";
  const Experiment plain = read(text).front();
  EXPECT_EQ(plain.vehicle.x_m, 3.0);
  EXPECT_EQ(plain.vehicle.y_m, 2.0);
  const Experiment set = read(text, {"vehicle.x=4", "vehicle.y=5"}).front();
  EXPECT_EQ(set.vehicle.x_m, 4.0);
  EXPECT_EQ(set.vehicle.y_m, 5.0);
}

TEST_F(ExperimentTable, AColumnMayHoldSeveralKeys) {
  const Experiment e =
      read("experiment.name,experiment.seed + parameters.random_seed\nrow,411\n").front();
  EXPECT_EQ(e.experiment.seed, 411U);
  EXPECT_EQ(e.parameters.random_seed(), 411);
  EXPECT_EQ(refusal("experiment.name,experiment.seed + parameters.random_seed\nrow,40000\n"),
            "t.csv:2: row 'row', column 'experiment.seed + parameters.random_seed': [parameters] "
            "random_seed = '40000' is not allowed; expected an integer 0..32767");
}

TEST_F(ExperimentTable, RowsAreChosenByPatternsInTheTablesOrder) {
  const std::string text = "experiment.name\ne_1\nt_1\ne_2\nc_1\n";
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_of(rows(text)), (Names{"e_1", "t_1", "e_2", "c_1"}));
  EXPECT_EQ(names_of(rows(text, {"e_*"})), (Names{"e_1", "e_2"}));
  EXPECT_EQ(names_of(rows(text, {"c_?", "e_[2-9]", "c_1"})), (Names{"e_2", "c_1"}));
  try {
    rows(text, {"e_*", "e"});
    ADD_FAILURE() << "a pattern without a row was taken";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "--rows e: no row has such a name; names are e_1, t_1, e_2, c_1");
  }
}

TEST_F(ExperimentTable, AWrongHeadingIsRefusedWithWhatIsKnown) {
  const auto starts = [&](const std::string& text, const std::string& with) {
    EXPECT_EQ(refusal(text).rfind(with, 0), 0U) << refusal(text);
  };
  starts("\n# heading\nexperiment.name,vehicle.speed\nrow,1\n",
         "t.csv:3: column 'vehicle.speed': unknown key 'speed' in [vehicle]; did you mean "
         "[drive] speed; known are tracks, ");
  starts(
      "experiment.name,robot.x\nrow,1\n",
      "t.csv:1: column 'robot.x': unknown section [robot]; known are [vehicle], [robots], [map], ");
  starts("experiment.name,x\nrow,1\n",
         "t.csv:1: column 'x'; expected section.key of an experiment file, such as vehicle.x");
  starts("experiment.name,\nrow,1\n", "t.csv:1: column ''; expected section.key");
  starts("experiment.name,vehicle.x+\nrow,1\n", "t.csv:1: column 'vehicle.x+'; expected");
  // Where runs are made, and units, belong to the experiment file.
  starts("experiment.name,units\nrow,si\n", "t.csv:1: column 'units'; expected section.key");
  starts("experiment.name,vehicle.x,vehicle.x\nrow,1,1\n",
         "t.csv:1: column 'vehicle.x': vehicle.x is given twice; a key stands in one column");
  starts("vehicle.x\n1\n", "t.csv:1: no column 'experiment.name'; every row needs a name");
}

TEST_F(ExperimentTable, AWrongRowIsRefusedWithLineNameAndColumn) {
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na,1\n\nb,501\n"),
            "t.csv:4: row 'b', column 'vehicle.x': [vehicle] x = '501' is not allowed; expected a "
            "number -500..500 (m)");
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na/b,1\n"),
            "t.csv:2: row 'a/b', column 'experiment.name': [experiment] name = 'a/b' is not "
            "allowed; expected letters, digits, _ and -; at most 64");
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na,1\n,2\n"),
            "t.csv:3: column 'experiment.name' is empty; every row needs a name");
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na,1\nb,2\na,3\n"),
            "t.csv:4: row 'a', column 'experiment.name': the name is given twice, first in line 2");
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na,1,\n"),
            "t.csv:2: 3 cells; expected 2, as in the headings in line 1");
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na\n"),
            "t.csv:2: 1 cells; expected 2, as in the headings in line 1");
  // What several keys decide together names the row as well.
  EXPECT_EQ(
      refusal("experiment.name,map.filename,map.ramp\na,hills.png,3\n"),
      "t.csv:2: row 'a', column 'map.filename': [map] filename = 'hills.png' and ramp are both "
      "given; a ramp needs no image");
  // What the command line says is not the row's fault.
  EXPECT_EQ(refusal("experiment.name,vehicle.x\na,1\n", {"vehicle.x=501"}),
            "--set: [vehicle] x = '501' is not allowed; expected a number -500..500 (m)");
}

TEST_F(ExperimentTable, ATableWithoutRowsIsRefused) {
  EXPECT_EQ(refusal("# nothing\n").rfind("t.csv: no rows; expected", 0), 0U);
  EXPECT_EQ(refusal("experiment.name\n").rfind("t.csv: no rows; expected", 0), 0U);
}

/// The drives beside which the stand-in is judged (docs/standin.md).
const std::filesystem::path kStandIn = "host_sim/data/experiments/sessions/standin";

TEST(TableOfTheStandIn, EveryRowIsAValidExperimentOfItsOwn) {
  const std::vector<ExperimentRow> rows = read_experiment_table(kStandIn / "standin.csv");
  std::set<uint64_t> seeds;
  for (const ExperimentRow& row : rows) {
    Experiment e;
    ASSERT_NO_THROW(e = read_experiment_row(kStandIn / "standin.ini", row)) << row.where;
    EXPECT_EQ(e.experiment.name, row.name);
    EXPECT_TRUE(std::filesystem::exists(find_model_file(e)));
    EXPECT_EQ(e.map.model, "scm") << row.where;
    EXPECT_EQ(e.experiment.algorithm, kTrainingDriveName) << row.where;
    EXPECT_TRUE(e.notes.empty()) << row.where;
    EXPECT_TRUE(seeds.insert(e.experiment.seed).second) << row.where << ": seed of another row";
    EXPECT_EQ(static_cast<uint64_t>(e.parameters.random_seed()), e.experiment.seed) << row.where;
  }
  const auto count = [&](const char* pattern) { return select_rows(rows, {pattern}).size(); };
  EXPECT_EQ(count("c_*"), 12U);
  EXPECT_EQ(count("e_*"), 16U);
  EXPECT_EQ(rows.size(), 28U);
}

}  // namespace

}  // namespace screed
