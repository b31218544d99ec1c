// CSV files.
#include "host_sim/core/csv_file.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"

namespace screed {
namespace {

constexpr std::string_view kBlanks = " \t";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 with it

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

/// The quoted cell that `text` begins with, out of its marks; `text` is left with what follows.
/// False when no mark closes it.
bool take_quoted(std::string_view& text, std::string& cell) {
  for (size_t i = 1; i < text.size(); ++i) {
    if (text[i] != '"') {
      cell += text[i];
    } else if (i + 1 < text.size() && text[i + 1] == '"') {
      cell += text[i++];
    } else {
      text.remove_prefix(i + 1);
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> split_csv_line(std::string_view text, const std::string& where) {
  std::vector<std::string> cells;
  for (;;) {
    std::string quoted;
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    const bool is_quoted = !text.empty() && text.front() == '"';
    if (is_quoted && !take_quoted(text, quoted)) {
      throw InputError(where + ": a quotation is not closed; a cell ends with its line");
    }
    const size_t comma = text.find(',');
    const std::string_view rest = trimmed(text.substr(0, comma));
    if (is_quoted && !rest.empty()) {
      throw InputError(where + ": '" + std::string(rest) +
                       "' behind a closed quotation; \"\" is a quotation mark within it");
    }
    cells.push_back(is_quoted ? quoted : std::string(rest));
    if (comma == std::string_view::npos) return cells;
    text.remove_prefix(comma + 1);
  }
}

CsvReader::CsvReader(const std::filesystem::path& path) : path_(path.string()), file_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path_ + ": is a folder, not a table");
  if (!file_) throw InputError(path_ + ": no such table, or it cannot be read");
}

bool CsvReader::next(CsvLine& line) {
  while (std::getline(file_, text_)) {
    if (++number_ == 1 && text_.starts_with(kByteOrderMark)) text_.erase(0, kByteOrderMark.size());
    if (!text_.empty() && text_.back() == '\r') text_.pop_back();
    const std::string_view content = trimmed(text_);
    if (content.empty() || content.front() == '#') continue;
    line.line = number_;
    line.cells = split_csv_line(content, path_ + ":" + std::to_string(number_));
    return true;
  }
  if (file_.bad()) throw InputError(path_ + ": cannot be read");
  return false;
}

const std::string& CsvRow::text(const char* name) const {
  static const std::string kNone;
  const auto at =
      static_cast<size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  return at < names_.size() && at < line_.cells.size() ? line_.cells[at] : kNone;
}

double CsvRow::number(const char* name, double low, double high) const {
  const std::string& cell = text(name);
  if (cell.empty()) refuse(std::string("no ") + name);
  const std::optional<double> value = finite_number<double>(cell);
  if (!value.has_value() || *value < low || *value > high) {
    char what[200];
    std::snprintf(what, sizeof what, "%s is '%s', a number from %g to %g is needed", name,
                  cell.c_str(), low, high);
    refuse(what);
  }
  return *value;
}

std::optional<double> CsvRow::number_if_any(const char* name, double low, double high) const {
  if (!has(name)) return std::nullopt;
  return number(name, low, high);
}

void CsvRow::refuse(const std::string& what) const {
  throw InputError(file_ + ":" + std::to_string(line_.line) + ": " + what);
}

std::vector<CsvLine> read_csv_file(const std::filesystem::path& path) {
  CsvReader reader(path);
  std::vector<CsvLine> lines;
  for (CsvLine line; reader.next(line);) lines.push_back(std::move(line));
  return lines;
}

}  // namespace screed
