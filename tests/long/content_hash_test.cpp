// Runs whose content is known to the bit: whatever changes one of these hashes changes what the
// simulation computes. A change that means to does so in a commit of its own, with the new hash.
// Long: a change in the physics shows in the hash of a whole run only.
#include <array>
#include <string>

#include "host_sim/core/json.h"
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
    {"soft_bed", "--duration 6", "ca6cc6e6aff80474a4a917cd19620a9b"},
    {"soft_bed", "--hal surrogate --duration 10", "165c9b6cbff069f6905364163a94cfae"},
    {"soft_bed",
     "--set experiment.algorithm=spin_on_peak --set soil.preset=lete_sand "
     "--set soil.drag_depth=0.002 --duration 4",
     "5cf5b8290c08b01b7420f05de835b2c2"},
    {"gravel_bed", "--duration 1", "1bd120185594137da9caf4893e8d0bbd"},
}};

class ContentHash : public Program {};

TEST_F(ContentHash, OfKnownRunsIsTheSame) {
  for (const KnownRun& known : kKnownRuns) {
    const Result result = run("sim '" + std::string(kDataFolder) + "/experiments/" + known.name +
                              ".ini' " + known.arguments + " --out run --quiet --no-pictures");
    ASSERT_EQ(result.exit_code, 0) << known.name << ": " << result.err;
    const auto summary = Json::parse(read(root_ / "run" / "summary.json"));
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
  EXPECT_EQ(Json::parse(result.out)["heights_hash"].get<std::string>(),
            "2af6c25eb145905ad11c001f5fbe1582");
}

}  // namespace
}  // namespace screed::testing
