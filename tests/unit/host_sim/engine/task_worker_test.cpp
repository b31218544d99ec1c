// What workers and those who start them say to each other, and what workers store.
#include "host_sim/engine/task_worker.h"

#include <gtest/gtest.h>

#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_engine.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

/// Task i yields i squared; task 3 fails, task 6 finds no memory.
class Squares : public TaskExecutor {
 public:
  size_t count() const override { return 10; }
  std::string id(size_t task) const override { return "square-" + std::to_string(task); }
  std::string execute(size_t task) override {
    if (task == 3) throw std::runtime_error("three\nlines \xff of trouble");
    if (task == 6) throw std::bad_alloc();
    return std::to_string(task * task);
  }
};

/// Of the requests, in their order.
std::vector<WorkerAnswer> serve(TaskExecutor& executor, const std::filesystem::path& results,
                                const std::string& requests) {
  std::istringstream stream(requests);
  std::vector<WorkerAnswer> answers;
  serve_tasks(executor, results, {{"version", "1.2.3"}, {"arithmetic", "round"}}, stream,
              [&](const std::string& text) { answers.push_back(parse_answer(text)); });
  return answers;
}

TEST(TaskWorker, AnswersAreReadBack) {
  for (const WorkerAnswer::Kind kind :
       {WorkerAnswer::Kind::kDone, WorkerAnswer::Kind::kTried, WorkerAnswer::Kind::kStop}) {
    const WorkerAnswer said{
        kind, "a message\nof two lines", {{7, "why\nnot"}}, R"({"x":1})", 0.123456789, 120.5};
    const std::string text = answer_text(said);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const WorkerAnswer read = parse_answer(text);
    EXPECT_EQ(read.kind, kind);
    EXPECT_EQ(read.message, said.message);
    EXPECT_EQ(read.failures, said.failures);
    EXPECT_EQ(read.trial, said.trial);
    EXPECT_EQ(read.seconds, said.seconds);
    EXPECT_EQ(read.memory_mb, said.memory_mb);
  }
}

TEST(TaskWorker, WhatIsNoAnswerStops) {
  for (const char* text : {"", "hello", "{}", "[1]", R"({"kind":"done"})"}) {
    const WorkerAnswer read = parse_answer(text);
    EXPECT_EQ(read.kind, WorkerAnswer::Kind::kStop) << text;
    EXPECT_FALSE(read.message.empty()) << text;
  }
}

TEST(TaskWorker, ATaskThatFindsNoMemorySaysSoInWords) {
  const TempFolder folder;
  Squares squares;
  const auto answers = serve(squares, folder.path(), execute_request({6}, 1));
  ASSERT_EQ(answers.size(), 1U);
  ASSERT_EQ(answers[0].failures.size(), 1U);
  EXPECT_EQ(answers[0].failures[0].second, "out of memory");
}

TEST(TaskWorker, StoresEachTaskOfARequest) {
  const TempFolder folder;
  Squares squares;
  const auto answers = serve(
      squares, folder.path(),
      execute_request({2, 3, 9}, 1) + "\n" + execute_request({4}, 2) + "\n" + trial_request(1));
  ASSERT_EQ(answers.size(), 3U);
  EXPECT_EQ(answers[0].kind, WorkerAnswer::Kind::kDone);
  ASSERT_EQ(answers[0].failures.size(), 1U);
  EXPECT_EQ(answers[0].failures[0].first, 3U);
  EXPECT_NE(answers[0].failures[0].second.find("of trouble"), std::string::npos);
  EXPECT_TRUE(answers[1].failures.empty());
  EXPECT_GT(answers[1].memory_mb, 0.0);
  EXPECT_EQ(answers[2].kind, WorkerAnswer::Kind::kTried);  // there are no trials of squares
  EXPECT_EQ(answers[2].failures.size(), 1U);

  const ResultIndex results(folder.path());
  EXPECT_EQ(results.places().size(), 4U);
  EXPECT_EQ(results.read("square-9").result, "81");
  EXPECT_TRUE(results.failed("square-3"));
  const std::string provenance = results.read("square-4").provenance;
  for (const char* part : {R"("version":"1.2.3")", R"("arithmetic":"round")", R"("attempt":2)",
                           R"("processor_seconds":)"})
    EXPECT_NE(provenance.find(part), std::string::npos) << provenance;
}

TEST(TaskWorker, ATaskThatThereIsNotStops) {
  const TempFolder folder;
  Squares squares;
  for (const std::string& request : {execute_request({1, 10}, 1), trial_request(10)}) {
    const auto answers = serve(squares, folder.path(), request);
    ASSERT_EQ(answers.size(), 1U);
    EXPECT_EQ(answers[0].kind, WorkerAnswer::Kind::kStop);
    EXPECT_NE(answers[0].message.find("10"), std::string::npos);
  }
}

TEST(TaskWorker, AResultThatCannotBeStoredStops) {
  const TempFolder folder;
  write_text(folder.path() / "results", "a file");
  Squares squares;
  const auto answers = serve(squares, folder.path() / "results", execute_request({1}, 1));
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].kind, WorkerAnswer::Kind::kStop);
  EXPECT_NE(answers[0].message.find("results"), std::string::npos);
}

TEST(WorkerPool, TakesNoMoreWorkersThanMemoryAllows) {
  EXPECT_EQ(workers_that_fit(0.0, 7), 7);
  EXPECT_EQ(workers_that_fit(0.001, 7), 7);
  EXPECT_EQ(workers_that_fit(1e12, 7), 1);
  const double available_mb = available_memory_mb().value();
  EXPECT_LT(workers_that_fit(available_mb / 3.0, 7), 4);
}

}  // namespace
}  // namespace screed
