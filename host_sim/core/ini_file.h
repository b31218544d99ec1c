// An INI file as a list of its entries with their line numbers. Knows nothing of which keys mean
// what.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace screed {

struct IniEntry {
  std::string section;  ///< "" before the first section
  std::string key;
  std::string value;  ///< without the spaces around it and without a comment
  int line = 0;       ///< 1-based; 0 for an entry from the command line
};

/// Where an entry stands, for messages: "leveling.ini:7: [grid] soil.preset".
std::string entry_place(const std::filesystem::path& path, const IniEntry& entry);

/// Reads a file: [sections], key = value, comments after ; or #. Throws InputError, naming file and
/// line, for a missing file, a line that is neither of these, and a key that is given twice.
std::vector<IniEntry> read_ini_file(const std::filesystem::path& path);
/// The same from a text; messages call it `name`.
std::vector<IniEntry> read_ini_text(const std::string& text, const std::string& name);

/// "section.key=value", as on the command line; a key without a section stands before the first.
/// Throws InputError.
IniEntry parse_override(const std::string& text);

}  // namespace screed
