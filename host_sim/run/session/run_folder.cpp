// Creating, committing and giving up the folder of a run.
#include "host_sim/run/session/run_folder.h"

#include <string>
#include <system_error>
#include <utility>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_turns.h"

namespace screed {

namespace {

namespace fs = std::filesystem;

fs::path partial_of(fs::path path) {
  return path += ".partial";
}

bool is_taken(const fs::path& path) {
  std::error_code error;
  return fs::exists(fs::symlink_status(path, error));
}

[[noreturn]] void cannot_create(const fs::path& path, const std::error_code& error) {
  const std::string text = path.string() + ": cannot create the folder: " + error.message();
  const bool name_is_wrong = error == std::errc::not_a_directory ||
                             error == std::errc::filename_too_long ||
                             error == std::errc::invalid_argument;
  if (name_is_wrong) throw InputError(text);
  throw RunError(text);
}

}  // namespace

fs::path session_file(const fs::path& run) {
  std::error_code error;
  return fs::is_directory(run, error) ? run / "session.h5" : run;
}

fs::path folder_of_robot(const fs::path& folder, std::size_t robot) {
  return robot == 0 ? folder : folder / ("robot_" + std::to_string(robot));
}

std::vector<fs::path> session_files(const fs::path& run) {
  std::vector<fs::path> files = {session_file(run)};
  if (files.front() == run) return files;
  for (std::size_t robot = 1;; ++robot) {
    fs::path further = folder_of_robot(run, robot) / "session.h5";
    if (!is_taken(further)) return files;
    files.push_back(std::move(further));
  }
}

bool is_running(const fs::path& partial) {
  return is_being_written(partial / "session.h5");
}

RunFolder::RunFolder(RunFolder&& other) noexcept
    : final_(std::move(other.final_)),
      partial_(std::move(other.partial_)),
      leftovers_(std::move(other.leftovers_)),
      created_parents_(std::move(other.created_parents_)),
      owns_partial_(std::exchange(other.owns_partial_, false)) {
  other.created_parents_.clear();
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  if (owns_partial_) fs::remove_all(partial_, ignored);
  // Not recursive: a parent that is in use by now stays.
  for (auto parent = created_parents_.rbegin(); parent != created_parents_.rend(); ++parent) {
    fs::remove(*parent, ignored);
  }
}

void RunFolder::create_parents() {
  std::vector<fs::path> missing;
  fs::path parent = final_.parent_path();
  while (!parent.empty() && !is_taken(parent)) {
    missing.push_back(parent);
    parent = parent.parent_path();
  }
  std::error_code error;
  if (!parent.empty() && !fs::is_directory(parent, error)) {
    throw InputError(final_.string() + ": cannot create the folder: " + parent.string() +
                     " is not a folder");
  }
  for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
    if (fs::create_directory(*path, error)) {
      created_parents_.push_back(*path);
    } else if (error) {
      cannot_create(*path, error);
    }
  }
}

bool RunFolder::create_partial() {
  std::error_code error;
  owns_partial_ = fs::create_directory(partial_, error);
  if (error && error != std::errc::file_exists) cannot_create(partial_, error);
  return owns_partial_;
}

RunFolder RunFolder::at(const fs::path& out) {
  if (out.empty()) throw InputError("the name of the output folder is empty");
  RunFolder folder;
  std::error_code error;
  // Through symbolic links and "..", so that the sibling `.partial` is on the same disk and in the
  // right place.
  folder.final_ = fs::weakly_canonical(out, error);
  if (error) cannot_create(out, error);
  if (!folder.final_.has_filename()) folder.final_ = folder.final_.parent_path();
  if (!folder.final_.has_filename()) {
    throw InputError(out.string() + ": is not the name of a new folder");
  }
  // Keep what the user typed where it means the same: messages then name what was asked for.
  if (const fs::path typed = out.has_filename() ? out : out.parent_path();
      typed.filename() == folder.final_.filename() && !fs::is_symlink(typed, error)) {
    folder.final_ = typed;
  }
  folder.partial_ = partial_of(folder.final_);

  if (is_taken(folder.final_)) {
    if (!fs::is_directory(folder.final_, error)) {
      throw InputError(folder.final_.string() +
                       ": exists and is not a folder; name a new or an empty folder");
    }
    if (!fs::is_empty(folder.final_, error) && !error) {
      throw InputError(folder.final_.string() +
                       ": the folder is not empty; name a new or an empty one");
    }
    if (error) cannot_create(folder.final_, error);
  }
  folder.create_parents();
  if (!folder.create_partial()) {
    throw InputError(
        folder.partial_.string() +
        (is_running(folder.partial_)
             ? ": a run is being recorded there; wait for its end or name another folder"
             : ": left over from an unfinished run; remove it or name "
               "another folder"));
  }
  return folder;
}

RunFolder RunFolder::numbered(const fs::path& root, const std::string& experiment) {
  if (experiment.empty() || experiment == "." || experiment == ".." ||
      experiment.find('/') != std::string::npos || experiment.find('\0') != std::string::npos) {
    throw InputError("experiment name '" + experiment + "' cannot name an output folder");
  }
  RunFolder folder;
  for (unsigned number = 1;; ++number) {
    std::string digits = std::to_string(number);
    if (digits.size() < 4) digits.insert(0, 4 - digits.size(), '0');
    folder.final_ = root / experiment;
    folder.final_ += '-' + digits;
    folder.partial_ = partial_of(folder.final_);
    if (is_taken(folder.partial_)) {
      if (!is_running(folder.partial_)) folder.leftovers_.push_back(folder.partial_);
      continue;
    }
    if (is_taken(folder.final_)) continue;
    folder.create_parents();
    if (!folder.create_partial()) continue;
    // Another program may have completed the run of this number between the two questions.
    if (!is_taken(folder.final_)) return folder;
    std::error_code ignored;
    fs::remove(folder.partial_, ignored);
    folder.owns_partial_ = false;
  }
}

void RunFolder::commit() {
  // Whatever happens now, the run is complete and worth keeping.
  owns_partial_ = false;
  created_parents_.clear();
  std::error_code error;
  fs::rename(partial_, final_, error);
  if (error) {
    throw RunError(final_.string() + ": cannot name the run: " + error.message() +
                   "; it is kept as " + partial_.string());
  }
}

// Opening and comparing their lengths.

namespace {

/// A flash image needs some milliseconds to start: the native robots beside it make a tick or two
/// more.
bool may_belong_together(const SessionReader& first, const SessionReader& further) {
  if (first.frames() == further.frames()) return true;
  return first.complete() && further.complete() && first.frames() < further.frames();
}

}  // namespace

std::vector<SessionReader> open_robots(const std::filesystem::path& run) {
  const std::vector<std::filesystem::path> files = session_files(run);
  std::vector<SessionReader> sessions(files.begin(), files.end());
  for (std::size_t i = 1; i < sessions.size(); ++i) {
    if (may_belong_together(sessions[0], sessions[i])) continue;
    throw InputError(files[i].string() + " has " + std::to_string(sessions[i].frames()) +
                     " frames, " + files[0].string() + " " + std::to_string(sessions[0].frames()) +
                     "; name the session.h5 of one robot instead of the folder");
  }
  return sessions;
}

std::string hash_of_run(std::span<const SessionReader> sessions) {
  std::vector<std::string> hashes;
  for (const SessionReader& session : sessions) {
    if (session.running()) return "none: the run goes on";
    if (!session.complete()) return "none: the run did not end";
    hashes.push_back(session.content_hash());
  }
  return combined_hash(hashes);
}

}  // namespace screed
