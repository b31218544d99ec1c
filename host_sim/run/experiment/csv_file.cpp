// CSV files.
#include "host_sim/run/experiment/csv_file.h"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <system_error>

#include "host_sim/core/errors.h"

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

std::vector<CsvLine> read_csv_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path.string() + ": is a folder, not a table");
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": no such table, or it cannot be read");
  std::vector<CsvLine> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (number == 1 && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::string_view content = trimmed(text);
    if (content.empty() || content.front() == '#') continue;
    lines.push_back(
        {number, split_csv_line(content, path.string() + ":" + std::to_string(number))});
  }
  return lines;
}

}  // namespace screed
