// A table of named columns whose values are numbers, texts or nothing, and its files.
//
// Equal tables give equal bytes.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "host_sim/core/json.h"

namespace screed {

/// A number, a text, a truth value or null.
using TableValue = Json;

class ValueTable {
 public:
  struct ValueColumn {
    std::string name;
    std::vector<TableValue> values;  ///< fewer than the table's rows: the rest is null
  };

  /// Begins a row.
  void add_row() { ++rows_; }
  /// Sets a value of the last row; an unknown column is added behind the others.
  void set(const std::string& column, TableValue value);
  /// Sets the values of a JSON object under its members' names: those of an inner object as
  /// `outer.inner`, those of a list as `outer.0`, a list of texts as one text with "; " between
  /// them. Columns that the row has already stay as they are.
  void set_all(const Json& object, const std::string& prefix = "");

  size_t rows() const { return rows_; }
  /// In the order in which they were first set.
  const std::vector<ValueColumn>& columns() const { return columns_; }
  const TableValue& at(size_t column, size_t row) const;

  /// Lines of cells (RFC 4180), the first with the names. Numbers are the shortest text that reads
  /// back to the same bits, truth values 1 and 0; null is an empty cell.
  std::string csv() const;
  /// A dataset for each column, in a new group: 64-bit integers where all values are, else 64-bit
  /// floating point with NaN for null, else text. Throws h5::Hdf5Failure.
  void write(hid_t file, const char* group) const;

 private:
  bool has(const std::string& column) const;

  std::vector<ValueColumn> columns_;
  std::map<std::string, size_t> numbers_;  ///< of the columns, by name
  size_t rows_ = 0;
};

}  // namespace screed
