// Looking for the data where it was installed or built.
#include "host_sim/core/data_folders.h"

#include <cstdlib>
#include <system_error>

#include "host_sim/core/errors.h"
#include "paths.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// As `make install` lays it out.
DataFolders installed_in(const fs::path& folder) {
  return {folder, folder / "boards", folder / "models", folder / "firmware", folder / "report"};
}

bool is_there(const DataFolders& folders) {
  std::error_code error;
  return fs::is_directory(folders.data / "experiments", error) &&
         fs::is_directory(folders.boards, error);
}

}  // namespace

DataFolders find_data_folders(const std::string& chosen, const fs::path& program) {
  if (!chosen.empty()) {
    DataFolders folders = installed_in(chosen);
    if (!is_there(folders)) {
      throw InputError("SCREED_DATA=" + chosen +
                       ": is no folder with Screed's data (experiments, boards, models)");
    }
    return folders;
  }
  const fs::path beside = program.parent_path().parent_path() / "share" / "screed";
  if (DataFolders folders = installed_in(beside); is_there(folders)) return folders;
  DataFolders built{kDataFolder, kBoardsFolder, kModelsFolder, kFirmwareFolder, kReportFolder};
  if (is_there(built)) return built;
  throw InputError("Screed's data is neither in " + beside.string() + " nor in " +
                   built.data.string() + "; SCREED_DATA=FOLDER says where it is");
}

const DataFolders& data_folders() {
  static const DataFolders folders = [] {
    const char* chosen = std::getenv("SCREED_DATA");
    std::error_code error;
    return find_data_folders(chosen == nullptr ? "" : chosen,
                             fs::read_symlink("/proc/self/exe", error));
  }();
  return folders;
}

}  // namespace screed
