// What is mutated (targets.txt) and which mutants behave as the original does (equivalent.txt).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/mutants/operators.h"

namespace screed::mutants {

struct Target {
  std::string source;       ///< relative to the root
  double bound;             ///< least share of killed mutants, per cent
  std::size_t sample = 0;   ///< as many of its mutants; 0: all
  std::string tests = "*";  ///< filter of tests, as GoogleTest understands it
};

/// A mutant that no test can kill: the source's file name, its lines before and after, and why.
struct Equivalent {
  std::string file;
  std::string before;
  std::string after;
  std::string reason;
  std::size_t line;  ///< of the table
};

/// Lines "GLOB BOUND [sample=N] [tests=FILTER]", of which the last one of a source holds; # begins
/// a comment. Throws std::runtime_error with file and line.
std::vector<Target> read_targets(const std::filesystem::path& table,
                                 const std::filesystem::path& root);

/// Groups of four lines: "file NAME", "- LINE", "+ LINE", "= REASON". Throws likewise.
std::vector<Equivalent> read_equivalents(const std::filesystem::path& table);

/// The lines that an edit touches, joined, with single spaces; before and after it.
struct Change {
  std::size_t line;    ///< of the edit's first byte, from 1
  std::size_t column;  ///< from 1
  std::string before;
  std::string after;
};
Change change_of(std::string_view source, const Edit& edit);

/// The reason of the table for this mutant, or nullptr.
const Equivalent* equivalent(const std::vector<Equivalent>& table, const std::string& source,
                             const Change& change);

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& text);
/// FNV-1a, hexadecimal.
std::string hash(std::string_view text);

}  // namespace screed::mutants
