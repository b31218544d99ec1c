#include "tools/mutants/tests_of_build.h"

#include <fnmatch.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <regex>
#include <sstream>
#include <thread>

#include "tools/mutants/process.h"
#include "tools/mutants/tables.h"

namespace screed::mutants {
namespace {

namespace fs = std::filesystem;

// A mutant's limit: several times what the tests take without one, and what a program needs to
// start.
constexpr double kSlower = 5.0;
constexpr double kStart_s = 1.0;
// Tests that run in one process, ms; the next ones as long as all before.
constexpr double kFirstPart_ms = 300.0;
constexpr std::size_t kReachPart = 12;  // tests

/// The word behind the mark at `at`, to the end of the line or a comma or blank.
std::string word_behind(const std::string& said, const std::string& mark, std::size_t at) {
  if (at == std::string::npos) return "";
  at += mark.size();
  return said.substr(at, said.find_first_of("\n, ", at) - at);
}

std::map<std::string, std::string> test_environment(const fs::path& programs,
                                                    const fs::path& scratch) {
  fs::create_directories(scratch / "tmp");
  return {{"SCREED_PROGRAM", fs::absolute(programs / "screed").string()},
          {"TMPDIR", fs::absolute(scratch / "tmp").string()}};
}

std::vector<std::string> names_of(const fs::path& program, const fs::path& scratch) {
  const Ended listed = run({program.string(), "--gtest_list_tests"}, {}, 0.0, scratch / "list.txt");
  std::vector<std::string> names;
  std::string suite;
  std::istringstream lines(listed.said);
  for (std::string line; std::getline(lines, line);) {
    const std::string word = line.substr(0, line.find("  # "));
    if (word.starts_with("  ")) {
      names.push_back(suite + word.substr(2));
    } else if (word.ends_with(".")) {
      suite = word;
    }
  }
  return names;
}

/// Lines "key program file_hash name ms passed ids..." by "program name file_hash".
std::map<std::string, TestCase> read_log(const fs::path& log, const std::string& key) {
  std::map<std::string, TestCase> known;
  std::ifstream in(log);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string of;
    std::string result;
    TestCase test;
    if (!(words >> of >> test.program >> test.file_hash >> test.name >> test.cpu_ms >> result))
      continue;
    if (of != key) continue;
    for (std::size_t id = 0; words >> id;) test.reached.insert(id);
    if (result != "passed") test.cpu_ms = -1.0;
    known[test.program + " " + test.name + " " + test.file_hash] = test;
  }
  return known;
}

}  // namespace

std::string failed_test(const std::string& said) {
  static const std::string kFailed = "[  FAILED  ] ";
  static const std::string kRun = "[ RUN      ] ";
  const std::string failed = word_behind(said, kFailed, said.find(kFailed));
  return failed.empty() ? word_behind(said, kRun, said.rfind(kRun)) : failed;
}

bool is_wanted(const std::string& name, const std::string& filter) {
  std::istringstream patterns(filter);
  for (std::string pattern; std::getline(patterns, pattern, ':');) {
    if (fnmatch(pattern.c_str(), name.c_str(), 0) == 0) return true;
  }
  return false;
}

std::string plain_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  const std::size_t slash = name.substr(0, dot).find('/');
  std::string suite = name.substr(0, dot);
  if (slash != std::string::npos) {
    // Prefix/Suite of TEST_P, Suite/0 of typed tests.
    const std::string behind = suite.substr(slash + 1);
    suite =
        std::isdigit(static_cast<unsigned char>(behind[0])) != 0 ? suite.substr(0, slash) : behind;
  }
  const std::string test = name.substr(dot + 1);
  return suite + "." + test.substr(0, test.find('/'));
}

std::map<std::string, std::string> hashes_of_tests(const fs::path& folder) {
  static const std::regex kTest(R"(\bTEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\))");
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = read_file(entry.path());
    const std::string of_file = hash(text);
    for (std::sregex_iterator test(text.begin(), text.end(), kTest), end; test != end; ++test) {
      hashes[(*test)[1].str() + "." + (*test)[2].str()] = of_file;
    }
  }
  return hashes;
}

Verdict TestRun::operator()(std::vector<const TestCase*> tests, std::size_t mutant) const {
  std::map<std::string, std::string> environment = test_environment(programs_, scratch_);
  environment["MUTANT"] = std::to_string(mutant);
  double part_ms = kFirstPart_ms;
  for (std::size_t at = 0; at < tests.size();) {
    const std::string& program = tests[at]->program;
    std::string filter;
    double sum_ms = 0.0;
    while (at < tests.size() && tests[at]->program == program &&
           (filter.empty() || sum_ms + tests[at]->cpu_ms <= part_ms)) {
      sum_ms += tests[at]->cpu_ms;
      filter += (filter.empty() ? "" : ":") + tests[at]->name;
      ++at;
    }
    part_ms = std::max(part_ms, sum_ms) * 2.0;
    const Ended ended =
        run({(programs_ / program).string(), "--gtest_fail_fast", "--gtest_filter=" + filter},
            environment, kStart_s + kSlower * sum_ms / 1e3, scratch_ / "output.txt");
    std::error_code ignored;
    fs::remove_all(scratch_ / "tmp", ignored);
    fs::create_directories(scratch_ / "tmp");
    if (ended.good) continue;
    const std::string by = failed_test(ended.said);
    return {true, (by.empty() ? filter.substr(0, filter.find(':')) : by) +
                      (ended.out_of_time ? " (time)" : "")};
  }
  return {false, ""};
}

std::vector<TestCase> find_reach(const fs::path& folder, const std::vector<std::string>& programs,
                                 const fs::path& log, const std::string& key, std::size_t mutants,
                                 std::size_t jobs, const std::string& filter) {
  const std::map<std::string, std::string> hashes = hashes_of_tests("tests");
  const std::map<std::string, TestCase> known = read_log(log, key);
  std::vector<TestCase> tests;
  std::vector<TestCase> unknown;
  for (const std::string& program : programs) {
    if (program == "screed") continue;  // of the tests of whole runs
    for (const std::string& name : names_of(folder / program, folder)) {
      // A stored hash notices everything and asserts nothing.
      if (!is_wanted(name, filter) || name.starts_with("ContentHash.")) continue;
      TestCase test{program, name, 0.0, "?", {}};
      const auto file = hashes.find(plain_name(name));
      if (file != hashes.end()) test.file_hash = file->second;
      const auto at = known.find(test.program + " " + name + " " + test.file_hash);
      (at != known.end() ? tests : unknown).push_back(at != known.end() ? at->second : test);
    }
  }
  std::fprintf(stderr, "mutants: what %zu tests reach; known of %zu\n",
               tests.size() + unknown.size(), tests.size());
  std::mutex writing;
  std::vector<std::thread> threads;
  for (std::size_t job = 0; job < jobs; ++job) {
    threads.emplace_back([&, job] {
      const fs::path scratch = folder / ("job." + std::to_string(job));
      std::map<std::string, std::string> environment = test_environment(folder, scratch);
      write_file(scratch / "reach", std::string(mutants + 1, '\0'));
      environment["MUTANTS_REACH"] = fs::absolute(scratch / "reach").string();
      environment["MUTANTS_LOG"] = fs::absolute(scratch / "log").string();
      // Every so many tests, of one program at a time.
      for (std::size_t begin = job * kReachPart; begin < unknown.size();
           begin += jobs * kReachPart) {
        for (const std::string& program : programs) {
          std::string names;
          std::map<std::string, std::string> of_test;
          for (std::size_t i = begin; i < std::min(begin + kReachPart, unknown.size()); ++i) {
            if (unknown[i].program != program) continue;
            names += (names.empty() ? "" : ":") + unknown[i].name;
            of_test[unknown[i].name] = unknown[i].file_hash;
          }
          if (names.empty()) continue;
          write_file(scratch / "log", "");
          run({(folder / program).string(), "--gtest_filter=" + names}, environment, 0.0,
              scratch / "output.txt");
          std::istringstream lines(read_file(scratch / "log"));
          std::string text;
          for (std::string line; std::getline(lines, line);) {
            const std::string name = line.substr(0, line.find(' '));
            text.append(key).append(" ").append(program).append(" ");
            text.append(of_test[name]).append(" ").append(line).append("\n");
          }
          const std::scoped_lock lock(writing);
          std::ofstream(log, std::ios::app) << text;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const std::map<std::string, TestCase> now = read_log(log, key);
  for (const TestCase& test : unknown) {
    const auto at = now.find(test.program + " " + test.name + " " + test.file_hash);
    if (at != now.end()) {
      tests.push_back(at->second);
    } else {
      std::fprintf(stderr, "mutants: %s did not end and is left out\n", test.name.c_str());
    }
  }
  std::erase_if(tests, [](const TestCase& test) {
    if (test.cpu_ms < 0.0)
      std::fprintf(stderr, "mutants: %s does not pass and is left out\n", test.name.c_str());
    return test.cpu_ms < 0.0;
  });
  return tests;
}

}  // namespace screed::mutants
