// A CSV file (RFC 4180) as lines of cells with their line numbers. Knows nothing of what columns
// mean.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

struct CsvLine {
  int line = 0;  ///< 1-based, in the file
  std::vector<std::string> cells;
};

/// Reads a file: cells between commas, without the blanks around them; "..." keeps commas and
/// blanks, and "" in it is a quotation mark. Empty lines and lines that begin with # are left out;
/// a cell ends with its line. Throws InputError, naming file and line, for a missing file and for
/// a quotation that does not end with its cell.
std::vector<CsvLine> read_csv_file(const std::filesystem::path& path);

/// The cells of one line, as above; messages begin with `where`.
std::vector<std::string> split_csv_line(std::string_view text, const std::string& where);

}  // namespace screed
