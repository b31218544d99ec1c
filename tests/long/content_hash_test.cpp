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
    {"first_drive", "--duration 60", "c7ef0c7892589ffade2ded7cbe9c4b99"},
    {"soft_bed", "--duration 6", "f5d09e0aca52a25580de863664447acd"},
    {"soft_bed", "--hal surrogate --duration 10", "c31c79a082cb1325547add4abd2c8da3"},
    {"soft_bed",
     "--set experiment.algorithm=spin_on_peak --set soil.preset=lete_sand "
     "--set soil.slip_layer=0.002 --duration 4",
     "585ec25b921a4615534278c44b8e4a87"},
    {"gravel_bed", "--duration 1", "2a78c29690839566150bbf61f3e03301"},
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
      "--left 0.1 --right 0.2 --slip-layer 0.001");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["heights_hash"].get<std::string>(),
            "262bdf98a5fa2ad9e7cbaf57f72cd55c");
}

}  // namespace
}  // namespace screed::testing
