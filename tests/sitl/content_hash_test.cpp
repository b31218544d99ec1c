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
    {"first_drive", "--duration 60", "6bc3c3a57a401eac108d267b19f14690"},
    {"soft_bed", "--duration 6", "53f7d985448ea3357b62d43fdc35f025"},
    {"soft_bed", "--hal surrogate --duration 10", "a2ef2e8b9f8eb0152024ff95c3f20d35"},
    {"soft_bed",
     "--set experiment.algorithm=spin_on_peak --set soil.preset=lete_sand "
     "--set soil.drag_depth=0.002 --duration 4",
     "96f0655c44e239274bb90f8b911f291b"},
    {"gravel_bed", "--duration 1", "1bd120185594137da9caf4893e8d0bbd"},
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
            "92a218b48db7f1fddead31b9e9cfff89");
}

}  // namespace
}  // namespace screed::testing
