// The folder in which tasks are executed, its plan, and what the engine asks the machine.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "host_sim/core/json.h"

namespace screed {

/// The folder of a campaign or of a sweep of the grid world: what lies where in it.
struct TaskFolder {
  std::filesystem::path path;

  std::filesystem::path plan() const { return path / "plan.json"; }
  std::filesystem::path results() const { return path / "results"; }
  std::filesystem::path log() const { return path / "workers.log"; }
  // Of campaigns only.
  /// Run folders by identity, where whole sessions are kept.
  std::filesystem::path runs() const { return path / "runs"; }
  std::filesystem::path trial() const { return path / "trial.json"; }
  /// A folder for each job array: its shards, script, number and logs.
  std::filesystem::path slurm() const { return path / "slurm"; }
};

/// What a plan's file says of itself.
struct PlanFormat {
  const char* format;
  int version;
  const char* what;  ///< whose plan it is, in messages: "campaign"
};
/// Gives the plan in `file` to `take`, whose JsonError means damage. Throws InputError that names
/// `file`.
void read_plan_file(const std::filesystem::path& file, const PlanFormat& format,
                    const std::function<void(const Json&)>& take);

/// Only one process at a time executes the tasks of a folder on one machine.
class FolderLock {
 public:
  /// Makes the folder, and the file `lock` in it. Throws InputError, "FOLDER: `busy`", when another
  /// process has the lock, RunError when the folder cannot be written.
  FolderLock(const std::filesystem::path& folder, const std::string& busy);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  /// The end of the process, however it comes, gives the lock back as well.
  ~FolderLock();

 private:
  int descriptor_ = -1;
};

/// A folder for what is not kept, beside all others' temporary files; gone with its owner.
class ScratchFolder {
 public:
  /// `purpose` is part of the name: letters and -. One of each purpose in a process. Removes those
  /// of the same purpose whose processes of this machine were killed. Makes no folder yet.
  explicit ScratchFolder(const std::string& purpose);
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  /// Removes it with everything in it.
  ~ScratchFolder() { clear(); }

  const std::filesystem::path& path() const { return path_; }
  void clear() const;

 private:
  std::filesystem::path path_;
};

/// The fingerprint of a file, for the identity of what is made from it: of its bytes, 32
/// hexadecimal digits. A file is read once in a process. Throws InputError when it cannot be read.
std::string file_hash(const std::filesystem::path& path);

/// The name of this machine; empty when it has none.
std::string host_name();
/// Time of a processor that this process has used, s.
double processor_s();
/// Most memory that this process had so far, MB.
double peak_memory_mb();

/// Makes a folder with those above it; it may be there. Throws RunError.
void make_folder(const std::filesystem::path& folder);

}  // namespace screed
