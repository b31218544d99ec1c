#include "tools/mutants/tables.h"

#include <glob.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace screed::mutants {
namespace {

std::runtime_error wrong(const std::filesystem::path& table, std::size_t line,
                         const std::string& what) {
  return std::runtime_error(table.string() + ":" + std::to_string(line) + ": " + what);
}

std::vector<std::string> files_of(const std::string& pattern, const std::filesystem::path& root) {
  std::vector<std::string> files;
  glob_t found{};
  if (glob((root / pattern).c_str(), 0, nullptr, &found) == 0) {
    for (std::size_t i = 0; i < found.gl_pathc; ++i) {
      files.push_back(std::filesystem::path(found.gl_pathv[i]).lexically_relative(root).string());
    }
  }
  globfree(&found);
  return files;
}

std::string single_spaced(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string result;
  for (std::string word; words >> word;) result += (result.empty() ? "" : " ") + word;
  return result;
}

}  // namespace

std::vector<Target> read_targets(const std::filesystem::path& table,
                                 const std::filesystem::path& root) {
  std::vector<Target> targets;
  std::istringstream lines(read_file(table));
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line.substr(0, line.find('#')));
    std::string pattern;
    if (!(words >> pattern)) continue;
    Target target;
    if (!(words >> target.bound) || target.bound < 0.0 || target.bound > 100.0) {
      throw wrong(table, number, "a bound of 0 to 100 per cent must follow the source");
    }
    for (std::string option; words >> option;) {
      if (option.starts_with("sample=") && std::atoi(option.c_str() + 7) > 0) {
        target.sample = static_cast<std::size_t>(std::atoi(option.c_str() + 7));
      } else if (option.starts_with("tests=")) {
        target.tests = option.substr(6);
      } else {
        throw wrong(table, number, option + ": sample=NUMBER or tests=FILTER");
      }
    }
    const std::vector<std::string> files = files_of(pattern, root);
    if (files.empty()) throw wrong(table, number, pattern + ": no such file");
    for (const std::string& file : files) {
      target.source = file;
      const auto at = std::find_if(targets.begin(), targets.end(),
                                   [&](const Target& before) { return before.source == file; });
      if (at != targets.end()) {
        *at = target;
      } else {
        targets.push_back(target);
      }
    }
  }
  return targets;
}

std::vector<Equivalent> read_equivalents(const std::filesystem::path& table) {
  std::vector<Equivalent> entries;
  std::istringstream lines(read_file(table));
  std::size_t number = 0;
  constexpr std::array<std::string_view, 4> kStarts{"file ", "- ", "+ ", "= "};
  std::size_t part = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.starts_with('#')) {
      if (part != 0) throw wrong(table, number, "the entry before is not complete");
      continue;
    }
    if (!line.starts_with(kStarts.at(part))) {
      throw wrong(table, number, "must begin with '" + std::string(kStarts.at(part)) + "'");
    }
    const std::string rest = single_spaced(line.substr(kStarts.at(part).size()));
    if (part == 0) entries.push_back({rest, "", "", "", number});
    if (part == 1) entries.back().before = rest;
    if (part == 2) entries.back().after = rest;
    if (part == 3) entries.back().reason = rest;
    part = (part + 1) % kStarts.size();
  }
  if (part != 0) throw wrong(table, number, "the last entry is not complete");
  return entries;
}

Change change_of(std::string_view source, const Edit& edit) {
  const std::size_t line_begin = source.rfind('\n', edit.begin) + 1;  // 0 in the first line
  const std::size_t line_end = std::min(source.find('\n', edit.end), source.size());
  Change change;
  change.line = 1;
  for (const char c : source.substr(0, edit.begin)) {
    if (c == '\n') ++change.line;
  }
  change.column = edit.begin - line_begin + 1;
  change.before = single_spaced(source.substr(line_begin, line_end - line_begin));
  change.after =
      single_spaced(std::string(source.substr(line_begin, edit.begin - line_begin)) + edit.text +
                    std::string(source.substr(edit.end, line_end - edit.end)));
  return change;
}

const Equivalent* equivalent(const std::vector<Equivalent>& table, const std::string& source,
                             const Change& change) {
  const std::string name = std::filesystem::path(source).filename().string();
  for (const Equivalent& entry : table) {
    if (entry.file == name && entry.before == change.before && entry.after == change.after) {
      return &entry;
    }
  }
  return nullptr;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string hash(std::string_view text) {
  std::uint64_t value = 14695981039346656037U;
  for (const char c : text) {
    value = (value ^ static_cast<unsigned char>(c)) * 1099511628211U;
  }
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(value));
  return digits.data();
}

}  // namespace screed::mutants
