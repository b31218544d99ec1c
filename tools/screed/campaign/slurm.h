// Slurm's programs: sbatch, squeue, scontrol.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace screed::slurm {

/// Most tasks of a job array: what the cluster allows. Throws RunError when Slurm does not answer.
int max_array_size();

/// Submits a script. Returns the job's number. Throws RunError with Slurm's own words.
std::string submit(const std::string& script);

/// Tasks of a job that wait or run; 0 of a job that Slurm does not know any more. Throws RunError
/// when Slurm does not answer.
int active_tasks(const std::string& job);

/// Wall time as Slurm takes it, "1-02:30:00", whole minutes from at least this many seconds.
std::string time_text(double seconds);

/// The text of one word for a shell.
std::string quoted(const std::string& word);

}  // namespace screed::slurm
