// A CSV file (RFC 4180) as lines of cells with their line numbers. Knows nothing of what columns
// mean.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

struct CsvLine {
  int line = 0;  ///< 1-based, in the file
  std::vector<std::string> cells;
};

/// Reads a file line by line: cells between commas, without the blanks around them; "..." keeps
/// commas and blanks, and "" in it is a quotation mark. A byte order mark, empty lines and lines
/// that begin with # are left out; a cell ends with its line. Throws InputError, naming file and
/// line, for a missing file and for a quotation that does not end with its cell.
class CsvReader {
 public:
  explicit CsvReader(const std::filesystem::path& path);

  /// The next line with cells; false at the end of the file.
  bool next(CsvLine& line);

 private:
  std::string path_;
  std::ifstream file_;
  int number_ = 0;
  std::string text_;
};

/// A line by the names of its columns.
class CsvRow {
 public:
  /// All of which must live as long.
  CsvRow(const std::string& file, const std::vector<std::string>& names, const CsvLine& line)
      : file_(file), names_(names), line_(line) {}

  /// Empty where there is no such column or nothing in it.
  const std::string& text(const char* name) const;
  bool has(const char* name) const { return !text(name).empty(); }
  /// Throws InputError, naming file and line, for what is no number from low to high.
  double number(const char* name, double low, double high) const;
  /// The same; nothing where nothing stands.
  std::optional<double> number_if_any(const char* name, double low, double high) const;
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  const std::string& file_;
  const std::vector<std::string>& names_;
  const CsvLine& line_;
};

/// All lines of a file.
std::vector<CsvLine> read_csv_file(const std::filesystem::path& path);

/// The cells of one line, as above; messages begin with `where`.
std::vector<std::string> split_csv_line(std::string_view text, const std::string& where);

}  // namespace screed
