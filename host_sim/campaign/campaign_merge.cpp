// From stored results to tables.
#include "host_sim/campaign/campaign_merge.h"

#include <array>
#include <map>
#include <numeric>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/json.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr const char* kResultsFormat = "screed-campaign-results";
constexpr uint64_t kResultsFormatVersion = 1;

struct Tables {
  ValueTable runs;
  ValueTable curves;
  ValueTable provenance;
  std::map<std::string, size_t> arithmetics;  ///< runs of each
};

/// A number where the text is one.
TableValue value_of(const std::string& text) {
  int64_t integer = 0;
  double real = 0.0;
  if (parse_number(text, integer)) return integer;
  if (parse_number(text, real)) return real;
  return text;
}

const char* status_of(const ResultIndex& results, const std::string& id) {
  if (results.done(id)) return "done";
  return results.failed(id) ? "failed" : "missing";
}

/// What is known of a run without running it.
void add_identity(const CampaignPlan& plan, const ResultIndex& results, size_t run,
                  ValueTable& table) {
  const std::string& id = plan.ids[run];
  table.add_row();
  table.set("run", run);
  table.set("id", id);
  table.set("cell", plan.cell_of(run));
  table.set("seed", plan.seed_of(run));
  table.set("status", status_of(results, id));
}

void add_factors(const CampaignPlan& plan, size_t run, ValueTable& table) {
  const std::vector<std::string>& values = plan.cells[plan.cell_of(run)];
  for (size_t i = 0; i < values.size(); ++i)
    table.set(plan.factors[i].heading, value_of(values[i]));
}

void add_curve(size_t run, const Json& curve, ValueTable& table) {
  for (const Json& point : curve) {
    table.add_row();
    table.set("run", run);
    for (size_t i = 0; i < kLevelingColumns.size(); ++i)
      table.set(kLevelingColumns[i].name, TableValue(point.at(i)));
  }
}

void add_run(const CampaignPlan& plan, const ResultIndex& results, size_t run, Tables& tables) {
  const std::string& id = plan.ids[run];
  add_identity(plan, results, run, tables.runs);
  tables.runs.set("error", "");
  add_factors(plan, run, tables.runs);
  add_identity(plan, results, run, tables.provenance);
  tables.provenance.set("failures", results.failures(id));
  if (!results.done(id) && !results.failed(id)) return;
  const StoredResult stored = results.read(id);
  Json result = Json::parse(stored.result);
  const Json provenance = Json::parse(stored.provenance);
  tables.provenance.set_all(provenance);
  ++tables.arithmetics[provenance.value("arithmetic", kUnnamedArithmetic)];
  if (stored.status == ResultStatus::kFailed) {
    tables.runs.set("error", result.value("error", ""));
    return;
  }
  if (const Json* curve = result.find("curve"); curve != nullptr) {
    add_curve(run, *curve, tables.curves);
    result.erase("curve");
  }
  tables.runs.set_all(result);
}

Tables tables_of(const CampaignPlan& plan, const ResultIndex& results) {
  Tables tables;
  for (size_t run = 0; run < plan.run_count(); ++run) add_run(plan, results, run, tables);
  return tables;
}

void write_hdf5(const CampaignPlan& plan, const CampaignCount& count, const Tables& tables,
                const fs::path& path) {
  PartialFile file(path);
  try {
    h5::quiet();
    const h5::Handle options(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot create a file");
    h5::check(H5Pset_obj_track_times(options.get(), false), "cannot switch off time stamps");
    const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot create a file");
    h5::check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18),
              "cannot set the file format");
    h5::Handle hdf5(H5Fcreate(file.partial().c_str(), H5F_ACC_TRUNC, options.get(), access.get()),
                    H5Fclose, "cannot create it");
    h5::write_attribute(hdf5.get(), "format", std::string(kResultsFormat));
    h5::write_attribute(hdf5.get(), "format_version", kResultsFormatVersion);
    h5::write_attribute(hdf5.get(), "name", plan.settings.name);
    h5::write_attribute(hdf5.get(), "program_version", plan.version);
    h5::write_attribute(hdf5.get(), "runs", uint64_t{count.runs});
    h5::write_attribute(hdf5.get(), "done", uint64_t{count.done});
    h5::write_attribute(hdf5.get(), "failed", uint64_t{count.failed});
    tables.runs.write(hdf5.get(), "runs");
    if (tables.curves.rows() > 0) tables.curves.write(hdf5.get(), "curves");
    h5::check(H5Fflush(hdf5.get(), H5F_SCOPE_LOCAL), "cannot write");
    hdf5.close("cannot close it");
  } catch (const h5::Hdf5Failure& failure) {
    throw RunError(path.string() + ": cannot be written: " + failure.what());
  }
  file.commit();
}

}  // namespace

std::string CampaignCount::text() const {
  if (complete()) return "complete: " + std::to_string(runs) + " runs";
  std::string all = std::to_string(done) + " of " + std::to_string(runs) + " runs done";
  if (failed > 0) all += ", " + std::to_string(failed) + " failed";
  if (missing() > 0) all += ", " + std::to_string(missing()) + " missing";
  return all;
}

CampaignCount count_results(const CampaignPlan& plan, const ResultIndex& results) {
  std::vector<size_t> runs(plan.run_count());
  std::iota(runs.begin(), runs.end(), size_t{0});
  return count_results(plan, results, runs);
}

CampaignCount count_results(const CampaignPlan& plan, const ResultIndex& results,
                            const std::vector<size_t>& runs) {
  CampaignCount count;
  count.runs = runs.size();
  for (const size_t run : runs) {
    if (results.done(plan.ids[run])) ++count.done;
    if (results.failed(plan.ids[run])) ++count.failed;
  }
  return count;
}

ValueTable run_table(const CampaignPlan& plan, const ResultIndex& results) {
  return tables_of(plan, results).runs;
}

ValueTable curve_table(const CampaignPlan& plan, const ResultIndex& results) {
  return tables_of(plan, results).curves;
}

std::map<std::string, size_t> merge_results(const CampaignPlan& plan, const ResultIndex& results,
                                            const TaskFolder& folder) {
  Tables tables = tables_of(plan, results);
  write_hdf5(plan, count_results(plan, results), tables, folder.path / "campaign.h5");
  write_file(folder.path / "runs.csv", tables.runs.csv());
  if (tables.curves.rows() > 0) write_file(folder.path / "curves.csv", tables.curves.csv());
  write_file(folder.path / "provenance.csv", tables.provenance.csv());
  return tables.arithmetics;
}

}  // namespace screed
