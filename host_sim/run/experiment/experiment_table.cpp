// Tables of experiments: heading and rows; what a value may be is the table of keys' business.
#include "host_sim/run/experiment/experiment_table.h"

#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "host_sim/core/csv_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {
namespace {

constexpr const char* kNameColumn = "experiment.name";
constexpr size_t kNamesInMessage = 6;

using KeyName = std::pair<std::string, std::string>;  // section, key

struct TableColumn {
  std::string heading;
  std::vector<KeyName> keys;
};

struct Headings {
  std::vector<TableColumn> columns;
  size_t name_column = 0;
  int line = 0;
};

std::string place(const std::filesystem::path& path, int line) {
  return path.string() + ":" + std::to_string(line);
}

/// `where` with the column, as messages call it.
std::string in_column(const std::string& where, const char* separator, const std::string& heading) {
  return where + separator + "column '" + heading + "'";
}

/// A known key out of its name in a heading.
KeyName parse_key_name(std::string name, const std::string& where) {
  name.erase(0, name.find_first_not_of(' '));
  name.erase(name.find_last_not_of(' ') + 1);
  const size_t dot = name.find('.');
  if (dot == std::string::npos || dot == 0)
    throw InputError(where + "; expected section.key of an experiment file, such as vehicle.x");
  KeyName key(name.substr(0, dot), name.substr(dot + 1));
  find_experiment_key(key.first, key.second, where);
  return key;
}

/// The keys that a heading names: section.key, several of them joined by +.
TableColumn parse_heading(const std::string& heading, const std::string& where) {
  TableColumn column{heading, {}};
  for (size_t begin = 0; begin <= heading.size();) {
    const size_t end = std::min(heading.find('+', begin), heading.size());
    column.keys.push_back(parse_key_name(heading.substr(begin, end - begin), where));
    begin = end + 1;
  }
  return column;
}

void add_unique(const TableColumn& column, std::set<KeyName>& seen, const std::string& where) {
  for (const KeyName& key : column.keys) {
    if (seen.insert(key).second) continue;
    std::string message = where;
    message.append(": ").append(key.first).append(".").append(key.second);
    throw InputError(message.append(" is given twice; a key stands in one column"));
  }
}

Headings parse_headings(const CsvLine& line, const std::string& where) {
  Headings headings{{}, line.cells.size(), line.line};
  std::set<KeyName> seen;
  for (const std::string& cell : line.cells) {
    const std::string here = in_column(where, ": ", cell);
    if (cell == kNameColumn) headings.name_column = headings.columns.size();
    headings.columns.push_back(parse_heading(cell, here));
    add_unique(headings.columns.back(), seen, here);
  }
  if (headings.name_column == line.cells.size()) {
    throw InputError(where + ": no column '" + kNameColumn + "'; every row needs a name");
  }
  return headings;
}

/// `line_of_name` has the lines of the rows so far.
ExperimentRow parse_row(const CsvLine& line, const Headings& headings, const std::string& where,
                        std::map<std::string, int>& line_of_name) {
  const size_t columns = headings.columns.size();
  if (line.cells.size() != columns) {
    throw InputError(where + ": " + std::to_string(line.cells.size()) + " cells; expected " +
                     std::to_string(columns) + ", as in the headings in line " +
                     std::to_string(headings.line));
  }
  const std::string& name = line.cells[headings.name_column];
  if (name.empty())
    throw InputError(in_column(where, ": ", kNameColumn) + " is empty; every row needs a name");
  ExperimentRow row{name, where + ": row '" + name + "'", {}};
  const auto [same, is_new] = line_of_name.emplace(name, line.line);
  if (!is_new) {
    throw InputError(in_column(row.where, ", ", kNameColumn) +
                     ": the name is given twice, first in line " + std::to_string(same->second));
  }
  for (size_t c = 0; c < columns; ++c) {
    if (line.cells[c].empty()) continue;
    for (const auto& [section, key] : headings.columns[c].keys)
      row.values.push_back({{section, key, line.cells[c], line.line}, headings.columns[c].heading});
  }
  return row;
}

bool matches(const ExperimentRow& row, const std::string& pattern) {
  return fnmatch(pattern.c_str(), row.name.c_str(), 0) == 0;
}

void check_pattern(const std::string& pattern, const std::vector<ExperimentRow>& rows) {
  if (std::any_of(rows.begin(), rows.end(),
                  [&](const ExperimentRow& row) { return matches(row, pattern); }))
    return;
  std::string names;
  for (size_t i = 0; i < std::min(rows.size(), kNamesInMessage); ++i)
    names.append(names.empty() ? "" : ", ").append(rows[i].name);
  if (rows.size() > kNamesInMessage) names += ", ... (" + std::to_string(rows.size()) + " rows)";
  throw InputError("--rows " + pattern + ": no row has such a name; names are " + names);
}

}  // namespace

std::vector<ExperimentRow> read_experiment_table(const std::filesystem::path& path) {
  const std::vector<CsvLine> lines = read_csv_file(path);
  if (lines.size() < 2) {
    throw InputError(path.string() +
                     ": no rows; expected a line of headings and a line for each experiment");
  }
  const Headings headings = parse_headings(lines.front(), place(path, lines.front().line));
  std::map<std::string, int> line_of_name;
  std::vector<ExperimentRow> rows;
  rows.reserve(lines.size() - 1);
  for (auto line = lines.begin() + 1; line != lines.end(); ++line)
    rows.push_back(parse_row(*line, headings, place(path, line->line), line_of_name));
  return rows;
}

std::vector<ExperimentRow> select_rows(std::vector<ExperimentRow> rows,
                                       const std::vector<std::string>& patterns) {
  for (const std::string& pattern : patterns) check_pattern(pattern, rows);
  if (patterns.empty()) return rows;
  std::erase_if(rows, [&](const ExperimentRow& row) {
    return std::none_of(patterns.begin(), patterns.end(),
                        [&](const std::string& pattern) { return matches(row, pattern); });
  });
  return rows;
}

}  // namespace screed
