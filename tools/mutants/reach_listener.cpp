// Linked into test programs: notes after every test which mutants it passed and the processor time
// it took, one line "name milliseconds passed|failed|skipped id id ..." in the file that
// MUTANTS_LOG names.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "tools/mutants/mutant_switch.h"

namespace mutants {
namespace {

double cpu_ms() {
  double sum = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      sum += 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
    }
  }
  return sum;
}

class ReachListener : public testing::EmptyTestEventListener {
 public:
  ReachListener(const char* map, const char* log) : log_(std::fopen(log, "a")) {
    struct stat status {};
    if (log_ == nullptr || stat(map, &status) != 0) std::_Exit(3);
    size_ = static_cast<std::size_t>(status.st_size);
    shared_.resize(size_);
  }

 private:
  // What runs before a suite's first test runs for each of them.
  void OnTestSuiteStart(const testing::TestSuite& /*suite*/) override {
    std::memset(reached, 0, size_);
    first_ = true;
  }
  void OnTestStart(const testing::TestInfo& /*test*/) override {
    if (first_) shared_.assign(reached, reached + size_);
    first_ = false;
    std::memset(reached, 0, size_);
    start_ms_ = cpu_ms();
  }
  void OnTestEnd(const testing::TestInfo& test) override {
    const testing::TestResult& result = *test.result();
    std::fprintf(log_, "%s.%s %.3f %s", test.test_suite_name(), test.name(), cpu_ms() - start_ms_,
                 result.Skipped()  ? "skipped"
                 : result.Passed() ? "passed"
                                   : "failed");
    for (std::size_t id = 0; id < size_; ++id) {
      if (reached[id] != 0 || shared_[id] != 0) std::fprintf(log_, " %zu", id);
    }
    std::fputc('\n', log_);
    std::fflush(log_);
    std::memset(reached, 0, size_);
  }

  std::FILE* log_;
  std::size_t size_ = 0;
  std::vector<unsigned char> shared_;
  bool first_ = true;
  double start_ms_ = 0.0;
};

const bool kListens = [] {
  const char* map = std::getenv("MUTANTS_REACH");
  const char* log = std::getenv("MUTANTS_LOG");
  if (map == nullptr || log == nullptr) return false;
  testing::UnitTest::GetInstance()->listeners().Append(new ReachListener(map, log));
  return true;
}();

}  // namespace
}  // namespace mutants
