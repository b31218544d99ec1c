#include "tools/mutants/builder.h"

#include <algorithm>
#include <cstdio>
#include <regex>
#include <sstream>

#include "tools/mutants/process.h"
#include "tools/mutants/tables.h"

namespace screed::mutants {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool is_header(const std::string& source) {
  return source.ends_with(".h");
}

/// Numbers of the lines of `file` that the compiler's complaints name, and the names that it
/// quotes.
void complaints_of(const std::string& said, const std::string& file, std::set<std::size_t>& lines,
                   std::set<std::string>& names) {
  static const std::regex kPlace(R"(^(?:In file included from )?([^\s:]+):(\d+):(?:\d+:)?(.*)$)");
  static const std::regex kName(
      "['\u2018](?:[^'\u2019]*[ :])?(\\w+)(?:\\([^'\u2019]*\\))?['\u2019]");
  for (const std::string& line : lines_of(said)) {
    std::smatch match;
    if (!std::regex_match(line, match, kPlace)) continue;
    const std::string what = match[3];
    const bool error = what.find("error:") != std::string::npos;
    if (match[1].str().ends_with(file) &&
        (error || what.find("required from") != std::string::npos)) {
      lines.insert(std::stoul(match[2]));
    }
    for (std::sregex_iterator name(what.begin(), what.end(), kName), end; name != end; ++name) {
      names.insert((*name)[1]);
    }
  }
}

}  // namespace

Builder::Builder(fs::path build, fs::path work, bool unit_only)
    : build_(std::move(build)), work_(std::move(work)), programs_{"unit_tests"} {
  if (!unit_only) programs_.insert(programs_.end(), {"sitl_tests", "screed"});
  for (const std::string& source : words_of(read_file(work_ / "firmware.sources"))) {
    firmware_.insert(source);
  }
}

std::vector<std::string> Builder::units_of(const std::string& source) const {
  if (!is_header(source)) return {source};
  std::vector<std::string> units;
  for (const auto& entry : fs::recursive_directory_iterator(build_)) {
    if (entry.path().extension() != ".d") continue;
    const std::vector<std::string> words = words_of(read_file(entry.path()));
    if (std::find(words.begin(), words.end(), source) == words.end()) continue;
    std::string unit =
        fs::path(entry.path().lexically_relative(build_)).replace_extension(".cpp").string();
    if (fs::exists(unit)) units.push_back(unit);
  }
  std::sort(units.begin(), units.end());
  return units;
}

Objects Builder::compile(const std::string& source, const std::string& text, const fs::path& folder,
                         const std::vector<std::string>& options) const {
  write_file(folder / source, text);
  Objects result{true, "", {}};
  for (const std::string& unit : units_of(source)) {
    const std::string object = fs::path(folder / unit).replace_extension(".o").string();
    fs::create_directories(fs::path(object).parent_path());
    const std::string flags = firmware_.contains(unit) ? "firmware.flags" : "host.flags";
    std::vector<std::string> command{"g++", "-I" + folder.string(),
                                     "@" + (build_ / flags).string()};
    for (const char* option : {"-w", "-fno-diagnostics-show-caret", "-fmax-errors=0", "-include",
                               "tools/mutants/mutant_switch.h"}) {
      command.emplace_back(option);
    }
    command.insert(command.end(), options.begin(), options.end());
    const std::string copy = is_header(source) ? unit : (folder / source).string();
    command.insert(command.end(), {"-c", copy, "-o", object});
    Ended ended = run(command, {{"LC_ALL", "C"}}, 0.0, folder / "compiler.txt");
    if (!ended.good && ended.said.find("internal compiler error") != std::string::npos) {
      // GCC 12 breaks off where vectors of numbers are chosen by switches.
      command.emplace_back("-O0");
      ended = run(command, {{"LC_ALL", "C"}}, 0.0, folder / "compiler.txt");
    }
    if (!ended.good) return {false, ended.said, {}};
    result.objects.emplace_back(fs::path(build_ / unit).replace_extension(".o").string(), object);
  }
  return result;
}

bool Builder::link(const std::string& program, const std::vector<Objects>& objects,
                   const fs::path& result) const {
  std::vector<std::string> command{"g++"};
  if (run({"ld.lld", "--version"}, {}, 0.0, result.string() + ".txt").good) {
    command.emplace_back("-fuse-ld=lld");
  }
  std::vector<std::string> arguments = words_of(read_file(work_ / (program + ".link")));
  for (const Objects& mutated : objects) {
    for (const auto& [original, object] : mutated.objects) {
      const auto at = std::find(arguments.begin(), arguments.end(), original);
      if (at != arguments.end()) {
        *at = object;
      } else if (original.find("/tests/") == std::string::npos && !original.ends_with("main.o")) {
        command.push_back(object);  // before the library, which then does not add its own
      }
    }
  }
  command.push_back((work_ / "mutant_switch.o").string());
  if (program != "screed") command.push_back((work_ / "reach_listener.o").string());
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.insert(command.end(), {"-o", result.string()});
  fs::create_directories(result.parent_path());
  return run(command, {}, 0.0, result.string() + ".txt").good;
}

Objects Builder::compile_switches(const std::string& source, const Mutations& mutations,
                                  const fs::path& folder, std::set<std::size_t>& alone,
                                  std::set<std::string>& kept, std::string& text) const {
  const std::string original = read_file(source);
  for (;;) {
    text = with_switches(original, mutations, alone, kept);
    Objects objects = compile(source, text, folder, {});
    if (objects.compiled) return objects;
    std::set<std::size_t> lines;
    std::set<std::string> names;
    complaints_of(objects.said, source, lines, names);
    const std::size_t known = alone.size() + kept.size();
    for (const Constant& constant : mutations.constants) {
      if (names.contains(constant.name)) kept.insert(constant.name);
    }
    // Of a line that does not compile the operators of two operands first: they are choosy.
    for (const bool replaced : {true, false}) {
      for (std::size_t i = 0; i < mutations.sites.size(); ++i) {
        const Site& site = mutations.sites[i];
        if (site.replacements.empty() == replaced || alone.contains(i)) continue;
        const std::size_t first = change_of(original, site.mutants[0].edit).line;
        std::size_t last = first;
        for (const Wrap& wrap : site.wraps) {
          last = std::max(last, change_of(original, {wrap.end - 1, wrap.end, ""}).line);
        }
        const auto at = lines.lower_bound(first);
        if (at == lines.end() || *at > last) continue;
        if (site.constant.empty()) {
          alone.insert(i);
        } else {
          kept.insert(site.constant);
        }
      }
      if (alone.size() + kept.size() != known) break;
    }
    if (alone.size() + kept.size() == known) {
      // Not understood: nothing is switched.
      std::fprintf(stderr, "mutants: %s has no switches: %s\n", source.c_str(),
                   objects.said.c_str());
      if (alone.size() == mutations.sites.size()) return objects;
      for (std::size_t i = 0; i < mutations.sites.size(); ++i) alone.insert(i);
    }
  }
}

fs::file_time_type Builder::newest_program() const {
  fs::file_time_type newest{};
  for (const std::string& program : programs_) {
    for (const std::string& word : words_of(read_file(work_ / (program + ".link")))) {
      if ((word.ends_with(".o") || word.ends_with(".a")) && fs::exists(word))
        newest = std::max(newest, fs::last_write_time(word));
    }
  }
  return newest;
}

}  // namespace screed::mutants
