// Slurm's programs, by their output.
#include "tools/screed/campaign/slurm.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"

namespace screed::slurm {
namespace {

/// Of both standard output and standard error, without line feeds at the end.
ShellOutput run(const std::string& command) {
  ShellOutput output = shell_output(command + " 2>&1");
  while (output.text.ends_with('\n')) output.text.pop_back();
  return output;
}

/// The first line, for messages.
std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

}  // namespace

int max_array_size() {
  const ShellOutput output = run("scontrol show config");
  if (output.exit_code != 0) throw RunError("Slurm does not answer: " + first_line(output.text));
  std::istringstream lines(output.text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("MaxArraySize", 0) != 0) continue;
    return std::atoi(line.substr(line.find('=') + 1).c_str());
  }
  throw RunError("Slurm does not say MaxArraySize");
}

std::string submit(const std::string& script) {
  const ShellOutput output = run("sbatch --parsable " + quoted(script));
  if (output.exit_code != 0) throw RunError("sbatch: " + first_line(output.text));
  return output.text.substr(0, output.text.find(';'));  // "12", or "12;cluster"
}

int active_tasks(const std::string& job) {
  const ShellOutput output = run("squeue --noheader --array --format=%i --jobs=" + quoted(job));
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
