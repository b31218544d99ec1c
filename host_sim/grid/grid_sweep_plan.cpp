// Plans of sweeps: identities, and the file of a plan.
#include "host_sim/grid/grid_sweep_plan.h"

#include <fstream>
#include <optional>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/file_hash.h"
#include "host_sim/grid/grid_run.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlanFormat = "screed-grid-sweep";
constexpr int kPlanFormatVersion = 1;
/// Part of every identity: raised when the same configuration is to count as another run.
constexpr const char* kIdentityRules = "screed grid run 1";

/// Every value of a configuration with its name: `visit(name, value)`.
template <class Config, class Visit>
void for_each_value(Config& config, Visit visit) {
  visit("algorithm", config.algorithm);
  visit("seed", config.seed);
  visit("agents", config.agents);
  visit("max_cycles", config.max_cycles);
  visit("stop", config.stop.measure);
  visit("epsilon", config.stop.epsilon);
  visit("width", config.noise.width);
  visit("height", config.noise.height);
  visit("mean", config.noise.mean);
  visit("amplitude", config.noise.amplitude);
  visit("lattice", config.noise.lattice);
  visit("border", config.noise.border);
  visit("image", config.image);
  visit("image_width", config.image_width);
  visit("image_height", config.image_height);
  visit("white", config.white);
  visit("image_mean", config.image_mean);
  visit("p_sense", config.p_sense);
  visit("p_turn", config.p_turn);
  visit("p_pick_up", config.p_pick_up);
  visit("p_deposit", config.p_deposit);
  visit("k", config.k);
  visit("memory", config.memory);
  visit("fitness_threshold", config.fitness_threshold);
  visit("chromosomes", config.chromosomes);
  visit("repetitions", config.repetitions);
  visit("fitness_base", config.fitness_base);
  visit("averaging", config.averaging);
  visit("dead_band", config.dead_band);
  visit("patience", config.patience);
  visit("hold_out", config.hold_out);
  visit("follows_slope", config.follows_slope);
  visit("turns_back", config.turns_back);
}

template <class Value>
Json json_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return static_cast<int>(value);
  } else {
    return value;
  }
}
Json json_of(const fs::path& path) {
  return path.string();
}
template <class Value>
Json json_of(const std::optional<Value>& value) {
  return value.has_value() ? Json(*value) : Json();
}

template <class Value>
void take(const Json& json, Value& value) {
  value = json.get<Value>();
}
void take(const Json& json, fs::path& path) {
  path = json.get<std::string>();
}
template <class Value>
void take(const Json& json, std::optional<Value>& value) {
  if (!json.is_null()) value = json.get<Value>();
}

Json json_of_config(const GridConfig& config) {
  Json json;
  for_each_value(config,
                 [&json](const char* name, const auto& value) { json[name] = json_of(value); });
  return json;
}

GridConfig config_of_json(const Json& json) {
  GridConfig config;
  for_each_value(config, [&json](const char* name, auto& value) { take(json.at(name), value); });
  return config;
}

}  // namespace

GridConfig SweepPlan::config_of(size_t task) const {
  GridConfig config = points[point_of(task)];
  config.seed += run_of(task);
  return config;
}

SweepPlan make_sweep_plan(const std::vector<SweepPoint>& points, const std::string& version) {
  SweepPlan plan;
  plan.version = version;
  for (const SweepPoint& point : points) {
    check(point.config);
    // What an image does not allow shows when its terrain is made.
    if (!point.config.image.empty()) static_cast<void>(GridRun(point.config));
    plan.points.push_back(with_defaults(point.config));
    plan.ids.push_back(identity_of(point.config, version));
  }
  return plan;
}

std::string identity_of(const GridConfig& config, const std::string& version) {
  ContentHash hash;
  hash.add(kIdentityRules);
  hash.add(version);
  try {
    hash.add(json_of_config(with_defaults(config)).dump());
  } catch (const JsonError&) {
    throw InputError("grid: terrain = " + config.image.string() +
                     "; many runs need a name of the image in UTF-8");
  }
  hash.add(config.image.empty() ? "" : file_hash(config.image));
  return hash.hex();
}

std::string sweep_plan_text(const SweepPlan& plan) {
  Json points = Json::array();
  for (size_t i = 0; i < plan.points.size(); ++i)
    points.push_back({{"id", plan.ids[i]}, {"config", json_of_config(plan.points[i])}});
  const Json json = {{"format", kPlanFormat},
                     {"format_version", kPlanFormatVersion},
                     {"version", plan.version},
                     {"points", points}};
  return json.dump(1) + "\n";
}

SweepPlan read_sweep_plan(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": no such file: this is no folder of a sweep");
  const Json json = Json::parse_or_null(stream);
  if (!json.is_object() || json.value("format", "") != kPlanFormat)
    throw InputError(file.string() + ": is not the plan of a sweep, or is damaged");
  if (json.value("format_version", 0) != kPlanFormatVersion)
    throw InputError(file.string() + ": is of another version of Screed");
  SweepPlan plan;
  try {
    plan.version = json.at("version").get<std::string>();
    for (const Json& point : json.at("points")) {
      plan.ids.push_back(point.at("id").get<std::string>());
      plan.points.push_back(config_of_json(point.at("config")));
    }
  } catch (const JsonError&) {
    throw InputError(file.string() + ": the plan of the sweep is damaged");
  }
  if (plan.points.empty()) throw InputError(file.string() + ": the plan has no points");
  return plan;
}

}  // namespace screed
