// The schema compiler: reads a DBC file, refuses what it does not allow, and writes what is made of
// it. Exit codes: 0 done, 1 a file could not be written, 2 the schema is wrong.
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/schema/code.h"
#include "tools/schema/documentation.h"
#include "tools/schema/schema_check.h"

namespace screed::schema {
namespace {

constexpr const char* kUsage =
    "usage: schema_compiler SCHEMA.dbc [--values FILE] [--class-values FILE] [--classes FILE]\n"
    "                       [--messages FILE] [--tables FILE] [--wireshark FOLDER]\n"
    "                       [--document FILE] [--check-document FILE]\n"
    "  --values      C++ enumerations of names of values and of flags\n"
    "  --class-values  those of values that name classes (attribute ClassFolder)\n"
    "  --classes     the #include lines of classes that values name (attribute ClassFolder)\n"
    "  --messages    C++ structures with pack() and unpack()\n"
    "  --tables      C++ tables for the host\n"
    "  --wireshark   a configuration profile for Wireshark and tshark\n"
    "  --document    renews the tables in a page\n"
    "  --check-document  fails when they are not up to date\n";

std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Writes a file, unless it says so already: what depends on it is then not built anew.
void write(const std::string& path, const std::string& text) {
  if (content_of(path) == text && std::filesystem::exists(path)) return;
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw RunError(path + ": cannot be written");
}

int run(const std::vector<std::string>& arguments) {
  if (arguments.empty() || arguments.size() % 2 == 0) throw InputError(kUsage);
  const Database database = read_dbc(arguments[0]);
  check_schema(database);
  const std::map<std::string, std::function<void(const std::string&)>> actions = {
      {"--values", [&](const std::string& path) { write(path, value_code(database)); }},
      {"--class-values", [&](const std::string& path) { write(path, class_values(database)); }},
      {"--classes", [&](const std::string& path) { write(path, class_includes(database)); }},
      {"--messages", [&](const std::string& path) { write(path, message_code(database)); }},
      {"--tables", [&](const std::string& path) { write(path, host_tables(database)); }},
      {"--wireshark",
       [&](const std::string& path) {
         for (const auto& [name, text] : wireshark_tables(database)) {
           write((std::filesystem::path(path) / name).string(), text);
         }
       }},
      {"--document",
       [&](const std::string& path) {
         write(path, renewed_page(path, content_of(path), database));
       }},
      {"--check-document",
       [&](const std::string& path) {
         if (renewed_page(path, content_of(path), database) != content_of(path)) {
           throw InputError(path + ": its tables are not those of " + database.file +
                            "; `make telemetry-page` renews them");
         }
       }},
  };
  for (size_t i = 1; i < arguments.size(); i += 2) {
    const auto action = actions.find(arguments[i]);
    if (action == actions.end()) throw InputError(arguments[i] + " is not known\n" + kUsage);
    action->second(arguments[i + 1]);
  }
  return 0;
}

}  // namespace
}  // namespace screed::schema

int main(int argc, char** argv) {
  try {
    return screed::schema::run({argv + 1, argv + argc});
  } catch (const screed::InputError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "schema_compiler: " << error.what() << "\n";
    return 1;
  }
}
