// A campaign: builds the mutants of all targets, finds what tests reach them, runs those tests, and
// keeps what came out in a file, so that the next campaign does only what is missing.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tools/mutants/builder.h"
#include "tools/mutants/subjects.h"
#include "tools/mutants/tests_of_build.h"

namespace screed::mutants {

struct Options {
  std::filesystem::path build;  ///< objects and programs without mutants
  std::filesystem::path work;
  std::vector<std::string> files;  ///< only targets whose name contains one of these; empty: all
  std::size_t jobs = 1;
  std::size_t sample = 0;  ///< of each file; 0: what its line of the table says
  unsigned seed = 1;
  bool list = false;
  std::string tests = "*";  ///< only these tests, as GoogleTest filters them; without exclusions
  bool unit_only = false;   ///< without the tests of whole runs
  double longest_s = 1.5;   ///< without the tests that take longer, processor time; 0: all
};

class Campaign {
 public:
  explicit Campaign(Options options);
  void run();
  /// Prints the table. False: a file is below its bound.
  bool report() const;

 private:
  bool chosen(const Target& target) const;
  void build_switches(Subject& subject) const;
  void link(const std::string& program, const Objects& objects,
            const std::filesystem::path& folder) const;
  std::string build_reach(const std::filesystem::path& folder) const;
  void find_reach();
  void link_all();
  /// The tests that may notice a mutant, the quickest first, unit tests before the others.
  std::vector<const TestCase*> tests_for(const Subject& subject, const Candidate& candidate) const;
  std::string key_of(const std::vector<const TestCase*>& tests) const;
  bool recall(const Subject& subject, Candidate& candidate) const;
  void decide(const Subject& subject, Candidate& candidate, std::size_t job);
  Fate decide_alone(const Subject& subject, const Candidate& candidate,
                    const std::vector<const TestCase*>& tests, std::size_t job,
                    std::string& by) const;

  Options options_;
  std::chrono::steady_clock::time_point begin_;
  Builder builder_;
  std::vector<Subject> subjects_;
  std::size_t mutants_ = 0;  // of all subjects
  std::vector<TestCase> tests_;
  std::map<std::string, const TestCase*> test_of_name_;
  std::vector<std::vector<const TestCase*>> reached_by_;  // by number among all files
  std::map<std::string, std::string> results_;            // by "hash id"
  std::map<std::string, int> kills_;                      // by test, in this campaign
  std::mutex mutex_;
};

}  // namespace screed::mutants
