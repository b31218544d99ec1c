// Where data is looked for first.
#include "host_sim/core/data_folders.h"

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"
#include "paths.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

class DataFoldersTest : public ::testing::Test {
 protected:
  /// An installed tree.
  fs::path installed(const char* name) const {
    fs::path tree = folder_.path() / name;
    fs::create_directories(tree / "share" / "screed" / "experiments");
    fs::create_directories(tree / "share" / "screed" / "boards");
    return tree;
  }

  TempFolder folder_;
};

TEST_F(DataFoldersTest, AnInstalledProgramsDataStandsBesideIt) {
  const fs::path tree = installed("moved here");
  const DataFolders folders = find_data_folders("", tree / "bin" / "screed");
  EXPECT_EQ(folders.data, tree / "share/screed");
  EXPECT_EQ(folders.boards, tree / "share/screed/boards");
  EXPECT_EQ(folders.models, tree / "share/screed/models");
  EXPECT_EQ(folders.firmware, tree / "share/screed/firmware");
  EXPECT_EQ(folders.report, tree / "share/screed/report");
}

TEST_F(DataFoldersTest, ALibraryOfOneKindOfProcessorLiesAFolderDeeper) {
  const fs::path tree = installed("moved");
  for (const char* folder : {"lib", "lib/x86_64-linux-gnu"})
    EXPECT_EQ(find_data_folders("", tree / folder / "libscreed.so.0").data, tree / "share/screed");
}

TEST_F(DataFoldersTest, ThatOfTheSourcesServesAProgramWhereItWasBuilt) {
  const DataFolders folders = find_data_folders("", "/somewhere/build/release/screed");
  EXPECT_EQ(folders.data, kDataFolder);
  EXPECT_EQ(folders.boards, kBoardsFolder);
  EXPECT_EQ(folders.models, kModelsFolder);
  EXPECT_EQ(folders.firmware, kFirmwareFolder);
  EXPECT_EQ(folders.report, kReportFolder);
}

TEST_F(DataFoldersTest, TheUsersChoiceComesFirst) {
  const fs::path chosen = installed("chosen") / "share/screed";
  const fs::path program = installed("other") / "bin" / "screed";
  EXPECT_EQ(find_data_folders(chosen.string(), program).data, chosen);
}

TEST_F(DataFoldersTest, AChoiceWithoutDataIsRefusedByName) {
  const fs::path program = installed("tree") / "bin" / "screed";
  try {
    find_data_folders(folder_.path().string(), program);
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "SCREED_DATA=" + folder_.path().string() +
                  ": is no folder with Screed's data (experiments, boards, models)");
  }
}

}  // namespace
}  // namespace screed
