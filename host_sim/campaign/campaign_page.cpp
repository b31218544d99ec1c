// From the table of runs to the facts of the page.
#include "host_sim/campaign/campaign_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/campaign/cell_statistics.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/statistics.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/render/report/page_file.h"
#include "version.h"

namespace screed {
namespace {

/// The first of them that a campaign has is shown first.
constexpr std::array<const char*, 2> kFirstMetrics = {"terrain_after.level_deviation_m",
                                                      "leveling.progress"};
/// What is known before a run and is no metric of it.
constexpr std::array<std::string_view, 5> kIdentity = {"run", "id", "cell", "seed", "status"};

/// More curves in one plot cannot be told apart.
constexpr std::size_t kMaxCurveCells = 12;

constexpr const char* kNoFault = "no fault";
constexpr const char* kFailed = "failed";
constexpr const char* kMissing = "not made";

/// Null, for JSON, where there is no number.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// More than one value.
bool varies(const std::vector<double>& numbers) {
  const auto first =
      std::find_if(numbers.begin(), numbers.end(), [](double it) { return !std::isnan(it); });
  return std::any_of(first, numbers.end(),
                     [&](double it) { return !std::isnan(it) && it != *first; });
}

bool is_metric(const CampaignPlan& plan, const std::string& name) {
  return std::find(kIdentity.begin(), kIdentity.end(), name) == kIdentity.end() &&
         std::none_of(plan.factors.begin(), plan.factors.end(),
                      [&name](const CampaignFactor& factor) { return factor.heading == name; });
}

struct Metric {
  std::string name;
  MetricValues values;
};

std::vector<Metric> metrics_of(const CampaignPlan& plan, const ValueTable& runs) {
  std::vector<Metric> metrics;
  for (const ValueTable::ValueColumn& column : runs.columns()) {
    if (!is_metric(plan, column.name) ||
        std::any_of(column.values.begin(), column.values.end(),
                    [](const TableValue& value) { return value.is_string(); }))
      continue;
    std::vector<double> numbers = runs.numbers(column.name);
    if (varies(numbers))
      metrics.push_back({column.name, MetricValues(std::move(numbers), plan.seed_count())});
  }
  return metrics;
}

Json json_of(const SeedMean& value) {
  return {{"count", value.count},
          {"mean", number(value.mean)},
          {"low", number(value.interval.low)},
          {"high", number(value.interval.high)}};
}

Json json_of(const CellComparison& cell) {
  Json json = {{"value", json_of(cell.value)}, {"difference", nullptr}, {"rank", nullptr}};
  if (cell.against_baseline) {
    json["difference"] = json_of(cell.against_baseline->difference);
    json["difference"]["p"] = cell.against_baseline->test.p;
    json["difference"]["p_holm"] = cell.against_baseline->p_holm;
    json["difference"]["effect"] = cell.against_baseline->test.effect;
  }
  if (cell.rank) {
    json["rank"] = {{"mean", cell.rank->mean},
                    {"low", number(cell.rank->interval.low)},
                    {"high", number(cell.rank->interval.high)}};
  }
  return json;
}

Json levels_json(const CampaignPlan& plan, const MetricValues& values) {
  Json factors = Json::array();
  for (std::size_t factor = 0; factor < plan.factors.size(); ++factor) {
    Json levels = Json::array();
    for (const FactorLevel& level : levels_of(plan.cells, factor)) {
      Json json = {{"value", level.value}, {"cells", level.cells.size()}};
      json.update(json_of(mean_over_cells(values, level.cells)));
      levels.push_back(std::move(json));
    }
    factors.push_back(std::move(levels));
  }
  return factors;
}

Json add_metrics(PageFile& page, const CampaignPlan& plan, const std::vector<Metric>& metrics,
                 std::size_t baseline) {
  Json list = Json::array();
  for (const Metric& metric : metrics) {
    const std::string block = "metric-" + std::to_string(list.size());
    page.add_numbers(block, std::span<const double>(metric.values.all()));
    Json cells = Json::array();
    for (const CellComparison& cell : compare_cells(metric.values, baseline))
      cells.push_back(json_of(cell));
    list.push_back({{"name", metric.name},
                    {"block", block},
                    {"cells", std::move(cells)},
                    {"levels", levels_json(plan, metric.values)}});
  }
  return list;
}

Json curves_json(const CampaignPlan& plan, const ValueTable& curves) {
  Json list = Json::array();
  if (plan.cells.size() > kMaxCurveCells) return list;
  for (const CellCurve& curve : cell_curves(plan, curves)) {
    Json cells = Json::array();
    for (const std::vector<SeedMean>& cell : curve.cells) {
      Json mean = Json::array();
      Json low = Json::array();
      Json high = Json::array();
      for (const SeedMean& value : cell) {
        mean.push_back(number(value.mean));
        low.push_back(number(value.interval.low));
        high.push_back(number(value.interval.high));
      }
      cells.push_back({{"mean", mean}, {"low", low}, {"high", high}});
    }
    const auto* const column =
        std::find_if(kLevelingColumns.begin(), kLevelingColumns.end(),
                     [&curve](const Column& it) { return it.name == curve.name; });
    list.push_back({{"name", curve.name},
                    {"unit", std::string(column->unit)},
                    {"times", curve.times_s},
                    {"cells", std::move(cells)}});
  }
  return list;
}

/// How a run ended, in words.
std::vector<std::string> outcomes_of(const ValueTable& runs) {
  const std::vector<std::string> status = runs.texts("status");
  const std::vector<std::string> faults = runs.texts("faults");
  const std::vector<double> left = runs.numbers("left_bed");
  std::vector<std::string> outcomes(runs.rows(), kNoFault);
  for (std::size_t row = 0; row < outcomes.size(); ++row) {
    if (status[row] == "failed") outcomes[row] = kFailed;
    if (status[row] == "missing") outcomes[row] = kMissing;
    if (status[row] != "done") continue;
    if (!faults[row].empty() && faults[row] != "none") outcomes[row] = "fault: " + faults[row];
    if (left[row] == 1.0) outcomes[row] = "left the bed";
  }
  return outcomes;
}

/// Those that occur: no fault first, then as they occur first.
std::vector<std::string> names_of(const std::vector<std::string>& outcomes) {
  std::vector<std::string> names = {kNoFault};
  for (const std::string& outcome : outcomes) {
    if (std::find(names.begin(), names.end(), outcome) == names.end()) names.push_back(outcome);
  }
  return names;
}

Json cells_json(const CampaignPlan& plan, const std::vector<std::string>& outcomes,
                const std::vector<std::string>& names) {
  Json cells = Json::array();
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    const auto first = outcomes.begin() + static_cast<std::ptrdiff_t>(cell * plan.seed_count());
    const auto last = first + static_cast<std::ptrdiff_t>(plan.seed_count());
    Json counts = Json::array();
    for (const std::string& name : names) {
      const auto count = static_cast<int>(std::count(first, last, name));
      const Interval interval = wilson(count, static_cast<int>(plan.seed_count()));
      counts.push_back({{"count", count}, {"low", interval.low}, {"high", interval.high}});
    }
    cells.push_back({{"values", plan.cells[cell]}, {"outcomes", std::move(counts)}});
  }
  return cells;
}

Json failures_json(const CampaignPlan& plan, const ValueTable& runs) {
  const std::vector<std::string> status = runs.texts("status");
  const std::vector<std::string> errors = runs.texts("error");
  Json list = Json::array();
  for (std::size_t run = 0; run < status.size(); ++run) {
    if (status[run] != "failed") continue;
    list.push_back({{"run", run},
                    {"cell", plan.cell_of(run)},
                    {"seed", std::to_string(plan.seed_of(run))},
                    {"why", errors[run]}});
  }
  return list;
}

/// Where a run's folder was kept, a link to it, or to its page where there is one.
std::optional<std::string> link_of(const std::filesystem::path& kept,
                                   const std::filesystem::path& base) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(kept)) return std::nullopt;
  const fs::path page = kept / "report.html";
  return fs::proximate(fs::exists(page) ? page : kept, base.empty() ? "." : base).generic_string();
}

Json runs_json(const CampaignPlan& plan, const TaskFolder& folder,
               const std::filesystem::path& base, const std::vector<std::string>& outcomes,
               const std::vector<std::string>& names) {
  Json list = Json::array();
  for (std::size_t run = 0; run < outcomes.size(); ++run) {
    const auto name = std::find(names.begin(), names.end(), outcomes[run]);
    Json json = {{"outcome", name - names.begin()}};
    if (const auto link = link_of(folder.runs() / plan.ids[run], base); link.has_value())
      json["link"] = *link;
    list.push_back(std::move(json));
  }
  return list;
}

std::string seeds_text(const std::vector<std::uint64_t>& seeds) {
  const bool consecutive =
      std::adjacent_find(seeds.begin(), seeds.end(), [](std::uint64_t a, std::uint64_t b) {
        return b != a + 1;
      }) == seeds.end();
  if (consecutive && seeds.size() > 2)
    return std::to_string(seeds.front()) + " to " + std::to_string(seeds.back());
  std::string text;
  for (const std::uint64_t seed : seeds) text += (text.empty() ? "" : ", ") + std::to_string(seed);
  return text;
}

Json identity_json(const CampaignPlan& plan, const CampaignCount& count) {
  const auto fact = [](const std::string& name, const std::string& value) {
    return Json{{"name", name}, {"value", value}};
  };
  Json list = {fact("Campaign", plan.settings.name),
               fact("Experiment", plan.experiment.path.stem().string()),
               fact("Runs", std::to_string(plan.cells.size()) + " cells x " +
                                std::to_string(plan.seed_count()) + " seeds; " + count.text()),
               fact("Seeds", seeds_text(plan.settings.seeds))};
  for (const CampaignFactor& it : plan.fixed)
    list.push_back(fact(it.heading, it.values.empty() ? "" : it.values.front()));
  list.push_back(fact("Program of the runs", plan.version));
  list.push_back(fact("Program of this page", SCREED_VERSION));
  return list;
}

std::size_t first_metric(const std::vector<Metric>& metrics,
                         const std::optional<std::string>& wanted) {
  const auto place = [&metrics](const std::string& name) {
    return std::find_if(metrics.begin(), metrics.end(),
                        [&name](const Metric& metric) { return metric.name == name; });
  };
  if (wanted.has_value()) {
    const auto found = place(*wanted);
    if (found != metrics.end()) return static_cast<std::size_t>(found - metrics.begin());
    std::string names;
    for (const Metric& metric : metrics) names += (names.empty() ? "" : ", ") + metric.name;
    throw InputError("--metric " + *wanted + ": is none that differs between runs: " +
                     (names.empty() ? "there is none" : names));
  }
  for (const char* name : kFirstMetrics) {
    if (const auto found = place(name); found != metrics.end())
      return static_cast<std::size_t>(found - metrics.begin());
  }
  return 0;
}

}  // namespace

std::string campaign_page(const CampaignPlan& plan, const CampaignCount& count,
                          const ValueTable& runs, const ValueTable& curves,
                          const TaskFolder& folder, const CampaignPageOptions& options) {
  if (options.baseline >= plan.cells.size()) {
    throw InputError("--baseline " + std::to_string(options.baseline) +
                     ": the campaign has cells 0 to " + std::to_string(plan.cells.size() - 1));
  }
  const std::vector<Metric> metrics = metrics_of(plan, runs);
  const std::vector<std::string> outcomes = outcomes_of(runs);
  const std::vector<std::string> names = names_of(outcomes);
  PageFile page;
  Json facts;
  facts["kind"] = "campaign";
  facts["title"] = plan.settings.name;
  facts["identity"] = identity_json(plan, count);
  facts["counts"] = {{"runs", count.runs}, {"done", count.done}, {"failed", count.failed}};
  facts["factors"] = Json::array();
  for (const CampaignFactor& factor : plan.factors) facts["factors"].push_back(factor.heading);
  facts["seeds"] = Json::array();
  // As texts: a number of a script holds 53 bits.
  for (const std::uint64_t seed : plan.settings.seeds)
    facts["seeds"].push_back(std::to_string(seed));
  facts["baseline"] = options.baseline;
  facts["metric"] = first_metric(metrics, options.metric);
  facts["metrics"] = add_metrics(page, plan, metrics, options.baseline);
  facts["curves"] = curves_json(plan, curves);
  facts["curves_note"] =
      plan.cells.size() > kMaxCurveCells
          ? "Curves over time are drawn of at most " + std::to_string(kMaxCurveCells) + " cells."
          : "No curves were kept (keep = curves keeps them).";
  facts["outcomes"] = names;
  facts["cells"] = cells_json(plan, outcomes, names);
  facts["failures"] = failures_json(plan, runs);
  facts["runs"] = runs_json(plan, folder, options.link_base, outcomes, names);
  facts["runs_note"] =
      plan.settings.keep == CampaignKeep::kSession
          ? "A run's number leads to its folder, or to its page where `screed report` has made one."
          : "The folders of the runs were not kept (keep = session keeps them).";
  return page.document(options.built_page, facts.dump(-1, Json::BadText::kReplace));
}

}  // namespace screed
