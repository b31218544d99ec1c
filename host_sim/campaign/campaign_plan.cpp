// Plans: combining factors, resolving runs, and the file of a plan.
#include "host_sim/campaign/campaign_plan.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/name_list.h"
#include "host_sim/engine/task_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr PlanFormat kPlanFormat{"screed-campaign", 1, "campaign"};
/// Part of every identity: raised when the same experiment is to count as another run.
constexpr const char* kIdentityRules = "screed campaign run 1";

/// Levels that change together: columns, and the values of each.
struct Block {
  const std::vector<CampaignFactor>* columns;
  size_t first;  ///< of the columns that belong to it
  size_t count;
  size_t levels() const { return (*columns)[first].values.size(); }
};

std::vector<Block> blocks_of(const CampaignFile& file) {
  std::vector<Block> blocks;
  for (size_t i = 0; i < file.grid.size(); ++i) blocks.push_back({&file.grid, i, 1});
  if (!file.list.empty()) blocks.push_back({&file.list, 0, file.list.size()});
  if (!file.samples.empty()) blocks.push_back({&file.samples, 0, file.samples.size()});
  return blocks;
}

/// Every combination, the first block changing slowest.
std::vector<std::vector<std::string>> combine(const std::vector<Block>& blocks, size_t cells) {
  std::vector<std::vector<std::string>> all;
  all.reserve(cells);
  for (size_t cell = 0; cell < cells; ++cell) {
    std::vector<std::string> values;
    size_t below = cells;
    size_t rest = cell;
    for (const Block& block : blocks) {
      below /= block.levels();
      const size_t level = rest / below;
      rest %= below;
      for (size_t c = 0; c < block.count; ++c)
        values.push_back((*block.columns)[block.first + c].values[level]);
    }
    all.push_back(std::move(values));
  }
  return all;
}

size_t count_cells(const CampaignFile& file, const std::vector<Block>& blocks) {
  size_t cells = 1;
  for (const Block& block : blocks) {
    cells *= block.levels();
    if (cells * file.settings.seeds.size() > kMaxCampaignRuns) {
      throw InputError(file.path.string() + ": more than " + std::to_string(kMaxCampaignRuns) +
                       " runs; fewer values, samples or seeds are allowed");
    }
  }
  return cells;
}

void set_world(CampaignWorld& world, const CampaignKey& key, const std::string& value,
               const std::string& where) {
  const bool is_hal = key.name == "hal";
  const std::vector<std::string> allowed =
      is_hal ? std::vector<std::string>{"native", "mcu", "surrogate"} : board_names();
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    throw InputError(where + ": " + key.text() + " = '" + value + "' is not allowed; expected " +
                     name_list(allowed, " or "));
  }
  (is_hal ? world.hal : world.board) = value;
}

/// Puts a value of a factor on a run.
void place_value(const CampaignFactor& factor, const std::string& value, CampaignWorld& world,
                 std::vector<PlacedEntry>& entries) {
  if (!factor.levels.empty()) {
    for (const IniEntry& entry : factor.levels.at(value)) {
      const std::string where = factor.where + " " + value + ", " + entry.section + "." + entry.key;
      if (entry.section == kWorldSection) {
        set_world(world, {entry.section, entry.key}, entry.value, where);
      } else {
        entries.push_back({{entry.section, entry.key, entry.value, 0}, where});
      }
    }
    return;
  }
  for (const CampaignKey& key : factor.keys) {
    if (key.section == kWorldSection) {
      set_world(world, key, value, factor.where);
    } else {
      entries.push_back({{key.section, key.name, value, 0}, factor.where});
    }
  }
}

Json json_of(const std::vector<IniEntry>& entries) {
  Json json = Json::array();
  for (const IniEntry& entry : entries)
    json.push_back({entry.section, entry.key, entry.value, entry.line});
  return json;
}

std::vector<IniEntry> entries_of(const Json& json) {
  std::vector<IniEntry> entries;
  for (const Json& e : json) {
    entries.push_back({e.at(0).get<std::string>(), e.at(1).get<std::string>(),
                       e.at(2).get<std::string>(), e.at(3).get<int>()});
  }
  return entries;
}

Json json_of(const CampaignFactor& factor) {
  Json keys = Json::array();
  for (const CampaignKey& key : factor.keys) keys.push_back({key.section, key.name});
  Json json = {{"heading", factor.heading}, {"keys", keys}, {"where", factor.where}};
  if (!factor.values.empty()) json["value"] = factor.values.front();
  for (const auto& [name, entries] : factor.levels) json["levels"][name] = json_of(entries);
  return json;
}

CampaignKey key_of(const Json& json) {
  return {json.at(0).get<std::string>(), json.at(1).get<std::string>()};
}

CampaignFactor factor_of(const Json& json) {
  CampaignFactor factor;
  factor.heading = json.at("heading").get<std::string>();
  for (const Json& key : json.at("keys")) factor.keys.push_back(key_of(key));
  factor.where = json.at("where").get<std::string>();
  if (json.contains("value")) factor.values.push_back(json.at("value").get<std::string>());
  if (json.contains("levels")) {
    for (const auto& [name, entries] : json.at("levels").items())
      factor.levels.insert({name, entries_of(entries)});
  }
  return factor;
}

Json json_of(const CampaignSettings& settings) {
  Json keys = Json::array();
  for (const CampaignKey& key : settings.seed_keys) keys.push_back({key.section, key.name});
  Json json = {{"name", settings.name},
               {"seeds", settings.seeds},
               {"seed_keys", keys},
               {"keep", keep_name(settings.keep)},
               {"retries", settings.retries}};
  if (settings.time_limit_s) json["time_limit"] = *settings.time_limit_s;
  if (settings.memory_mb) json["memory"] = *settings.memory_mb;
  if (settings.shard) json["shard"] = *settings.shard;
  return json;
}

CampaignSettings settings_of(const Json& json) {
  CampaignSettings settings;
  settings.name = json.at("name").get<std::string>();
  settings.seeds = json.at("seeds").get<std::vector<uint64_t>>();
  for (const Json& key : json.at("seed_keys")) settings.seed_keys.push_back(key_of(key));
  settings.keep = keep_of(json.at("keep").get<std::string>()).value_or(CampaignKeep::kSummary);
  settings.retries = json.at("retries").get<int>();
  if (json.contains("time_limit")) settings.time_limit_s = json.at("time_limit").get<double>();
  if (json.contains("memory")) settings.memory_mb = json.at("memory").get<double>();
  if (json.contains("shard")) settings.shard = json.at("shard").get<int>();
  return settings;
}

/// Two cells may differ in nothing that counts: a soil's key on rigid ground, a value written in
/// two ways.
void check_different(const CampaignPlan& plan, const fs::path& path) {
  std::map<std::string, size_t> first_run;
  for (size_t run = 0; run < plan.ids.size(); ++run) {
    const auto [same, is_new] = first_run.emplace(plan.ids[run], run);
    if (is_new) continue;
    const auto describe = [&](size_t r) {
      const std::vector<std::string>& values = plan.cells[plan.cell_of(r)];
      std::string text;
      for (size_t i = 0; i < values.size(); ++i)
        text += (i == 0 ? "" : ", ") + plan.factors[i].heading + " = " + values[i];
      return "{" + text + "}";
    };
    throw InputError(path.string() + ": " + describe(same->second) + " and " + describe(run) +
                     " are the same experiment; a factor decides nothing there, or has a value "
                     "twice");
  }
}

}  // namespace

CampaignPlan make_plan(const CampaignFile& file, const std::string& version) {
  CampaignPlan plan;
  plan.version = version;
  plan.settings = file.settings;
  plan.experiment = file.experiment;
  plan.experiment.path = fs::absolute(file.experiment.path).lexically_normal();
  plan.fixed = file.fixed;
  for (const auto* factors : {&file.grid, &file.list, &file.samples}) {
    for (CampaignFactor factor : *factors) {
      factor.values.clear();
      plan.factors.push_back(std::move(factor));
    }
  }
  const std::vector<Block> blocks = blocks_of(file);
  plan.cells = combine(blocks, count_cells(file, blocks));
  for (size_t run = 0; run < plan.run_count(); ++run) {
    const CampaignRun resolved = resolve_run(plan, run);
    plan.ids.push_back(identity_of(resolved, version));
    if (run % plan.seed_count() == 0)
      plan.durations_s.push_back(resolved.experiment.experiment.duration_s);
  }
  check_different(plan, file.path);
  return plan;
}

CampaignRun resolve_run(const CampaignPlan& plan, size_t run) {
  CampaignRun resolved;
  resolved.keep = plan.settings.keep;
  std::vector<PlacedEntry> entries;
  entries.push_back({{"experiment", "name", plan.settings.name, 0}, "[campaign] name"});
  for (const CampaignFactor& factor : plan.fixed)
    place_value(factor, factor.values.front(), resolved.world, entries);
  const std::vector<std::string>& values = plan.cells[plan.cell_of(run)];
  for (size_t i = 0; i < values.size(); ++i)
    place_value(plan.factors[i], values[i], resolved.world, entries);
  const std::string seed = std::to_string(plan.seed_of(run));
  for (const CampaignKey& key : plan.settings.seed_keys)
    entries.push_back({{key.section, key.name, seed, 0}, "[campaign] seeds, " + key.text()});
  resolved.experiment = make_experiment(plan.experiment, entries, "run " + std::to_string(run));
  return resolved;
}

std::string identity_of(const CampaignRun& run, const std::string& version) {
  ContentHash hash;
  hash.add(kIdentityRules);
  hash.add(version);
  hash.add(keep_name(run.keep));
  hash.add(run.world.hal);
  hash.add(run.world.board);
  Experiment nameless = run.experiment;
  nameless.experiment.name = Experiment{}.experiment.name;
  nameless.output_directory_prefix = Experiment{}.output_directory_prefix;
  hash.add(nameless.text());
  const std::string& map = run.experiment.map.filename;
  hash.add(map.empty() ? "" : file_hash(find_data_file(run.experiment, map, "[map] filename")));
  hash.add(file_hash(find_model_file(run.experiment, run.world.board)));
  return hash.hex();
}

std::string plan_text(const CampaignPlan& plan) {
  Json fixed = Json::array();
  for (const CampaignFactor& factor : plan.fixed) fixed.push_back(json_of(factor));
  Json factors = Json::array();
  for (const CampaignFactor& factor : plan.factors) factors.push_back(json_of(factor));
  const Json json = {
      {"format", kPlanFormat.format},
      {"format_version", kPlanFormat.version},
      {"version", plan.version},
      {"settings", json_of(plan.settings)},
      {"experiment",
       {{"path", plan.experiment.path.string()}, {"entries", json_of(plan.experiment.entries)}}},
      {"set", fixed},
      {"factors", factors},
      {"cells", plan.cells},
      {"durations_s", plan.durations_s},
      {"ids", plan.ids}};
  return json.dump(1) + "\n";
}

CampaignPlan read_plan(const fs::path& file) {
  CampaignPlan plan;
  read_plan_file(file, kPlanFormat, [&plan](const Json& json) {
    plan.version = json.at("version").get<std::string>();
    plan.settings = settings_of(json.at("settings"));
    plan.experiment.path = json.at("experiment").at("path").get<std::string>();
    plan.experiment.entries = entries_of(json.at("experiment").at("entries"));
    for (const Json& factor : json.at("set")) plan.fixed.push_back(factor_of(factor));
    for (const Json& factor : json.at("factors")) plan.factors.push_back(factor_of(factor));
    plan.cells = json.at("cells").get<std::vector<std::vector<std::string>>>();
    plan.durations_s = json.at("durations_s").get<std::vector<double>>();
    plan.ids = json.at("ids").get<std::vector<std::string>>();
  });
  if (plan.settings.seeds.empty() || plan.ids.size() != plan.run_count() ||
      plan.durations_s.size() != plan.cells.size())
    throw InputError(file.string() + ": the plan of the campaign is damaged");
  return plan;
}

}  // namespace screed
