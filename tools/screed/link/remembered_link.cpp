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
  const NumberRange& range;
};
constexpr NumberKey kNumbers[] = {
    {"baud", &LinkArguments::baud, kBaudRange},
    {"api", &LinkArguments::api, kApiRange},
};

constexpr char kAllowedKeys[] = "port, can, pty, baud, api and key in [link]";

/// What is allowed in place of the entry; nothing: it is taken.
std::optional<std::string> take(LinkArguments& link, const IniEntry& entry) {
  if (entry.section != "link" || entry.value.empty()) return kAllowedKeys;
  for (const TextKey& key : kTexts) {
    if (entry.key != key.name) continue;
    link.*key.value = entry.value;
    return std::nullopt;
  }
  for (const NumberKey& key : kNumbers) {
    if (entry.key != key.name) continue;
    const std::optional<int> number = finite_number<int>(entry.value);
    if (!number.has_value() || !key.range.contains(*number)) {
      return "whole numbers " + plain_text(key.range.low) + " to " + plain_text(key.range.high);
    }
    link.*key.value = number;
    return std::nullopt;
  }
  return kAllowedKeys;
}

constexpr char kWrittenAnew[] = "; screed writes the file anew with --remember";

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
    const std::optional<std::string> allowed = take(link, entry);
    if (!allowed.has_value()) continue;
    std::string message = file.string();
    message += ":" + std::to_string(entry.line) + ": '" + entry.key + " = " + entry.value;
    throw InputError(message + "' is not allowed; allowed are " + *allowed + kWrittenAnew);
  }
  if (links_named(link) > 1) {
    throw InputError(file.string() + ": names several links; allowed is one of port, can and pty" +
                     kWrittenAnew);
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
