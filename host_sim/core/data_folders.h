// Where the program's data lies: experiments, terrains and soils, boards, models, images for the
// microcontroller, the page of reports.
#pragma once

#include <filesystem>
#include <string>

namespace screed {

struct DataFolders {
  std::filesystem::path data;      ///< experiments, terrain, soil
  std::filesystem::path boards;    ///< a folder a board
  std::filesystem::path models;    ///< networks
  std::filesystem::path firmware;  ///< a folder a board, with screed.elf
  std::filesystem::path report;    ///< page.html, into which `screed report` writes a run
};

/// The first of
///   the folder `chosen`, if it is not empty: the user's, in the environment variable SCREED_DATA;
///   ../share/screed or ../../share/screed from the folder of `program`, which may be a library: an
///   installed tree, wherever it was moved to;
///   the folders of the sources that the program was built from.
/// Throws InputError when `chosen` does not hold experiments and boards, or when none is there.
DataFolders find_data_folders(const std::string& chosen, const std::filesystem::path& program);

/// Those of this program, looked for once.
const DataFolders& data_folders();

}  // namespace screed
