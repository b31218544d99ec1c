// Campaign files and the plans that are made of them: cells, seeds, identities, every complaint.
#include "host_sim/campaign/campaign_plan.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

using Cells = std::vector<std::vector<std::string>>;

constexpr const char* kVersion = "1.0+test";

class Campaign : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(folder_.path() / "base.ini",
               "[vehicle]\nx = 1\n[map]\nmodel = scm\n[experiment]\nname = base\nduration = 5\n");
  }
  std::filesystem::path file() const { return folder_.path() / "study.ini"; }
  /// A campaign of base.ini.
  CampaignFile read(const std::string& text) const {
    write_text(file(), "[campaign]\nexperiment = base.ini\n" + text);
    return read_campaign_file(file());
  }
  CampaignPlan plan(const std::string& text, const std::string& version = kVersion) const {
    return make_plan(read(text), version);
  }
  /// What is said of a campaign with this text, without the folder.
  std::string refusal(const std::string& text) const {
    try {
      plan(text);
    } catch (const InputError& error) {
      std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      const std::string path = folder_.path().string() + "/";
      for (size_t at = what.find(path); at != std::string::npos; at = what.find(path))
        what.erase(at, path.size());
      return what;
    }
    return "";
  }

  const TempFolder folder_;
};

TEST_F(Campaign, WithoutFactorsRunsTheExperimentOnceASeed) {
  const CampaignPlan campaign = plan("seeds = 3..5\n");
  EXPECT_EQ(campaign.settings.name, "study");
  ASSERT_EQ(campaign.run_count(), 3U);
  EXPECT_EQ(campaign.cells, (Cells{{}}));
  for (size_t run = 0; run < 3; ++run) {
    const Experiment experiment = resolve_run(campaign, run).experiment;
    EXPECT_EQ(experiment.experiment.seed, 3 + run);
    EXPECT_EQ(experiment.parameters.random_seed(), 3 + static_cast<int>(run));
    EXPECT_EQ(experiment.experiment.name, "study");
    EXPECT_EQ(experiment.vehicle.x_m, 1.0);
  }
}

TEST_F(Campaign, CombinesGridListAndSamples) {
  const CampaignPlan campaign = plan(
      "seeds = 1, 2\n"
      "[set]\nmap.edges = walls\n"
      "[grid]\nexperiment.algorithm = hill_sensing, spin_on_peak\nvehicle.h = 0, 90\n"
      "[list]\nsoil.preset = gravel, clay, viper\nvehicle.y + vehicle.z = 1, 2, 3\n"
      "[random]\ncount = 2\nseed = 3\nparameters.spin_time = 1000..2000\n");
  ASSERT_EQ(campaign.cells.size(), 2U * 2 * 3 * 2);
  ASSERT_EQ(campaign.run_count(), 48U);
  ASSERT_EQ(campaign.factors.size(), 5U);
  EXPECT_EQ(campaign.factors[3].heading, "vehicle.y + vehicle.z");
  // The first factor changes slowest; a list and the samples change as wholes.
  const std::vector<std::string>& first = campaign.cells.front();
  const std::vector<std::string>& second = campaign.cells[1];
  EXPECT_EQ(first[0], "hill_sensing");
  EXPECT_EQ(first[2], "gravel");
  EXPECT_EQ(second[3], "1");
  EXPECT_NE(first[4], second[4]);
  EXPECT_EQ(campaign.cells[2][2], "clay");
  EXPECT_EQ(campaign.cells[2][3], "2");
  EXPECT_EQ(campaign.cells[2][4], first[4]);
  EXPECT_EQ(campaign.cells[6][1], "90");
  EXPECT_EQ(campaign.cells[12][0], "spin_on_peak");

  const CampaignRun run = resolve_run(campaign, 2 * 2 + 1);  // cell 2, second seed
  EXPECT_EQ(campaign.cell_of(5), 2U);
  EXPECT_EQ(run.experiment.experiment.seed, 2U);
  EXPECT_EQ(run.experiment.soil.preset, "clay");
  EXPECT_EQ(run.experiment.vehicle.y_m, 2.0);
  EXPECT_EQ(run.experiment.vehicle.z_m, 2.0);
  EXPECT_EQ(run.experiment.map.edges, "walls");
  EXPECT_EQ(std::to_string(run.experiment.parameters.spin_time()), first[4]);
}

TEST_F(Campaign, SeedsMayBeTheValuesOfOtherKeys) {
  const CampaignPlan campaign = plan("seeds = 1, 40000\nseed_keys = experiment.seed\n");
  EXPECT_EQ(resolve_run(campaign, 1).experiment.experiment.seed, 40000U);
  EXPECT_EQ(resolve_run(campaign, 1).experiment.parameters.random_seed(), 1);
}

TEST_F(Campaign, AWorldIsAFactor) {
  const CampaignPlan campaign = plan("[grid]\nworld.hal = native, surrogate\n");
  ASSERT_EQ(campaign.run_count(), 2U);
  EXPECT_EQ(resolve_run(campaign, 0).world.hal, "native");
  EXPECT_EQ(resolve_run(campaign, 1).world.hal, "surrogate");
  EXPECT_NE(campaign.ids[0], campaign.ids[1]);
}

TEST_F(Campaign, IdentityIsThatOfTheResolvedExperiment) {
  const CampaignPlan first = plan("seeds = 1..3\n[grid]\nvehicle.h = 0, 90\n");
  EXPECT_EQ(std::set(first.ids.begin(), first.ids.end()).size(), 6U);
  // Neither its place in the campaign, nor the campaign's name, nor how a value is written counts.
  const CampaignPlan other = plan("name = other\nseeds = 3\n[grid]\nvehicle.h = 45, 90.0\n");
  EXPECT_EQ(other.ids[1], first.ids[5]);
  EXPECT_NE(other.ids[0], first.ids[5]);
  EXPECT_NE(plan("seeds = 1..3\n[grid]\nvehicle.h = 0, 90\n", "1.1").ids, first.ids);
  write_text(folder_.path() / "base.ini", "[vehicle]\nx = 2\n[experiment]\nduration = 5\n");
  EXPECT_NE(plan("seeds = 1..3\n[grid]\nvehicle.h = 0, 90\n").ids, first.ids);
}

TEST_F(Campaign, IdentityHasTheContentOfTheHeightMap) {
  const std::filesystem::path shipped =
      std::filesystem::current_path() / "host_sim/data/terrain/jacksboro_fault_dem_16bit.png";
  const std::filesystem::path map = folder_.path() / "bed.png";
  std::filesystem::copy_file(shipped, map);
  const std::string text = "[set]\nmap.filename = bed.png\n";
  const std::vector<std::string> before = plan(text).ids;
  EXPECT_EQ(plan(text).ids, before);
  // Hashes are kept by path within a program, so the changed file gets another name.
  const std::filesystem::path changed = folder_.path() / "other" / "bed.png";
  std::filesystem::create_directory(changed.parent_path());
  write_text(changed, read_text(map) + "x");
  std::filesystem::copy_file(folder_.path() / "base.ini", folder_.path() / "other" / "base.ini");
  write_text(folder_.path() / "other" / "study.ini", "[campaign]\nexperiment = base.ini\n" + text);
  const CampaignPlan other =
      make_plan(read_campaign_file(folder_.path() / "other" / "study.ini"), kVersion);
  EXPECT_NE(other.ids, before);
}

TEST_F(Campaign, PlansAreWrittenAndReadBack) {
  const CampaignPlan written = plan(
      "name = all\nseeds = 1..2\nkeep = curves\ntime_limit = 7.5\nretries = 3\nmemory = 200\n"
      "shard = 20\n[set]\nmap.edges = walls\n[grid]\nvehicle.x + vehicle.y = 1, 2\n");
  const std::filesystem::path plan_file = folder_.path() / "plan.json";
  write_text(plan_file, plan_text(written));
  const CampaignPlan read_back = read_plan(plan_file);
  EXPECT_EQ(plan_text(read_back), plan_text(written));
  EXPECT_EQ(read_back.settings.keep, CampaignKeep::kCurves);
  EXPECT_EQ(read_back.settings.time_limit_s, 7.5);
  for (size_t run = 0; run < written.run_count(); ++run)
    EXPECT_EQ(identity_of(resolve_run(read_back, run), kVersion), written.ids[run]);
}

TEST_F(Campaign, RefusesADamagedPlan) {
  const std::filesystem::path plan_file = folder_.path() / "plan.json";
  const std::string text = plan_text(plan("seeds = 1..2\n"));
  for (const std::string& damaged :
       {text.substr(0, text.size() / 2), std::string("{}"), std::string(""),
        text.substr(0, text.find("\"ids\"")) + "\"ids\": []}"}) {
    write_text(plan_file, damaged);
    EXPECT_THROW(read_plan(plan_file), InputError) << damaged;
  }
  EXPECT_THROW(read_plan(folder_.path() / "gone.json"), InputError);
}

TEST_F(Campaign, RefusesInOneLine) {
  struct Case {
    const char* text;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"seed = 1\n", {"study.ini:3: unknown key 'seed' in [campaign]", "seeds"}},
      {"seeds = 5..1\n", {"study.ini:3: [campaign] seeds = '5..1'", "1..30"}},
      {"keep = all\n", {"study.ini:3: [campaign] keep = 'all'", "summary, curves or session"}},
      {"time_limit = 0\n", {"[campaign] time_limit = '0'", "0.1..1e7 (s)"}},
      {"retries = -1\n", {"[campaign] retries", "0..100"}},
      {"name = a b\n", {"[campaign] name", "letters"}},
      {"seed_keys = seed\n", {"[campaign] seed_keys", "section.key"}},
      {"[grid]\nvehicle.speed = 1\n", {"study.ini:4", "unknown key 'speed' in [vehicle]"}},
      {"[grid]\nvehicle.x = 1, 700\n", {"study.ini:4: [grid] vehicle.x", "'700'", "-500..500"}},
      {"[grid]\nvehicle.x = 1,,2\n", {"study.ini:4: [grid] vehicle.x", "empty"}},
      {"[grid]\nvehicle.x = 1, 1.0\n", {"{vehicle.x = 1} and {vehicle.x = 1.0} are the same"}},
      {"[grid]\nworld.hal = fast\n", {"study.ini:4: [grid] world.hal", "native, mcu or surrogate"}},
      {"[grid]\nworld.name = fast\n", {"study.ini:4", "unknown key 'name' in world", "hal, board"}},
      {"[grid]\nexperiment.seed = 1, 2\n",
       {"study.ini:4", "experiment.seed has its values from [campaign] seed_keys already"}},
      {"[set]\nvehicle.x = 1\n[grid]\nvehicle.x = 1, 2\n",
       {"study.ini:6", "vehicle.x has its values from", "study.ini:4: [set] vehicle.x already"}},
      {"[list]\nvehicle.x = 1, 2\nvehicle.y = 1, 2, 3\n",
       {"study.ini:5: [list] vehicle.y: 3 values; expected 2, as of vehicle.x"}},
      {"[random]\nvehicle.x = 0..1\n", {"study.ini:4: [random] has no count"}},
      {"[random]\ncount = 3\n", {"study.ini:4: [random] has no range"}},
      {"[random]\ncount = 0\nvehicle.x = 0..1\n", {"[random] count = '0'", "1..1000000"}},
      {"[random]\ncount = 2\nvehicle.x = 0, 1\n", {"study.ini:5: [random] vehicle.x", "0.1..0.5"}},
      {"[random]\ncount = 2\nexperiment.frames = 9..15\n",
       {"experiment.frames", "no multiple of 8"}},
      {"[random]\ncount = 2\nworld.hal = 0..1\n", {"world.hal has no range"}},
      {"[random]\ncount = 2\nvehicle.x = 0..1\n[latin_hypercube]\ncount = 2\n",
       {"study.ini:7: [latin_hypercube] beside [random]"}},
      {"[worlds]\nx = 1\n", {"study.ini:4: unknown section [worlds]", "[grid]"}},
      {"[grid]\nbed = flat\n", {"study.ini:4: [grid] bed: no section [bed flat]"}},
      {"[grid]\nbed = a\n[bed a]\nvehicle.x = 1\n[bed b]\nvehicle.x = 2\n",
       {"study.ini:8: [bed b] is the level of no factor", "among the values of bed"}},
      {"[grid]\nbed = a\n[bed a]\nvehicle.q = 1\n", {"study.ini:6: [bed a] vehicle.q", "'q'"}},
      {"[grid]\nbed = a\n[bed a]\nvehicle.x = far\n",
       {"study.ini:4: [grid] bed a", "[vehicle] x = 'far' is not allowed"}},
      {"[set]\nvehicle.x = 3\n[grid]\nbed = a\n[bed a]\nvehicle.x = 1\n",
       {"study.ini:8: [bed a] vehicle.x has its values from", "[set] vehicle.x already"}},
      {"seeds = 1..1000\n[random]\ncount = 1001\nvehicle.x = 0..1\n", {"more than 1000000 runs"}},
      {"seeds = 40000\n", {"[campaign] seeds, parameters.random_seed", "0..32767"}},
      {"[set]\nmap.filename = gone.png\n", {"[map] filename", "gone.png", "no such file"}},
  };
  for (const Case& bad : cases) {
    const std::string what = refusal(bad.text);
    for (const std::string& part : bad.parts)
      EXPECT_NE(what.find(part), std::string::npos) << part << "\n  in: " << what;
  }
}

TEST_F(Campaign, ALevelWithANameSetsSeveralKeysAndALaterFactorHolds) {
  const CampaignPlan campaign = plan(
      "seeds = 1, 2\n"
      "[grid]\nbed = flat, steep\nentry = walk, walk_mcu\n"
      "[bed flat]\nmap.size = 2\nsoil.slip_layer = 0.001\n"
      "[bed steep]\nmap.ramp = 10\n"
      "[entry walk]\nexperiment.algorithm = random_walk\nsoil.slip_layer = 0\n"
      "[entry walk_mcu]\nexperiment.algorithm = random_walk\nworld.hal = mcu\n");
  ASSERT_EQ(
      campaign.cells,
      (Cells{{"flat", "walk"}, {"flat", "walk_mcu"}, {"steep", "walk"}, {"steep", "walk_mcu"}}));
  const CampaignRun flat_walk = resolve_run(campaign, 0);
  EXPECT_EQ(flat_walk.experiment.map.size_m, 2.0);
  EXPECT_EQ(flat_walk.experiment.experiment.algorithm, "random_walk");
  EXPECT_EQ(flat_walk.experiment.soil.overrides.slip_layer_m, 0.0);
  EXPECT_EQ(flat_walk.world.hal, "native");
  const CampaignRun flat_mcu = resolve_run(campaign, 2);
  EXPECT_EQ(flat_mcu.experiment.soil.overrides.slip_layer_m, 0.001);
  EXPECT_EQ(flat_mcu.world.hal, "mcu");
  EXPECT_EQ(resolve_run(campaign, 4).experiment.map.ramp_deg, 10.0);

  write_text(folder_.path() / "plan.json", plan_text(campaign));
  const CampaignPlan read = read_plan(folder_.path() / "plan.json");
  for (size_t run = 0; run < campaign.run_count(); ++run)
    EXPECT_EQ(identity_of(resolve_run(read, run), kVersion), campaign.ids[run]);
}

TEST_F(Campaign, RefusesAFileWithoutExperiment) {
  EXPECT_THROW(read_campaign_file(folder_.path() / "gone.ini"), InputError);
  write_text(file(), "[campaign]\nseeds = 1\n");
  EXPECT_THROW(read_campaign_file(file()), InputError);
  write_text(file(), "[campaign]\nexperiment = gone.ini\n");
  EXPECT_THROW(read_campaign_file(file()), InputError);
  write_text(file(), "[campaign]\nexperiment = first_drive\n");
  EXPECT_EQ(read_campaign_file(file()).experiment.path.filename(), "first_drive.ini");
}

}  // namespace
}  // namespace screed
