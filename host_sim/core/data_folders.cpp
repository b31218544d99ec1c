// Looking for the data where it was installed or built.
#include "host_sim/core/data_folders.h"

#include <dlfcn.h>

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

/// The program, or the library that this is a part of.
fs::path this_file() {
  static const char kHere = 0;
  Dl_info info{};
  std::error_code error;
  if (dladdr(&kHere, &info) != 0) {
    fs::path file = fs::canonical(info.dli_fname, error);
    if (file.filename().string().find(".so") != std::string::npos) return file;
  }
  return fs::read_symlink("/proc/self/exe", error);
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
  // Libraries of one kind of processor lie a folder deeper.
  const fs::path above = program.parent_path().parent_path().parent_path() / "share" / "screed";
  for (const fs::path& folder : {beside, above}) {
    if (DataFolders folders = installed_in(folder); is_there(folders)) return folders;
  }
  DataFolders built{kDataFolder, kBoardsFolder, kModelsFolder, kFirmwareFolder, kReportFolder};
  if (is_there(built)) return built;
  throw InputError("Screed's data is neither in " + beside.string() + " nor in " +
                   built.data.string() + "; SCREED_DATA=FOLDER says where it is");
}

const DataFolders& data_folders() {
  static const DataFolders folders = [] {
    const char* chosen = std::getenv("SCREED_DATA");
    return find_data_folders(chosen == nullptr ? "" : chosen, this_file());
  }();
  return folders;
}

}  // namespace screed
