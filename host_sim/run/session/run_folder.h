// The folder of one run: it appears under its name only when the run is complete, and nothing saved
// is ever overwritten.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host_sim/run/session/session_reader.h"

namespace screed {

/// The session of a run that a user names by its folder or by the file itself; of several robots
/// that of the first one.
std::filesystem::path session_file(const std::filesystem::path& run);

/// Where a run in `folder` keeps its robot of that number: the first one, 0, in the folder itself,
/// the others in robot_1, robot_2 and so on below it.
std::filesystem::path folder_of_robot(const std::filesystem::path& folder, std::size_t robot);

/// The sessions of all robots of a run that a user names by its folder, in their order, the first
/// one whether it is there or not; of a run named by a session file that one.
std::vector<std::filesystem::path> session_files(const std::filesystem::path& run);

/// Whether the folder belongs to a run that is being recorded now.
bool is_running(const std::filesystem::path& partial);

/// While a run goes on its folder is `<name>.partial`. commit() gives it its name; without commit()
/// the destructor removes it. A `.partial` of another run, interrupted or still going on, is never
/// touched.
class RunFolder {
 public:
  /// A folder named by the user: must not exist yet, or be empty. Missing parents are created.
  /// Throws InputError when the name is taken, its `.partial` is left over, or a parent is no
  /// folder; RunError when the folder cannot be created.
  static RunFolder at(const std::filesystem::path& out);

  /// `<root>/<experiment>-NNNN` with the lowest number, from 0001, that neither a run nor a
  /// `.partial` has. Throws InputError for a name that is no file name, otherwise as at().
  static RunFolder numbered(const std::filesystem::path& root, const std::string& experiment);

  RunFolder(RunFolder&& other) noexcept;
  RunFolder& operator=(RunFolder&& other) = delete;
  ~RunFolder();

  /// Where to write now.
  const std::filesystem::path& path() const { return partial_; }
  /// Where the run will stand after commit().
  const std::filesystem::path& final_path() const { return final_; }
  /// Folders of interrupted runs that numbered() passed over, for a note to the user.
  const std::vector<std::filesystem::path>& leftovers() const { return leftovers_; }

  /// Renames the folder to final_path(). Throws RunError when that fails; the folder then stays as
  /// path().
  void commit();

 private:
  RunFolder() = default;
  void create_parents();
  /// False when the partial folder exists already.
  bool create_partial();

  std::filesystem::path final_;
  std::filesystem::path partial_;
  std::vector<std::filesystem::path> leftovers_;
  std::vector<std::filesystem::path>
      created_parents_;  ///< outermost first; removed again when the run fails
  bool owns_partial_ = false;
};

// The sessions of a run with several robots, opened together.

/// Of the robots of a run as session_files() lists them, at least one. Beside a flash image, which
/// is the first, robots may have made a tick or two more than it: a row of the first one's is then
/// up to 10 ms later than theirs. Throws InputError as SessionReader does, and when they have not
/// the same ticks otherwise, which happens in a run that was killed.
std::vector<SessionReader> open_robots(const std::filesystem::path& run);

/// The content hash of a run, as its summary has it, or why there is none.
std::string hash_of_run(std::span<const SessionReader> sessions);

}  // namespace screed
