// The tests of a build: which mutants each of them reaches, how long it takes, and running some of
// them.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace screed::mutants {

struct TestCase {
  std::string program;  ///< unit_tests or another one
  std::string name;
  double cpu_ms = 0.0;
  std::string file_hash;          ///< of the source that it stands in
  std::set<std::size_t> reached;  ///< numbers of mutants, counted through all sources
};

/// "Suite.Name" of every test in the sources below `folder`, and the hash of its file. Those with
/// parameters stand there without what GoogleTest adds.
std::map<std::string, std::string> hashes_of_tests(const std::filesystem::path& folder);
/// "Prefix/Suite.Name/0" -> "Suite.Name".
std::string plain_name(const std::string& name);

/// "Suite.Name" of the test that failed, of what a program run with --gtest_fail_fast said: tests
/// behind it are begun, too, as skipped ones; one that crashed or was ended has no result and is
/// the last. Empty where no test was begun.
std::string failed_test(const std::string& said);

struct Verdict {
  bool killed;
  std::string by;  ///< the test
};

/// Runs tests of a program in the folder `programs` against one mutant, the quickest first, until
/// one fails.
class TestRun {
 public:
  TestRun(std::filesystem::path programs, std::filesystem::path scratch)
      : programs_(std::move(programs)), scratch_(std::move(scratch)) {}
  Verdict operator()(std::vector<const TestCase*> tests, std::size_t mutant) const;

 private:
  std::filesystem::path programs_;
  std::filesystem::path scratch_;
};

/// Whether the name is of a filter "PATTERN:PATTERN", with * and ?.
bool is_wanted(const std::string& name, const std::string& filter);

/// Runs all tests of the filter and of the programs in `folder` that `log` does not hold yet under
/// `key`, and adds them there. Tests that fail without a mutant are left out, with a line on
/// stderr.
std::vector<TestCase> find_reach(const std::filesystem::path& folder,
                                 const std::vector<std::string>& programs,
                                 const std::filesystem::path& log, const std::string& key,
                                 std::size_t mutants, std::size_t jobs, const std::string& filter);

}  // namespace screed::mutants
