// From a request to stored results.
#include "host_sim/engine/task_worker.h"

#include <array>
#include <chrono>
#include <ctime>
#include <istream>
#include <new>
#include <optional>
#include <sstream>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_folder.h"

namespace screed {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kExecuteWord = "run";
constexpr const char* kTrialWord = "trial";
constexpr const char* kKinds[] = {"done", "tried", "stop"};  // as WorkerAnswer::Kind

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// "2026-01-31T12:00:00Z".
std::string time_text(std::time_t time) {
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 32> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

/// In one line; a path in a message need not be UTF-8.
std::string one_line(const Json& json) {
  return json.dump(-1, Json::BadText::kReplace);
}

/// Why a task failed, in words.
std::string reason(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ? "out of memory" : error.what();
}

std::string json_number(double value) {
  return Json(value).dump();
}

class Worker {
 public:
  Worker(TaskExecutor& executor, std::filesystem::path results, Json origin)
      : executor_(executor), results_(std::move(results)) {
    origin["host"] = host_name();
    origin_ = one_line(origin);
    origin_.pop_back();  // the object's end
  }

  WorkerAnswer answer(const std::string& request) {
    const Clock::time_point begin = Clock::now();
    WorkerAnswer answer;
    std::istringstream words(request);
    std::string word;
    words >> word;
    if (word == kTrialWord) {
      answer.kind = WorkerAnswer::Kind::kTried;
      size_t task = 0;
      if (words >> task && known(task, answer)) try_task(task, answer);
    } else {
      try {
        answer.kind = WorkerAnswer::Kind::kDone;
        int attempt = 0;
        words >> attempt;
        for (size_t task = 0; words >> task && known(task, answer);) execute(task, attempt, answer);
      } catch (const RunError& error) {  // the result cannot be stored
        answer.kind = WorkerAnswer::Kind::kStop;
        answer.message = error.what();
      }
    }
    answer.seconds = seconds_since(begin);
    answer.memory_mb = peak_memory_mb();
    return answer;
  }

 private:
  bool known(size_t task, WorkerAnswer& answer) const {
    if (task < executor_.count()) return true;
    answer.kind = WorkerAnswer::Kind::kStop;
    answer.message = "the plan has no run " + std::to_string(task);
    return false;
  }

  void execute(size_t task, int attempt, WorkerAnswer& answer) {
    const std::time_t begun = std::time(nullptr);
    const Clock::time_point begin = Clock::now();
    const double processor_begin_s = processor_s();
    StoredResult stored{executor_.id(task), ResultStatus::kDone, "", ""};
    try {
      stored.result = executor_.execute(task);
    } catch (const std::exception& error) {
      stored.status = ResultStatus::kFailed;
      stored.result = one_line(Json::object({{"error", reason(error)}}));
      answer.failures.emplace_back(task, reason(error));
    }
    stored.provenance = origin_ + ",\"begun\":\"" + time_text(begun) +
                        "\",\"seconds\":" + json_number(seconds_since(begin)) +
                        ",\"processor_seconds\":" + json_number(processor_s() - processor_begin_s) +
                        ",\"attempt\":" + std::to_string(attempt) + "}";
    if (!writer_) writer_.emplace(results_);
    writer_->append(stored);
  }

  void try_task(size_t task, WorkerAnswer& answer) {
    try {
      answer.trial = executor_.attempt(task);
    } catch (const std::exception& error) {
      answer.failures.emplace_back(task, reason(error));
    }
  }

  TaskExecutor& executor_;
  std::filesystem::path results_;
  std::string origin_;  ///< JSON: what is the same of all results, without the object's end
  std::optional<ResultWriter> writer_;  ///< from the first result on
};

}  // namespace

std::string TaskExecutor::attempt(size_t /*task*/) {
  throw RunError("there are no trials of these tasks");
}

std::string execute_request(const std::vector<size_t>& tasks, int attempt) {
  std::string text = std::string(kExecuteWord) + " " + std::to_string(attempt);
  for (const size_t task : tasks) text += " " + std::to_string(task);
  return text;
}

std::string trial_request(size_t task) {
  return std::string(kTrialWord) + " " + std::to_string(task);
}

std::string answer_text(const WorkerAnswer& answer) {
  Json failures = Json::array();
  for (const auto& [task, why] : answer.failures) failures.push_back({task, why});
  return one_line({{"kind", kKinds[static_cast<size_t>(answer.kind)]},
                   {"message", answer.message},
                   {"failures", failures},
                   {"trial", answer.trial},
                   {"seconds", answer.seconds},
                   {"memory_mb", answer.memory_mb}});
}

WorkerAnswer parse_answer(const std::string& text) {
  WorkerAnswer answer;
  try {
    const Json json = Json::parse(text);
    const auto kind = json.at("kind").get<std::string>();
    answer.message = json.at("message").get<std::string>();
    for (const Json& failure : json.at("failures"))
      answer.failures.emplace_back(failure.at(0).get<size_t>(), failure.at(1).text());
    answer.trial = json.at("trial").get<std::string>();
    answer.seconds = json.at("seconds").get<double>();
    answer.memory_mb = json.at("memory_mb").get<double>();
    for (const auto one : {WorkerAnswer::Kind::kDone, WorkerAnswer::Kind::kTried})
      if (kind == kKinds[static_cast<size_t>(one)]) answer.kind = one;
  } catch (const JsonError&) {
    answer = {};
    answer.message = "a worker answered '" + text + "'";
  }
  return answer;
}

void serve_tasks(TaskExecutor& executor, const std::filesystem::path& results, const Json& origin,
                 std::istream& requests, const std::function<void(const std::string&)>& answer) {
  Worker worker(executor, results, origin);
  for (std::string request; std::getline(requests, request);)
    answer(answer_text(worker.answer(request)));
}

}  // namespace screed
