// Runs whose content is known to the bit: whatever changes one of these hashes changes what the
// simulation computes. A change that means to does so in a commit of its own, with the new hash.
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "paths.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

struct KnownRun {
  const char* name;       // of the experiment
  const char* arguments;  // beside it
  const char* hash;       // content_hash of the run's summary
};

constexpr std::array<KnownRun, 5> kKnownRuns = {{
    {"first_drive", "--duration 60", "8304d388067597b6411be4d622b5555a"},
    {"soft_bed", "--duration 6", "0bc97d0e0f77b57e06ca5e9512d57a1d"},
    {"soft_bed", "--hal surrogate --duration 10", "a4ad9637f5ac205aa52f9f61d6be4873"},
    {"soft_bed",
     "--set experiment.algorithm=spin_on_peak --set soil.preset=lete_sand "
     "--set soil.drag_depth=0.002 --duration 4",
     "3b5379fb9ebd8c555b68dbf7555374f1"},
    {"gravel_bed", "--duration 1", "66730c0a2052d1e71810b08cb5b1fd78"},
}};

class ContentHash : public Program {};

TEST_F(ContentHash, OfKnownRunsIsTheSame) {
  for (const KnownRun& known : kKnownRuns) {
    const Result result = run("sim '" + std::string(kDataFolder) + "/experiments/" + known.name +
                              ".ini' " + known.arguments + " --out run --quiet");
    ASSERT_EQ(result.exit_code, 0) << known.name << ": " << result.err;
    const auto summary = nlohmann::json::parse(read(root_ / "run" / "summary.json"));
    EXPECT_EQ(summary["content_hash"].get<std::string>(), known.hash)
        << known.name << " " << known.arguments;
    std::filesystem::remove_all(root_ / "run");
  }
}

TEST_F(ContentHash, OfABedUnderTheRobotIsTheSame) {
  const Result result = run(
      "soil robot --json --bulldozing --avalanches --wrap --relief 0.02 --size 1.5 --duration 1 "
      "--left 0.1 --right 0.2 --drag-depth 0.001");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["heights_hash"].get<std::string>(),
            "73e3ee97e1fb910b7c6d473f39a64092");
}

}  // namespace
}  // namespace screed::testing
