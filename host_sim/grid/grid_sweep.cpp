// Sweeps: a pool of threads over independent runs, and the file that remembers them.
#include "host_sim/grid/grid_sweep.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr const char* kColumns =
    "point,run,seed,level,cycles,units,least_units,straight_steps,diagonal_steps";

/// Equal for sweeps whose runs may stand in one file; the number of runs may grow.
std::string first_lines(const std::vector<SweepPoint>& points) {
  ContentHash hash;
  for (const SweepPoint& point : points) {
    hash.add(point.label);
    for (const auto& [name, value] : describe(point.config)) {
      hash.add(name);
      hash.add(value);
    }
  }
  return "# screed grid sweep " + hash.hex() + "\n" + kColumns + "\n";
}

constexpr size_t kMaxRuns = 10'000'000;

struct Task {
  size_t point;
  size_t run;
};

std::string line_of(const std::vector<SweepPoint>& points, const Task& task,
                    const GridResult& result) {
  std::ostringstream line;
  line << task.point << ',' << task.run << ',' << points[task.point].config.seed + task.run << ','
       << (result.level ? 1 : 0) << ',' << result.cycles << ',' << result.units << ','
       << result.min_units << ',' << result.straight << ',' << result.diagonal << '\n';
  return line.str();
}

/// A whole line of the file, or nothing.
std::optional<std::pair<Task, GridResult>> parse(const std::string& line) {
  unsigned long long v[9];
  int end = 0;
  if (std::sscanf(line.c_str(), "%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu,%llu%n", &v[0], &v[1],
                  &v[2], &v[3], &v[4], &v[5], &v[6], &v[7], &v[8], &end) != 9 ||
      static_cast<size_t>(end) != line.size()) {
    return std::nullopt;
  }
  return std::pair{Task{v[0], v[1]}, GridResult{v[3] != 0, v[4], v[5], v[6], v[7], v[8]}};
}

/// The results file: appended to while the sweep goes on, locked against a second one.
class ResultsFile {
 public:
  ResultsFile(const std::filesystem::path& path, const std::vector<SweepPoint>& points)
      : path_(path), points_(points), head_(first_lines(points)) {
    descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail("cannot be opened");
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      close(descriptor_);
      throw InputError(path_.string() + ": another sweep is writing to it");
    }
  }
  ResultsFile(const ResultsFile&) = delete;
  ResultsFile& operator=(const ResultsFile&) = delete;
  ~ResultsFile() { close(descriptor_); }

  /// The runs that are there; cuts off a line that was not finished.
  std::vector<std::pair<Task, GridResult>> read() {
    std::ifstream file(path_, std::ios::binary);
    std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const size_t whole = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
    text.resize(whole);
    std::vector<std::pair<Task, GridResult>> found;
    // A file that ends within its own first lines is one whose sweep was stopped at once.
    if (whole < head_.size() && head_.compare(0, whole, text) == 0) {
      restart();
      return found;
    }
    if (text.compare(0, head_.size(), head_) != 0) {
      throw InputError(path_.string() +
                       ": holds the runs of another sweep; name another folder or remove the file");
    }
    std::istringstream lines(text.substr(head_.size()));
    size_t number = 2;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      const auto entry = parse(line);
      if (!entry || entry->first.point >= points_.size() || entry->first.run > kMaxRuns) {
        throw InputError(path_.string() + ", line " + std::to_string(number) +
                         ": not a run of this sweep: " + line);
      }
      found.push_back(*entry);
    }
    if (ftruncate(descriptor_, static_cast<off_t>(whole)) != 0) fail("cannot be cut");
    seek_end();
    return found;
  }

  void append(const Task& task, const GridResult& result) {
    write_all(line_of(points_, task, result));
  }

  /// Rewrites the file in order; complete or not at all.
  void sort(const std::vector<std::vector<std::optional<GridResult>>>& results) const {
    std::string text = head_;
    for (size_t point = 0; point < results.size(); ++point) {
      for (size_t run = 0; run < results[point].size(); ++run) {
        if (results[point][run]) text += line_of(points_, {point, run}, *results[point][run]);
      }
    }
    write_file(path_, text);
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw RunError(path_.string() + ": " + what + ": " + std::strerror(errno));
  }
  void seek_end() const {
    if (lseek(descriptor_, 0, SEEK_END) < 0) fail("cannot be appended to");
  }
  void restart() const {
    if (ftruncate(descriptor_, 0) != 0) fail("cannot be cut");
    seek_end();
    write_all(head_);
  }
  void write_all(const std::string& text) const {
    const ssize_t written = write(descriptor_, text.data(), text.size());
    if (written < 0 || static_cast<size_t>(written) != text.size()) fail("cannot be written");
  }

  std::filesystem::path path_;
  const std::vector<SweepPoint>& points_;
  std::string head_;
  int descriptor_ = -1;
};

}  // namespace

SweepResult run_sweep(const std::vector<SweepPoint>& points, const SweepOptions& options) {
  if (options.runs < 1 || options.runs > static_cast<int>(kMaxRuns)) {
    throw InputError("grid: runs = " + std::to_string(options.runs) + "; allowed is 1 to " +
                     std::to_string(kMaxRuns));
  }
  if (options.threads < 0 || options.threads > 1024) {
    throw InputError("grid: threads = " + std::to_string(options.threads) +
                     "; allowed is 0 (all cores) to 1024");
  }
  for (const SweepPoint& point : points) check(point.config);

  const auto runs = static_cast<size_t>(options.runs);
  // More runs than asked for may stand in the file; they stay there.
  std::vector<std::vector<std::optional<GridResult>>> results(
      points.size(), std::vector<std::optional<GridResult>>(runs));
  SweepResult sweep;
  std::optional<ResultsFile> file;
  if (!options.results.empty()) {
    file.emplace(options.results, points);
    for (const auto& [task, result] : file->read()) {
      auto& of_point = results[task.point];
      if (task.run >= of_point.size()) of_point.resize(task.run + 1);
      if (task.run < runs && !of_point[task.run]) ++sweep.resumed;
      of_point[task.run] = result;
    }
  }

  std::vector<Task> tasks;
  for (size_t run = 0; run < runs; ++run) {
    for (size_t point = 0; point < points.size(); ++point) {
      if (!results[point][run]) tasks.push_back({point, run});
    }
  }
  const size_t all = points.size() * runs;
  size_t done = all - tasks.size();
  std::atomic<size_t> next = 0;
  std::atomic<bool> failed = false;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto stopped = [&] { return failed || (options.stop != nullptr && *options.stop); };
  const auto work = [&] {
    try {
      for (size_t i = next++; i < tasks.size() && !stopped(); i = next++) {
        const Task task = tasks[i];
        GridConfig config = points[task.point].config;
        config.seed += task.run;
        GridRun run(config);
        while (!run.finished()) {
          run.cycle();
          if (run.cycles() % 1024 == 0 && stopped()) return;
        }
        const GridResult result = run.result();
        const std::scoped_lock lock(mutex);
        results[task.point][task.run] = result;
        if (file) file->append(task, result);
        ++done;
        if (options.progress) options.progress(done, all);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
      failed = true;
    }
  };

  size_t threads = options.threads > 0 ? static_cast<size_t>(options.threads)
                                       : std::max(1U, std::thread::hardware_concurrency());
  threads = std::min(threads, std::max<size_t>(1, tasks.size()));
  std::vector<std::jthread> pool;
  for (size_t i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  pool.clear();  // joins
  if (failure) std::rethrow_exception(failure);

  sweep.complete = done == all;
  if (sweep.complete && file) file->sort(results);
  for (const auto& of_point : results) {
    auto& kept = sweep.results.emplace_back();
    for (size_t run = 0; run < runs; ++run) {
      if (of_point[run]) kept.push_back(*of_point[run]);
    }
  }
  return sweep;
}

Summary summarise(const std::vector<double>& values) {
  Summary summary;
  if (values.empty()) return summary;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) summary.mean += value / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  if (values.size() > 1) summary.standard_error = std::sqrt(squares / (n - 1.0) / n);
  const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
  summary.minimum = *minimum;
  summary.maximum = *maximum;
  return summary;
}

}  // namespace screed
