// The worker of a sweep: its runs as tasks that a worker executes (task_worker.h).
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

namespace screed {

struct GridResult;

/// The folder of a sweep: what lies where in it.
struct SweepFolder {
  std::filesystem::path path;

  std::filesystem::path plan() const { return path / "plan.json"; }
  std::filesystem::path results() const { return path / "results"; }
  std::filesystem::path log() const { return path / "workers.log"; }
};

/// The result of a run as JSON text, and back. Throws RunError for what is none.
std::string result_text(const GridResult& result);
GridResult parse_result(const std::string& text);

/// Answers requests until `requests` ends. Throws InputError when the folder has no plan.
void serve_sweep(const SweepFolder& folder, const std::string& program_version,
                 std::istream& requests, const std::function<void(const std::string&)>& answer);

}  // namespace screed
