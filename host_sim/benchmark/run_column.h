// A column of a benchmark's table of runs.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "host_sim/campaign/value_table.h"

namespace screed {

/// Numbers of a column by run; NaN: none.
class RunColumn {
 public:
  /// The table is referred to.
  RunColumn(const ValueTable& table, const std::string& name) {
    for (const ValueTable::ValueColumn& column : table.columns())
      if (column.name == name) column_ = &column;
  }
  double at(std::size_t run) const {
    if (column_ == nullptr || run >= column_->values.size())
      return std::numeric_limits<double>::quiet_NaN();
    const TableValue& value = column_->values[run];
    if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
    return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
  }
  /// A text stands there, and another one than this.
  bool says_other_than(const std::string& text, std::size_t run) const {
    return column_ != nullptr && run < column_->values.size() && column_->values[run].is_string() &&
           column_->values[run].get<std::string>() != text;
  }

 private:
  const ValueTable::ValueColumn* column_ = nullptr;
};

}  // namespace screed
