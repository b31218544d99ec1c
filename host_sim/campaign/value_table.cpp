// Tables as CSV and HDF5.
#include "host_sim/campaign/value_table.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

#include "host_sim/core/hdf5_handle.h"
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

}  // namespace screed
