#include "tools/mutants/campaign.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "tools/mutants/syntax.h"

namespace screed::mutants {
namespace {

namespace fs = std::filesystem;

/// Calls `what` with 0 to count - 1 and the number of the thread. Throws what one of them threw.
void in_parallel(std::size_t count, std::size_t jobs,
                 const std::function<void(std::size_t, std::size_t)>& what) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr error;
  std::vector<std::thread> threads;
  for (std::size_t job = 0; job < jobs; ++job) {
    threads.emplace_back([&, job] {
      try {
        for (std::size_t i = next++; i < count; i = next++) what(i, job);
      } catch (...) {
        next = count;
        const std::scoped_lock lock(mutex);
        error = std::current_exception();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

std::string folder_name(std::string source) {
  std::replace(source.begin(), source.end(), '/', '.');
  return source;
}

}  // namespace

Campaign::Campaign(Options options)
    : options_(std::move(options)),
      begin_(std::chrono::steady_clock::now()),
      builder_(options_.build, options_.work, options_.unit_only) {
  std::size_t first = 0;
  for (Subject& subject :
       read_subjects("tools/mutants/targets.txt", "tools/mutants/equivalent.txt")) {
    if (!chosen(subject.target)) continue;
    subject.first = first;
    first += subject.candidates.size();
    subject.folder = options_.work / folder_name(subject.target.source);
    draw_sample(subject, options_.sample != 0 ? options_.sample : subject.target.sample,
                options_.seed);
    subjects_.push_back(std::move(subject));
  }
  if (subjects_.empty()) throw std::runtime_error("no row of targets.txt has a name like --file");
  mutants_ = first;
  std::ifstream in(options_.work / "results.txt");
  for (std::string line; std::getline(in, line);) {
    const std::size_t second = line.find(' ', line.find(' ') + 1);
    if (second != std::string::npos) results_[line.substr(0, second)] = line.substr(second + 1);
  }
}

bool Campaign::chosen(const Target& target) const {
  return options_.files.empty() ||
         std::any_of(options_.files.begin(), options_.files.end(), [&](const std::string& part) {
           return target.source.find(part) != std::string::npos;
         });
}

void Campaign::build_switches(Subject& subject) const {
  // What the compiler made of it without mutants stands for all that it includes.
  std::string key = with_switches(subject.text, subject.mutations, {}, {}) +
                    read_file("tools/mutants/mutant_switch.h");
  for (const Unit& unit : builder_.units_of(subject.target.source)) key += read_file(unit.object);
  key = hash(key);
  const fs::path notes = subject.folder / "switches.txt";
  if (fs::exists(notes)) {
    std::istringstream in(read_file(notes));
    std::string word;
    in >> word;
    if (word == key) {
      while (in >> word) {
        std::string value;
        in >> value;
        if (word == "alone") subject.alone.insert(std::stoul(value));
        if (word == "kept") subject.kept.insert(value);
        if (word == "object") {
          std::string mutated;
          in >> mutated;
          subject.objects.objects.emplace_back(value, mutated);
        }
      }
      subject.objects.compiled = true;
      return;
    }
  }
  subject.objects = builder_.compile_switches(subject.target.source, subject.mutations,
                                              subject.folder, subject.alone, subject.kept);
  if (!subject.objects.compiled) {
    throw std::runtime_error(subject.target.source + " does not compile\n" + subject.objects.said);
  }
  std::string text = key + "\n";
  for (const std::size_t site : subject.alone) text += "alone " + std::to_string(site) + "\n";
  for (const std::string& name : subject.kept) text += "kept " + name + "\n";
  for (const auto& [original, mutated] : subject.objects.objects) {
    text.append("object ").append(original).append(" ").append(mutated).append("\n");
  }
  write_file(notes, text);
  for (const std::string& program : builder_.programs()) fs::remove(subject.folder / program);
}

void Campaign::link(const std::string& program, const Objects& objects,
                    const fs::path& folder) const {
  const Ended linked = builder_.link(program, objects, folder / program);
  if (linked.good) return;
  throw std::runtime_error((folder / program).string() + " does not link\n" + linked.said);
}

/// The programs that note which mutants a test reaches; they hold all sources with their switches.
/// Returns what they are made of, hashed.
std::string Campaign::build_reach(const fs::path& folder) const {
  // All copies in one folder, since an object may be made of several of them.
  const fs::path sources = folder / "sources";
  fs::remove_all(sources);
  std::string all;
  std::map<std::string, std::pair<Unit, std::string>> units;  // with the copies in it, by object
  for (const Subject& subject : subjects_) {
    const std::string text =
        with_switches(subject.text, subject.mutations, subject.alone, subject.kept, subject.first);
    write_file(sources / subject.target.source, text);
    all += text;
    for (const Unit& unit : builder_.units_of(subject.target.source)) {
      auto& [of_object, copies] = units[unit.object];
      of_object = unit;
      copies += text;
    }
  }
  std::string key = hash(all + read_file("tools/mutants/mutant_switch.h"));
  const bool built =
      fs::exists(folder / "key.txt") && read_file(folder / "key.txt") == key &&
      std::all_of(builder_.programs().begin(), builder_.programs().end(),
                  [&](const std::string& program) {
                    return fs::exists(folder / program) &&
                           fs::last_write_time(folder / program) > builder_.newest_object();
                  });
  if (built) return key;
  std::vector<const std::pair<Unit, std::string>*> list;
  list.reserve(units.size());
  for (const auto& [object, unit] : units) list.push_back(&unit);
  std::vector<Objects> objects(list.size());
  in_parallel(list.size(), options_.jobs, [&](std::size_t i, std::size_t) {
    // That of the campaign before, when it is made of the same.
    const auto& [unit, copies] = *list[i];
    const fs::path object = folder / unit.object;
    const fs::path stamp = object.string() + ".stamp";
    const std::string made_of = hash(copies + read_file(unit.object));
    if (fs::exists(stamp) && read_file(stamp) == made_of) {
      objects[i] = {true, "", {{unit.object, object.string()}}};
      return;
    }
    fs::remove(stamp);
    objects[i] = builder_.compile(unit, sources, object, {"-DMUTANTS_REACH"});
    if (objects[i].compiled) write_file(stamp, made_of);
  });
  Objects together{true, "", {}};
  for (const Objects& one : objects) {
    if (!one.compiled) throw std::runtime_error("switches do not compile together\n" + one.said);
    together.objects.push_back(one.objects.front());
  }
  for (const std::string& program : builder_.programs()) link(program, together, folder);
  write_file(folder / "key.txt", key);
  return key;
}

void Campaign::find_reach() {
  const fs::path folder = options_.work / "reach";
  const std::string key = build_reach(folder);
  tests_ = mutants::find_reach(folder, builder_.programs(), options_.work / "reach.txt", key,
                               mutants_, options_.jobs, options_.tests);
  if (options_.longest_s > 0.0) {
    const std::size_t before = tests_.size();
    std::erase_if(tests_,
                  [&](const TestCase& test) { return test.cpu_ms > 1e3 * options_.longest_s; });
    std::fprintf(stderr, "mutants: %zu tests of more than %g s are left out (--longest)\n",
                 before - tests_.size(), options_.longest_s);
  }
  reached_by_.assign(mutants_ + 1, {});
  for (const TestCase& test : tests_) {
    test_of_name_[test.name] = &test;
    for (const std::size_t id : test.reached) {
      if (id < reached_by_.size()) reached_by_[id].push_back(&test);
    }
  }
}

void Campaign::link_all() {
  std::vector<std::pair<const Subject*, std::string>> missing;
  for (const Subject& subject : subjects_) {
    for (const std::string& program : builder_.programs()) {
      const fs::path result = subject.folder / program;
      const bool there =
          fs::exists(result) && fs::last_write_time(result) > builder_.newest_object();
      if (!there) missing.emplace_back(&subject, program);
    }
  }
  in_parallel(missing.size(), options_.jobs, [&](std::size_t i, std::size_t) {
    const auto& [subject, program] = missing[i];
    link(program, subject->objects, subject->folder);
  });
}

std::vector<const TestCase*> Campaign::tests_for(const Subject& subject,
                                                 const Candidate& candidate) const {
  const std::vector<Site>& sites = subject.mutations.sites;
  const Site& site = sites[candidate.site];
  const auto is_switched = [&](std::size_t i) {
    return !subject.alone.contains(i) && !subject.kept.contains(sites[i].constant);
  };
  std::set<const TestCase*> found;
  const auto take = [&](const std::function<bool(const Site&)>& wanted) {
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (!is_switched(i) || !wanted(sites[i])) continue;
      for (std::size_t k = 0; k < sites[i].mutants.size(); ++k) {
        const auto& tests = reached_by_[subject.first + sites[i].first_number + k];
        found.insert(tests.begin(), tests.end());
      }
    }
  };
  const auto same = [&](const Site& other) { return other.first_number == site.first_number; };
  const auto same_function = [&](const Site& other) { return other.function == site.function; };
  // A constant is made before the first test: whoever uses it reaches it. What has a program of its
  // own is reached with the rest of its function.
  if (site.constant.empty() && is_switched(candidate.site) && site.function != 0) {
    take(same);
  } else {
    if (site.function != 0) take(same_function);
    if (found.empty()) take([](const Site&) { return true; });
    // Where nothing has a switch, nothing tells which tests reach it.
    if (subject.alone.size() == sites.size()) {
      for (const TestCase& test : tests_) found.insert(&test);
    }
  }
  std::vector<const TestCase*> tests;
  for (const TestCase* test : found) {
    if (is_wanted(test->name, subject.target.tests)) tests.push_back(test);
  }
  const auto rank = [&](const TestCase* test) {
    const auto kills = kills_.find(test->name);
    return test->cpu_ms / (1.0 + (kills == kills_.end() ? 0.0 : kills->second));
  };
  std::sort(tests.begin(), tests.end(), [&](const TestCase* a, const TestCase* b) {
    if (a->program != b->program) return a->program == "unit_tests";
    const double rank_a = rank(a);
    const double rank_b = rank(b);
    return rank_a != rank_b ? rank_a < rank_b : a->name < b->name;
  });
  return tests;
}

std::string Campaign::key_of(const std::vector<const TestCase*>& tests) const {
  std::set<std::string> all;
  for (const TestCase* test : tests) all.insert(test->name + test->file_hash);
  std::string text;
  for (const std::string& one : all) text += one;
  return hash(text);
}

/// What an earlier campaign found, if it still holds: a mutant is killed as long as the file of the
/// test that killed it is the same, and survives as long as those of all its tests are.
bool Campaign::recall(const Subject& subject, Candidate& candidate) const {
  const auto at = results_.find(hash(subject.text) + " " + candidate.id);
  if (at == results_.end()) return false;
  std::istringstream words(at->second);
  std::string verdict;
  std::string file_hash;
  words >> verdict >> file_hash >> std::ws;
  std::getline(words, candidate.detail);
  if (verdict == "invalid") {
    candidate.fate = Fate::kInvalid;
    return true;
  }
  if (verdict == "killed") {
    const auto test = test_of_name_.find(candidate.detail.substr(0, candidate.detail.find(' ')));
    if (test == test_of_name_.end() || test->second->file_hash != file_hash) return false;
    candidate.fate = Fate::kKilled;
    return true;
  }
  if (file_hash != key_of(tests_for(subject, candidate))) return false;
  candidate.fate = Fate::kSurvived;
  return true;
}

Fate Campaign::decide_alone(const Subject& subject, const Candidate& candidate,
                            const std::vector<const TestCase*>& tests, std::size_t job,
                            std::string& by) const {
  const fs::path folder = options_.work / ("alone." + std::to_string(job));
  fs::remove_all(folder);  // no copies of other sources
  const Objects objects = builder_.compile(subject.target.source,
                                           with_edit(subject.text, candidate.mutant.edit), folder);
  if (!objects.compiled) return Fate::kInvalid;
  for (const std::string& program : builder_.programs()) {
    std::vector<const TestCase*> part;
    std::copy_if(tests.begin(), tests.end(), std::back_inserter(part),
                 [&](const TestCase* test) { return test->program == program; });
    if (part.empty()) continue;
    if (!builder_.link(program, objects, folder / program).good) return Fate::kInvalid;
    // Others than unit tests run it.
    if (program != "unit_tests" && !builder_.link("screed", objects, folder / "screed").good) {
      return Fate::kInvalid;
    }
    const Verdict verdict =
        TestRun(folder, options_.work / ("job." + std::to_string(job)))(part, 0);
    by = verdict.by;
    if (verdict.killed) return Fate::kKilled;
  }
  return Fate::kSurvived;
}

void Campaign::decide(const Subject& subject, Candidate& candidate, std::size_t job) {
  std::vector<const TestCase*> tests;
  {
    const std::scoped_lock lock(mutex_);
    tests = tests_for(subject, candidate);
  }
  const Site& site = subject.mutations.sites[candidate.site];
  if (subject.alone.contains(candidate.site) || subject.kept.contains(site.constant)) {
    candidate.fate = decide_alone(subject, candidate, tests, job, candidate.detail);
  } else {
    const Verdict verdict = TestRun(subject.folder, options_.work / ("job." + std::to_string(job)))(
        tests, candidate.number);
    candidate.fate = verdict.killed ? Fate::kKilled : Fate::kSurvived;
    candidate.detail = verdict.by;
  }
  const std::scoped_lock lock(mutex_);
  std::string key = candidate.fate == Fate::kSurvived ? key_of(tests) : "-";
  if (candidate.fate == Fate::kSurvived && tests.empty()) candidate.detail = "no test reaches it";
  if (candidate.fate == Fate::kKilled) {
    const std::string name = candidate.detail.substr(0, candidate.detail.find(' '));
    ++kills_[name];
    const auto test = test_of_name_.find(name);
    if (test != test_of_name_.end()) key = test->second->file_hash;
  }
  const char* verdict = candidate.fate == Fate::kKilled     ? "killed"
                        : candidate.fate == Fate::kSurvived ? "survived"
                                                            : "invalid";
  std::ofstream(options_.work / "results.txt", std::ios::app)
      << hash(subject.text) << ' ' << candidate.id << ' ' << verdict << ' ' << key << ' '
      << candidate.detail << '\n';
}

void Campaign::run() {
  if (options_.list) return;
  in_parallel(subjects_.size(), options_.jobs,
              [&](std::size_t i, std::size_t) { build_switches(subjects_[i]); });
  find_reach();
  link_all();
  for (Subject& subject : subjects_) {
    std::vector<Candidate*> missing;
    for (Candidate& candidate : subject.candidates) {
      if (candidate.fate == Fate::kUnknown && !recall(subject, candidate))
        missing.push_back(&candidate);
    }
    std::fprintf(stderr, "mutants: %s: %zu of %zu to run\n", subject.target.source.c_str(),
                 missing.size(), subject.candidates.size());
    kills_.clear();
    in_parallel(missing.size(), options_.jobs,
                [&](std::size_t i, std::size_t job) { decide(subject, *missing[i], job); });
  }
}

bool Campaign::report() const {
  if (options_.list) {
    for (const Subject& subject : subjects_) {
      for (const Candidate& candidate : subject.candidates) {
        std::printf("%s:%s\n- %s\n+ %s\n", subject.target.source.c_str(), candidate.id.c_str(),
                    candidate.change.before.c_str(), candidate.change.after.c_str());
      }
    }
    return true;
  }
  bool good = true;
  std::string table;
  for (const Subject& subject : subjects_) {
    std::map<Fate, int> count;
    for (const Candidate& candidate : subject.candidates) {
      ++count[candidate.fate];
      if (candidate.fate != Fate::kSurvived) continue;
      std::printf("%s:%s  %s\n- %s\n+ %s\n\n", subject.target.source.c_str(), candidate.id.c_str(),
                  candidate.detail.c_str(), candidate.change.before.c_str(),
                  candidate.change.after.c_str());
    }
    const int told = count[Fate::kKilled] + count[Fate::kSurvived];
    const double share = told == 0 ? 100.0 : 100.0 * count[Fate::kKilled] / told;
    const bool below = share < subject.target.bound;
    good = good && !below;
    char line[256];
    std::snprintf(
        line, sizeof(line), "%-44s %5zu%s %6d %8d %10d %7d %6.1f %% %5.0f %%%s\n",
        subject.target.source.c_str(), subject.candidates.size(),
        subject.candidates.empty() || subject.candidates.back().number <= subject.candidates.size()
            ? " "
            : "*",
        count[Fate::kKilled], count[Fate::kSurvived], count[Fate::kEquivalent],
        count[Fate::kInvalid], share, subject.target.bound, below ? "  below" : "");
    table += line;
  }
  std::printf("%-44s %6s %6s %8s %10s %7s %8s %7s\n%s", "file", "mutants", "killed", "survived",
              "equivalent", "invalid", "killed", "bound", table.c_str());
  if (table.find('*') != std::string::npos) std::printf("* a sample, seed %u\n", options_.seed);
  const auto time =
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - begin_);
  std::printf("%zu sources in %ld min %ld s\n", subjects_.size(),
              static_cast<long>(time.count() / 60), static_cast<long>(time.count() % 60));
  return good;
}

}  // namespace screed::mutants
