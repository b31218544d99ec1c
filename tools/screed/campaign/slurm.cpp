// Slurm's programs, by their output.
#include "tools/screed/campaign/slurm.h"

#include <sys/wait.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "host_sim/core/errors.h"

namespace screed::slurm {
namespace {

struct Output {
  int exit_code = -1;
  std::string text;  ///< of both standard output and standard error
};

Output run(const std::string& command) {
  Output output;
  FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  for (size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    output.text.append(buffer.data(), count);
  const int status = pclose(pipe);
  output.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  while (output.text.ends_with('\n')) output.text.pop_back();
  return output;
}

/// The first line, for messages.
std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

int max_array_size() {
  const Output output = run("scontrol show config");
  if (output.exit_code != 0) throw RunError("Slurm does not answer: " + first_line(output.text));
  std::istringstream lines(output.text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("MaxArraySize", 0) != 0) continue;
    return std::atoi(line.substr(line.find('=') + 1).c_str());
  }
  throw RunError("Slurm does not say MaxArraySize");
}

std::string submit(const std::string& script) {
  const Output output = run("sbatch --parsable " + quoted(script));
  if (output.exit_code != 0) throw RunError("sbatch: " + first_line(output.text));
  return output.text.substr(0, output.text.find(';'));  // "12", or "12;cluster"
}

int active_tasks(const std::string& job) {
  const Output output = run("squeue --noheader --array --format=%i --jobs=" + quoted(job));
  if (output.exit_code == 0) {
    int tasks = 0;
    std::istringstream lines(output.text);
    for (std::string line; std::getline(lines, line);) ++tasks;
    return tasks;
  }
  // Slurm forgets jobs some minutes after their end.
  if (output.text.find("Invalid job id") != std::string::npos) return 0;
  throw RunError("Slurm does not answer: " + first_line(output.text));
}

std::string time_text(double seconds) {
  const auto minutes = static_cast<long>(std::ceil(seconds / 60.0));
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%ld-%02ld:%02ld:00", minutes / 1440, minutes / 60 % 24,
                minutes % 60);
  return text.data();
}

std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace screed::slurm
