// The engine with workers of its own: failures one behind the other, and what becomes of a batch
// whose worker ends.
#include "host_sim/engine/task_engine.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_worker.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

/// What becomes of task i is its letter: (d)one, (f)ails, (c)rashes, crashes (o)nce.
class Letters : public TaskExecutor {
 public:
  Letters(std::string letters, std::filesystem::path folder)
      : letters_(std::move(letters)), folder_(std::move(folder)) {}
  size_t count() const override { return letters_.size(); }
  std::string id(size_t task) const override { return "task-" + std::to_string(task); }
  std::string execute(size_t task) override {
    const char letter = letters_.at(task);
    if (letter == 'f') throw std::runtime_error("trouble");
    const std::filesystem::path tried = folder_ / ("tried-" + std::to_string(task));
    if (letter == 'c' || (letter == 'o' && !std::filesystem::exists(tried))) {
      write_text(tried, "");
      std::_Exit(3);
    }
    return "1";
  }

 private:
  std::string letters_;
  std::filesystem::path folder_;
};

constexpr const char* kServe = "--serve-letters";

/// A worker is this program again, with words that tell it so: it serves before gtest says
/// anything.
[[maybe_unused]] const bool kIsWorker = [] {
  std::ifstream command("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(command, word, '\0');) words.push_back(word);
  if (words.size() != 4 || words[1] != kServe) return false;
  Letters letters(words[2], words[3]);
  serve_tasks(letters, TaskFolder{words[3]}.results(), {{"version", "1"}}, std::cin,
              [](const std::string& answer) { std::cout << answer << std::endl; });
  std::_Exit(0);
}();

class TaskEngine : public ::testing::Test {
 protected:
  EngineOutcome run(const std::string& letters, double batch_s = 0.0) {
    EngineOptions options;
    options.folder.path = folder_.path();
    options.worker_arguments = {kServe, letters, folder_.path().string()};
    EngineJob job;
    job.list = {[](size_t task) { return "task-" + std::to_string(task); },
                [](size_t task) { return "run " + std::to_string(task); },
                [](size_t) { return 1.0; }, [](size_t) { return 60.0; }};
    job.tasks.resize(letters.size());
    std::iota(job.tasks.begin(), job.tasks.end(), size_t{0});
    job.batch_s = batch_s;
    job.progress = [this](const EngineProgress& progress) { last_ = progress; };
    return run_tasks(options, job);
  }
  ResultIndex results() const { return ResultIndex(TaskFolder{folder_.path()}.results()); }

  TempFolder folder_;
  EngineProgress last_;
};

TEST_F(TaskEngine, StopsAfterTenFailuresInARow) {
  const EngineOutcome outcome = run("dffffffffffdd");
  EXPECT_EQ(outcome.done, 1U);
  EXPECT_EQ(outcome.failures.size(), 10U);
  EXPECT_EQ(outcome.stopped.rfind("the last 10 runs all failed; the last one trouble", 0), 0U)
      << outcome.stopped;
  EXPECT_EQ(results().places().size(), 11U) << "the two behind them were not begun";
}

TEST_F(TaskEngine, ARunThatIsDoneBeginsTheRowAnew) {
  const EngineOutcome outcome = run("fffffffffdfffffffffd");
  EXPECT_EQ(outcome.stopped, "");
  EXPECT_EQ(outcome.done, 2U);
  EXPECT_EQ(outcome.failures.size(), 18U);
  EXPECT_EQ(outcome.failures.back().rfind("run 18 ", 0), 0U) << outcome.failures.back();
  EXPECT_EQ(last_.done, 2U);
  EXPECT_EQ(last_.failed, 18U);
  EXPECT_NEAR(last_.share, 0.1, 1e-12);
}

// One that crashes is tried twice and is one of the row; one that crashes once is none.
TEST_F(TaskEngine, CrashesCountAsFailuresOnceTheyHaveBeenTriedAgain) {
  const EngineOutcome outcome = run("oofcdf");
  EXPECT_EQ(outcome.stopped, "");
  EXPECT_EQ(outcome.done, 3U);
  ASSERT_EQ(outcome.failures.size(), 2U + 1U);
  const ResultIndex index = results();
  EXPECT_EQ(index.failures("task-3"), 2U);
  EXPECT_EQ(index.failures("task-0"), 1U);
  EXPECT_TRUE(index.done("task-0"));
  EXPECT_TRUE(index.done("task-1"));
}

// All others of a batch are executed, one by one in their order; only the one that ends its worker
// fails.
TEST_F(TaskEngine, ABatchWhoseWorkerEndsIsTriedOneByOne) {
  const std::string letters = "ddddfdddfcdddddddddd";
  const EngineOutcome outcome = run(letters, 1000.0);
  EXPECT_EQ(outcome.stopped, "");
  EXPECT_EQ(outcome.done, 17U);
  ASSERT_EQ(outcome.failures.size(), 3U);
  EXPECT_EQ(outcome.failures[0], "run 4 trouble");
  EXPECT_EQ(outcome.failures[1], "run 8 trouble");
  EXPECT_EQ(outcome.failures[2].rfind("run 9 its worker ", 0), 0U);
  const ResultIndex index = results();
  for (size_t task = 0; task < 20; ++task)
    EXPECT_EQ(index.done("task-" + std::to_string(task)), letters[task] == 'd') << task;
  // Tried twice, as if it had not been in a batch: one that is lost is no attempt.
  EXPECT_EQ(index.failures("task-9"), 2U);
}

}  // namespace
}  // namespace screed
