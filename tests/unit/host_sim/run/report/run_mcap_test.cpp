// A run as MCAP, whatever its rows hold. What readers find in the file:
// tests/report/mcap_tests.mjs.
#include "host_sim/run/report/run_mcap.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <cstring>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/file_size_limit.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

constexpr const char* kMagic = "\x89MCAP0\r\n";

std::string exported(const fs::path& session, const fs::path& mcap,
                     const RunMcapOptions& options = {}) {
  std::vector<SessionReader> sessions;
  sessions.emplace_back(session);
  export_mcap(sessions, mcap, options);
  return read_text(mcap);
}

/// On ground in the program's units.
Recording run_of(std::size_t ticks) {
  Recording run = random_run(ticks);
  for (HeightMap* map : {&run.before, &run.after}) {
    map->geometry.unit_m = kHeightUnit_m;
    map->heights[3] = 4000;
    map->heights[4] = -4000;
  }
  return run;
}

/// The first chunk's records.
std::string first_chunk(const std::string& file) {
  std::size_t at = 8;
  while (file[at] != 6) {
    std::uint64_t size = 0;
    std::memcpy(&size, &file[at + 1], sizeof size);
    at += 9 + size;
  }
  std::uint64_t size = 0;
  std::uint64_t packed = 0;
  std::memcpy(&size, &file[at + 9 + 16], sizeof size);
  std::memcpy(&packed, &file[at + 9 + 36], sizeof packed);
  std::string content(size, '\0');
  EXPECT_EQ(ZSTD_decompress(content.data(), size, &file[at + 9 + 44], packed), size);
  return content;
}

TEST_F(SessionTest, McapHoldsRowsOfAnyBitsAndNoPoseThatIsNone) {
  const Recording run = run_of(300);
  write_run(file_, run);
  const std::string file = exported(file_, base_ / "run.mcap");
  EXPECT_EQ(file.substr(0, 8), kMagic);
  EXPECT_EQ(file.substr(file.size() - 8), kMagic);
  const std::string chunk = first_chunk(file);
  for (const std::size_t row : {std::size_t{0}, std::size_t{299}}) {
    const auto bytes = packed<kFrameBytes>(run.frames[row]);
    EXPECT_NE(chunk.find(std::string(bytes.begin(), bytes.end())), std::string::npos) << row;
  }
  EXPECT_NE(chunk.find("\"child_frame_id\":\"robot_0\""), std::string::npos);
  for (const char* number : {"\"x\":null", "\"x\":nan", "\"z\":null"}) {
    EXPECT_EQ(chunk.find(number), std::string::npos) << number;
  }
  EXPECT_EQ(exported(file_, base_ / "again.mcap"), file);
}

TEST_F(SessionTest, McapOfARunThatWasKilledSaysSo) {
  const Recording run = run_of(2000);
  {
    SessionWriter writer(file_, run.info);
    writer.write_terrain_before(run.before.view());
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    }
  }
  EXPECT_NE(exported(file_, base_ / "run.mcap").find("none: the run did not end"),
            std::string::npos);
}

TEST_F(SessionTest, McapThatCannotBeWrittenLeavesNothing) {
  write_run(file_, run_of(300));
  EXPECT_THROW(exported(file_, base_ / "missing" / "run.mcap"), RunError);
  {
    const FileSizeLimit limit(10000);
    EXPECT_THROW(exported(file_, base_ / "run.mcap"), RunError);
  }
  for (const auto& entry : fs::directory_iterator(base_)) EXPECT_EQ(entry.path(), file_);
}

}  // namespace
}  // namespace screed
