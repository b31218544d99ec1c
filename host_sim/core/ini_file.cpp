// INI files through inih.
#include "host_sim/core/ini_file.h"

#include <ini.h>

#include <algorithm>
#include <fstream>
#include <istream>
#include <sstream>
#include <system_error>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

// inih hands over no line numbers, but asks for the file line by line: this counts them.
struct Reading {
  std::istream& input;
  std::string name;
  int line = 0;
  std::vector<IniEntry> entries;
  std::string complaint;  // exceptions must not pass through C code

  /// About the line that was read last; reading ends there.
  void fail(const std::string& what) {
    complaint = name + ":" + std::to_string(line) + ": " + what;
  }
};

/// True when a section's line goes on after its bracket with more than a comment; inih would not
/// look at that.
bool has_more_than_section(const std::string& line) {
  const size_t bracket = line.find(']');
  if (line.empty() || line[0] != '[' || bracket == std::string::npos) return false;
  const size_t more = line.find_first_not_of(" \t\r", bracket + 1);
  return more != std::string::npos && line[more] != ';' && line[more] != '#';
}

char* read_line(char* buffer, int size, void* stream) {
  auto& reading = *static_cast<Reading*>(stream);
  std::string text;
  if (!reading.complaint.empty() || !std::getline(reading.input, text)) return nullptr;
  ++reading.line;
  // inih joins indented lines to the value before them; in an experiment file an indented line is a
  // line.
  text.erase(0, text.find_first_not_of(" \t\r"));
  if (text.size() + 2 > static_cast<size_t>(size)) {
    reading.fail("line too long; at most " + std::to_string(size - 2) + " characters");
    return nullptr;
  }
  if (has_more_than_section(text)) {
    reading.fail("text behind [section]; a key stands in a line of its own");
    return nullptr;
  }
  text.push_back('\n');
  *std::copy(text.begin(), text.end(), buffer) = '\0';
  return buffer;
}

int take_entry(void* user, const char* section, const char* name, const char* value) {
  auto& reading = *static_cast<Reading*>(user);
  const auto same = std::find_if(
      reading.entries.begin(), reading.entries.end(),
      [&](const IniEntry& entry) { return entry.section == section && entry.key == name; });
  if (same != reading.entries.end()) {
    const std::string where =
        *section == '\0' ? " before the first section" : std::string(" in [") + section + "]";
    reading.fail(std::string("key '") + name + "' is given twice" + where + ", first in line " +
                 std::to_string(same->line));
    return 1;
  }
  // inih takes only ';' for a comment behind a value.
  std::string text = value;
  for (size_t hash = text.find('#'); hash != std::string::npos; hash = text.find('#', hash + 1)) {
    if (hash == 0 || text[hash - 1] == ' ' || text[hash - 1] == '\t') text.erase(hash);
  }
  text.erase(text.find_last_not_of(" \t\r") + 1);
  reading.entries.push_back({section, name, text, reading.line});
  return 1;
}

std::vector<IniEntry> read_stream(std::istream& input, const std::string& name) {
  Reading reading{input, name, 0, {}, {}};
  const int bad_line = ini_parse_stream(read_line, &reading, take_entry, &reading);
  // Our own complaint ends the reading, so a line that inih could not make sense of came before it.
  if (bad_line > 0) {
    throw InputError(name + ":" + std::to_string(bad_line) +
                     ": neither [section] nor 'key = value' nor a comment");
  }
  if (!reading.complaint.empty()) throw InputError(reading.complaint);
  if (bad_line < 0) throw InputError(name + ": cannot be read");
  return std::move(reading.entries);
}

}  // namespace

std::vector<IniEntry> read_ini_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path.string() + ": is a folder, not an experiment file");
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": no such experiment file, or it cannot be read");
  return read_stream(file, path.string());
}

std::vector<IniEntry> read_ini_text(const std::string& text, const std::string& name) {
  std::istringstream input(text);
  return read_stream(input, name);
}

IniEntry parse_override(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError("--set " + text + ": expected section.key=value");
  }
  const auto trim = [](std::string part) {
    part.erase(0, part.find_first_not_of(" \t"));
    part.erase(part.find_last_not_of(" \t") + 1);
    return part;
  };
  IniEntry entry;
  const std::string name = trim(text.substr(0, equals));
  const size_t dot = name.find('.');
  entry.section = dot == std::string::npos ? "" : name.substr(0, dot);
  entry.key = dot == std::string::npos ? name : name.substr(dot + 1);
  entry.value = trim(text.substr(equals + 1));
  return entry;
}

std::string entry_place(const std::filesystem::path& path, const IniEntry& entry) {
  return path.string() + ":" + std::to_string(entry.line) + ": [" + entry.section + "] " +
         entry.key;
}

}  // namespace screed
