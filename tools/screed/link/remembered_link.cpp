// The remembered link: reading and writing its file.
#include "tools/screed/link/remembered_link.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "tools/screed/cli/number_text.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// The keys of the file.
struct TextKey {
  const char* name;
  std::optional<std::string> LinkArguments::*value;
  bool is_file;
};
constexpr TextKey kTexts[] = {
    {"port", &LinkArguments::port, true},
    {"can", &LinkArguments::can, false},
    {"pty", &LinkArguments::pty, true},
    {"key", &LinkArguments::key, true},
};
struct NumberKey {
  const char* name;
  std::optional<int> LinkArguments::*value;
};
constexpr NumberKey kNumbers[] = {
    {"baud", &LinkArguments::baud},
    {"api", &LinkArguments::api},
};

/// False: there is no such key, or its value is not allowed.
bool take(LinkArguments& link, const IniEntry& entry) {
  if (entry.section != "link" || entry.value.empty()) return false;
  for (const TextKey& key : kTexts) {
    if (entry.key != key.name) continue;
    link.*key.value = entry.value;
    return true;
  }
  for (const NumberKey& key : kNumbers) {
    if (entry.key != key.name) continue;
    link.*key.value = finite_number<int>(entry.value);
    return (link.*key.value).has_value();
  }
  return false;
}

}  // namespace

fs::path remembered_link_file() {
  const char* const config = std::getenv("XDG_CONFIG_HOME");
  const char* const home = std::getenv("HOME");
  const fs::path folder = config != nullptr ? config : "";
  if (folder.is_absolute()) return folder / "screed" / "link.ini";
  if (home == nullptr || *home == '\0') return {};
  return fs::path(home) / ".config" / "screed" / "link.ini";
}

LinkArguments read_remembered_link(const fs::path& file) {
  LinkArguments link;
  std::error_code error;
  if (file.empty() || !fs::exists(file, error)) return link;
  std::ifstream input(file);
  std::stringstream text;
  text << input.rdbuf();
  if (!input) throw InputError(file.string() + ": cannot be read");
  for (const IniEntry& entry : read_ini_text(text.str(), file.string())) {
    if (take(link, entry)) continue;
    std::string message = file.string();
    message += ":" + std::to_string(entry.line) + ": '" + entry.key + " = " + entry.value;
    throw InputError(message +
                     "' is not allowed; allowed are port, can, pty, baud, api and key in [link]; "
                     "screed writes the file anew with --remember");
  }
  return link;
}

void write_remembered_link(const fs::path& file, const LinkArguments& link) {
  if (file.empty()) throw InputError("--remember: neither XDG_CONFIG_HOME nor HOME is set");
  std::string text =
      "# Used by calls of screed that name no link; written by --remember.\n[link]\n";
  for (const TextKey& key : kTexts) {
    const std::optional<std::string>& value = link.*key.value;
    if (!value.has_value()) continue;
    text += key.name;
    text +=
        " = " + (key.is_file ? fs::absolute(*value).lexically_normal().string() : *value) + "\n";
  }
  for (const NumberKey& key : kNumbers) {
    if (!(link.*key.value).has_value()) continue;
    text += key.name;
    text += " = " + std::to_string(*(link.*key.value)) + "\n";
  }
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  write_file(file, text);
}

std::string remembered_link_text(const LinkArguments& link) {
  std::string text;
  for (const TextKey& key : kTexts) {
    const std::optional<std::string>& value = link.*key.value;
    if (!value.has_value()) continue;
    text += text.empty() ? "" : ", ";
    text += key.name;
    text += " " + *value;
  }
  return text;
}

}  // namespace screed
