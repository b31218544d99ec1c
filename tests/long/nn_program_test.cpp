// `screed nn` as a user meets it: sessions in, a model and a header out.
// Long: each test records sessions and trains a network on them, twice where bytes are compared.
#include <sstream>

#include "host_sim/core/json.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/model/model_file.h"
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

class NnProgram : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("drive.ini",
          "[vehicle]\nh = 30\n[map]\nsize = 3\nmodel = rigid\n[experiment]\nname = drive\n"
          "frames = 800\n");
    ASSERT_EQ(run("record drive.ini --no-pictures --out s/drive").exit_code, 0);
    ASSERT_EQ(run("record drive.ini --no-pictures --out s/other --seed 9").exit_code, 0);
    ASSERT_EQ(run("record drive.ini --no-pictures --out s/third --seed 10").exit_code, 0);
    write("small.json", configuration());
  }

  static std::string configuration() {
    return R"({
      // comments are allowed
      "name": "small", "train": ["drive"], "choice": "third", "test": [{"label": "B", "session": "other"}],
      "stages": [{"stage": "remove_far", "feature": "delta_x", "sigmas": 8}, {"stage": "normalise"},
                 {"stage": "mean", "width": 25}, {"stage": "quantise", "step": 0.2}],
      "run_time": ["mean"],
      "training": {"inputs": ["v_left", "v_right"], "hidden": [6], "optimiser": "adam",
                   "learning_rate": 0.01, "epochs": 6, "batch": 16, "batch_norm": "scaled"},
      "networks": [{"outputs": ["delta_theta"]}, {"outputs": ["v", "forward"], "output": "linear"},
                   {"outputs": ["forward"], "baseline": "forward@1"}]
    })";
  }
  static std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }
};

TEST_F(NnProgram, FromSessionsToAModelAHeaderAndFigures) {
  const Result tables = run("nn preprocess small.json --sessions s --out tables");
  ASSERT_EQ(tables.exit_code, 0) << tables.err;
  EXPECT_NE(tables.out.find("800 of 800 training frames stay"), std::string::npos) << tables.out;
  const std::string csv = read(root_ / "tables/train_drive.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "frame,v_left,v_right,delta_theta,v,forward,forward@1,forward-forward@1,delta_x");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 801);

  const Result trained = run("nn train small.json --sessions s --out m --json --no-pictures");
  ASSERT_EQ(trained.exit_code, 0) << trained.err;
  const Json scores = Json::parse(trained.out)["scores"];
  ASSERT_EQ(scores.size(), 12U);  // four outputs, as trained, smoothed and raw
  EXPECT_EQ(scores[0]["output"], "delta_theta");
  for (const Json& score : scores) EXPECT_LT(score["integers_off"], 3e-3) << score;

  const nn::Model model = nn::read_model(root_ / "m/model.json");
  ASSERT_EQ(model.networks.size(), 3U);
  EXPECT_EQ(model.networks[1].outputs.size(), 2U);
  EXPECT_TRUE(model.networks[1].network.layers().back().linear);
  EXPECT_EQ(model.networks[2].outputs[0].baseline, "forward@1");
  ASSERT_EQ(model.stages.size(), 4U);
  EXPECT_FALSE(model.stages[0].run_time);
  EXPECT_TRUE(model.stages[2].run_time);

  // Evaluated by what the model's file carries: the same figures.
  const Result evaluated = run("nn eval m/model.json small.json --sessions s --json --out charts");
  ASSERT_EQ(evaluated.exit_code, 0) << evaluated.err;
  EXPECT_EQ(evaluated.out, trained.out);
  EXPECT_TRUE(std::filesystem::exists(root_ / "charts/delta_theta_B_raw_series.svg"));
  EXPECT_TRUE(std::filesystem::exists(root_ / "charts/delta_theta_B_raw_regression.png"));

  const Result shown = run("nn show m/model.json");
  EXPECT_NE(shown.out.find("network 2-6-1: 25 parameters"), std::string::npos) << shown.out;
  const Result header = run("nn export m/model.json");
  EXPECT_NE(header.out.find("dense<2, 6, "), std::string::npos) << header.out;
  const Result checked = run("nn check m/model.json --vectors 3000");
  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_NE(checked.out.find("no bit differs"), std::string::npos) << checked.out;
}

TEST_F(NnProgram, TheSameTrainingGivesTheSameBytesEvenInTwoParts) {
  const std::string train = "nn train small.json --sessions s --no-pictures --out ";
  ASSERT_EQ(run(train + "a").exit_code, 0);
  ASSERT_EQ(run(train + "b").exit_code, 0);
  EXPECT_EQ(read(root_ / "a/model.json"), read(root_ / "b/model.json"));

  // One network is to begin again, one to go on behind its last epoch.
  std::filesystem::remove(root_ / "b/checkpoints/delta_theta.checkpoint.json");
  ASSERT_EQ(run(train + "b --resume").exit_code, 0);
  EXPECT_EQ(read(root_ / "a/model.json"), read(root_ / "b/model.json"));

  ASSERT_EQ(run(train + "c --seed 2").exit_code, 0);
  EXPECT_NE(read(root_ / "a/model.json"), read(root_ / "c/model.json"));
  expect_refused(run(train + "b --resume --seed 2"), 2, {"checkpoint.json", "another training"});
}

TEST_F(NnProgram, ATrainingThatIsStoppedGoesOnToTheSameBytes) {
  write("long.json", replaced(configuration(), "\"epochs\": 6", "\"epochs\": 100000"));
  Terminal terminal({program_, "nn", "train", "long.json", "--sessions", "s", "--out", "m"}, root_);
  ASSERT_TRUE(terminal.wait_for(": epoch ")) << terminal.screen();
  terminal.signal(SIGINT);
  EXPECT_EQ(terminal.exit_code(), 130) << terminal.screen();
  EXPECT_NE(terminal.screen().find("screed: stopped while training; --resume goes on from the "
                                   "checkpoints\r\n"),
            std::string::npos)
      << terminal.screen();
  size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root_ / "m")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_TRUE(entry.path().string().ends_with(".checkpoint.json")) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 3U);
}

// So many sessions, each read anew, that the signal comes in their midst.
TEST_F(NnProgram, ReadingSessionsIsStoppedAndLeavesNothing) {
  std::string many = "\"drive\"";
  std::string tests = R"({"label": "B", "session": "other"})";
  const std::string one_test = tests;
  for (int i = 0; i < 999; ++i) {
    many += ", \"drive\"";
    tests += ", " + one_test;
  }
  write("many.json", replaced(configuration(), "\"drive\"", many));
  write("tests.json", replaced(configuration(), one_test, tests));
  ASSERT_EQ(run("nn train small.json --sessions s --no-pictures --out m").exit_code, 0);
  struct Case {
    const char* arguments;
    const char* task;
  };
  for (const Case& it :
       {Case{"nn preprocess many.json --out t", "reading training sessions"},
        Case{"nn train many.json --out t", "reading training sessions"},
        Case{"nn eval m/model.json tests.json --out t", "reading test sessions"}}) {
    SCOPED_TRACE(it.arguments);
    const Result result = interrupted(it.arguments + std::string(" --sessions s"));
    EXPECT_EQ(result.exit_code, 130);
    EXPECT_EQ(result.err, std::string("screed: stopped while ") + it.task + "\n");
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(root_ / "t"));
  }
}

TEST_F(NnProgram, QuantisesATrainedModelAnewToTheSameBytes) {
  ASSERT_EQ(run("nn train small.json --sessions s --no-pictures --out m").exit_code, 0);
  const Result result = run("nn quantise m/model.json small.json --sessions s --out again.json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read(root_ / "again.json"), read(root_ / "m/model.json"));

  // By what a running world does to the inputs, as the configuration says it now.
  write("rounds.json", replaced(configuration(), "[\"mean\"]", "[\"mean\", \"quantise\"]"));
  ASSERT_EQ(
      run("nn quantise m/model.json rounds.json --sessions s --out rounds_model.json").exit_code,
      0);
  const nn::Model model = nn::read_model(root_ / "rounds_model.json");
  EXPECT_TRUE(model.stages[3].run_time);
  EXPECT_NE(model.networks[0].network.layers()[0].bias,
            nn::read_model(root_ / "m/model.json").networks[0].network.layers()[0].bias);

  write("wrong.json", replaced(configuration(), "\"drive\"", "\"other\""));
  expect_refused(run("nn quantise m/model.json wrong.json --sessions s --out x.json"), 2,
                 {"m/model.json: is of small", "allowed is the model of this configuration"});
}

TEST_F(NnProgram, RefusesWhatIsWrongInOneLine) {
  const auto refused = [&](const std::string& what, const std::string& by,
                           const std::vector<std::string>& parts) {
    write("wrong.json", replaced(configuration(), what, by));
    expect_refused(run("nn train wrong.json --sessions s --out m"), 2, parts);
  };
  refused("\"adam\"", "\"adagrad\"",
          {"wrong.json: training.optimiser: 'adagrad'; allowed is irprop-, sgd, adam"});
  refused("\"v_left\"", "\"v_up\"", {"training.inputs[0]", "'v_up' is not known", "v_left"});
  refused("[\"drive\"]", "[\"nowhere\"]", {"no session nowhere"});
  refused("\"hidden\": [6]", "\"hidden\": [0]", {"training.hidden[0]: 0; allowed is an integer 1"});
  refused("\"epochs\"", "\"epoch\"", {"'epoch' is not known"});
  refused("{\"stage\": \"normalise\"},", "", {"stages: no stage 'normalise'"});
  refused("\"delta_x\"", "\"delta_up\"", {"'delta_up' is not known"});
  expect_refused(run("nn show small.json"), 2, {"small.json: is no network model"});
  expect_refused(run("nn train small.json --sessions none --out m"), 2, {"no session drive"});
}

// No test decides anything: the epoch that is kept is the one with the least error of the choice.
TEST_F(NnProgram, TheChoiceDecidesAndIsNoTest) {
  write("best.json",
        replaced(configuration(), "\"epochs\": 6", "\"epochs\": 40, \"keep\": \"best\""));
  const Result trained = run("nn train best.json --sessions s --out m");
  ASSERT_EQ(trained.exit_code, 0) << trained.err;
  std::istringstream table(read(root_ / "m/loss_delta_theta.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "epoch,training,choice");
  double least = 1e9;
  std::string best;
  while (std::getline(table, line)) {
    const double error = std::stod(line.substr(line.rfind(',') + 1));
    if (error < least) {
      least = error;
      best = line.substr(0, line.find(','));
    }
  }
  EXPECT_NE(trained.out.find("delta_theta: error of the choice (third) "), std::string::npos)
      << trained.out;
  EXPECT_NE(trained.out.find(", epoch " + best + "\n"), std::string::npos) << trained.out;
  write("test.json", replaced(configuration(), "\"third\"", "\"other\""));
  expect_refused(run("nn train test.json --sessions s --out n"), 2,
                 {"test.json", "choice", "test"});
  write("none.json", replaced(configuration(), "\"choice\": \"third\", ", ""));
  expect_refused(run("nn train none.json --sessions s --out n"), 2, {"none.json", "choice"});
  const Result page = run("nn eval m/model.json best.json --sessions s --markdown");
  ASSERT_EQ(page.exit_code, 0) << page.err;
  EXPECT_EQ(page.out.rfind("## small\n", 0), 0U) << page.out;
  EXPECT_NE(page.out.find("| `delta_theta` | B | as trained |"), std::string::npos) << page.out;
}

}  // namespace
}  // namespace screed::testing
