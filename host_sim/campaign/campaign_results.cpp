// Tables as CSV and HDF5, and those of a campaign.
#include "host_sim/campaign/campaign_results.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/json.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/run/experiment/experiment_keys.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

namespace {

constexpr hsize_t kChunkRows = 4096;

std::string cell_text(const TableValue& value) {
  if (value.is_null()) return "";
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (!value.is_string()) return value.dump();
  const std::string& text = value.text();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

bool is_text_list(const Json& json) {
  return json.is_array() && std::all_of(json.begin(), json.end(),
                                        [](const auto& element) { return element.is_string(); });
}

std::string joined(const Json& texts) {
  std::string all;
  for (const auto& text : texts) all += (all.empty() ? "" : "; ") + text.get<std::string>();
  return all;
}

enum class Kind : uint8_t { kSigned, kUnsigned, kReal, kText };

/// What holds all values of a column.
Kind kind_of(const ValueTable& table, size_t column) {
  bool all_integers = true;
  bool is_big = false;
  bool is_negative = false;
  bool has_number = false;
  for (size_t row = 0; row < table.rows(); ++row) {
    const TableValue& value = table.at(column, row);
    if (value.is_string()) return Kind::kText;
    all_integers = all_integers && (value.is_boolean() || value.is_number_integer());
    has_number = has_number || value.is_number() || value.is_boolean();
    if (value.is_number_unsigned())
      is_big = is_big || value.get<uint64_t>() > std::numeric_limits<int64_t>::max();
    if (value.is_number_integer() && !value.is_number_unsigned())
      is_negative = is_negative || value.get<int64_t>() < 0;
  }
  if (!has_number || !all_integers || (is_big && is_negative)) return Kind::kReal;
  return is_big ? Kind::kUnsigned : Kind::kSigned;
}

template <class Number>
std::vector<Number> numbers_of(const ValueTable& table, size_t column, Number nothing) {
  std::vector<Number> numbers;
  numbers.reserve(table.rows());
  for (size_t row = 0; row < table.rows(); ++row) {
    const TableValue& value = table.at(column, row);
    if (value.is_boolean()) {
      numbers.push_back(value.get<bool>() ? Number{1} : Number{0});
    } else {
      numbers.push_back(value.is_null() ? nothing : value.get<Number>());
    }
  }
  return numbers;
}

/// All texts in one piece, each as long as the longest and a NUL.
struct Texts {
  size_t width = 1;
  std::vector<char> bytes;
};

Texts texts_of(const ValueTable& table, size_t column) {
  std::vector<std::string> all;
  Texts texts;
  for (size_t row = 0; row < table.rows(); ++row) {
    const TableValue& value = table.at(column, row);
    all.push_back(value.is_string() ? value.get<std::string>() : cell_text(value));
    texts.width = std::max(texts.width, all.back().size() + 1);
  }
  texts.bytes.assign(texts.width * all.size(), '\0');
  for (size_t row = 0; row < all.size(); ++row)
    std::memcpy(&texts.bytes[row * texts.width], all[row].data(), all[row].size());
  return texts;
}

void write_dataset(hid_t group, const std::string& name, hid_t file_type, hid_t memory_type,
                   hsize_t rows, const void* values) {
  const char* const what = name.c_str();
  const h5::Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose, what);
  const h5::Handle options =
      layout::compressed(std::array<hsize_t, 1>{std::clamp<hsize_t>(rows, 1, kChunkRows)});
  h5::Handle dataset(
      H5Dcreate2(group, what, file_type, space.get(), H5P_DEFAULT, options.get(), H5P_DEFAULT),
      H5Dclose, what);
  h5::check(H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), what);
  dataset.close(what);
}

void write_texts(hid_t group, const std::string& name, hsize_t rows, const Texts& texts) {
  const h5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name.c_str());
  h5::check(H5Tset_size(type.get(), texts.width), name.c_str());
  h5::check(H5Tset_cset(type.get(), H5T_CSET_UTF8), name.c_str());
  write_dataset(group, name, type.get(), type.get(), rows, texts.bytes.data());
}

}  // namespace

void ValueTable::set(const std::string& column, TableValue value) {
  const auto [known, is_new] = numbers_.emplace(column, columns_.size());
  if (is_new) columns_.push_back({column, {}});
  std::vector<TableValue>& values = columns_[known->second].values;
  values.resize(rows_);
  values.back() = std::move(value);
}

bool ValueTable::has(const std::string& column) const {
  const auto known = numbers_.find(column);
  return known != numbers_.end() && columns_[known->second].values.size() == rows_;
}

void ValueTable::set_all(const Json& object, const std::string& prefix) {
  const auto set_one = [&](const std::string& column, const Json& value) {
    if (is_text_list(value)) {
      if (!has(column)) set(column, joined(value));
    } else if (value.is_structured()) {
      set_all(value, column + ".");
    } else if (!has(column)) {
      set(column, TableValue(value));
    }
  };
  if (object.is_array()) {
    for (size_t i = 0; i < object.size(); ++i) set_one(prefix + std::to_string(i), object[i]);
  } else {
    for (const auto& [name, value] : object.items()) set_one(prefix + name, value);
  }
}

const TableValue& ValueTable::at(size_t column, size_t row) const {
  static const TableValue null;
  const std::vector<TableValue>& values = columns_[column].values;
  return row < values.size() ? values[row] : null;
}

std::vector<double> ValueTable::numbers(const std::string& column) const {
  std::vector<double> numbers(rows_, std::numeric_limits<double>::quiet_NaN());
  const auto known = numbers_.find(column);
  if (known == numbers_.end()) return numbers;
  for (size_t row = 0; row < rows_; ++row) {
    const TableValue& value = at(known->second, row);
    if (value.is_boolean()) numbers[row] = value.get<bool>() ? 1.0 : 0.0;
    if (value.is_number()) numbers[row] = value.get<double>();
  }
  return numbers;
}

std::vector<std::string> ValueTable::texts(const std::string& column) const {
  std::vector<std::string> texts(rows_);
  const auto known = numbers_.find(column);
  if (known == numbers_.end()) return texts;
  for (size_t row = 0; row < rows_; ++row) {
    const TableValue& value = at(known->second, row);
    if (value.is_string()) texts[row] = value.get<std::string>();
  }
  return texts;
}

std::string ValueTable::csv() const {
  std::string text;
  for (size_t column = 0; column < columns_.size(); ++column)
    text += (column == 0 ? "" : ",") + cell_text(columns_[column].name);
  text += '\n';
  for (size_t row = 0; row < rows_; ++row) {
    for (size_t column = 0; column < columns_.size(); ++column)
      text += (column == 0 ? "" : ",") + cell_text(at(column, row));
    text += '\n';
  }
  return text;
}

void ValueTable::write(hid_t file, const char* name) const {
  h5::Handle group = layout::create_group(file, name);
  for (size_t column = 0; column < columns_.size(); ++column) {
    const std::string& heading = columns_[column].name;
    switch (kind_of(*this, column)) {
      case Kind::kText:
        write_texts(group.get(), heading, rows_, texts_of(*this, column));
        break;
      case Kind::kSigned:
        write_dataset(group.get(), heading, H5T_STD_I64LE, H5T_NATIVE_INT64, rows_,
                      numbers_of<int64_t>(*this, column, 0).data());
        break;
      case Kind::kUnsigned:
        write_dataset(group.get(), heading, H5T_STD_U64LE, H5T_NATIVE_UINT64, rows_,
                      numbers_of<uint64_t>(*this, column, 0).data());
        break;
      case Kind::kReal:
        write_dataset(
            group.get(), heading, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, rows_,
            numbers_of<double>(*this, column, std::numeric_limits<double>::quiet_NaN()).data());
        break;
    }
  }
  group.close(name);
}

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
    h5::begin();
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
  if (complete()) return "complete: " + counted(runs, "run");
  std::string all = std::to_string(done) + " of " + counted(runs, "run") + " done";
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
