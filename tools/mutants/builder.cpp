#include "tools/mutants/builder.h"

#include <algorithm>
#include <cstdio>
#include <regex>
#include <sstream>
#include <stdexcept>

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

[[noreturn]] void refuse_unbuilt(const std::string& object, const std::string& program) {
  throw std::runtime_error(object + ", of which " + program + " is linked, is not built");
}

bool lists(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
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

/// Whether the word stands in one of these lines.
bool is_named(const std::string& word, const std::string& text,
              const std::set<std::size_t>& lines) {
  const std::regex pattern("\\b" + word + "\\b");
  std::size_t number = 0;
  for (const std::string& line : lines_of(text)) {
    if (lines.contains(++number) && std::regex_search(line, pattern)) return true;
  }
  return false;
}

}  // namespace

Unit unit_of(const std::string& notes) {
  Unit unit;
  std::string rule = notes;
  for (std::size_t at = rule.find("\\\n"); at != std::string::npos; at = rule.find("\\\n")) {
    rule.replace(at, 2, " ");
  }
  // The rules behind it, one for every header, let make do without them.
  const std::vector<std::string> words = words_of(rule.substr(0, rule.find('\n')));
  if (words.size() < 2 || !words[0].ends_with(":")) return unit;
  unit.object = words[0].substr(0, words[0].size() - 1);
  unit.source = words[1];
  unit.included.assign(words.begin() + 1, words.end());
  return unit;
}

Builder::Builder(fs::path build, fs::path work, bool unit_only)
    : build_(std::move(build)), work_(std::move(work)) {
  for (const std::string& source : words_of(read_file(work_ / "firmware.sources"))) {
    firmware_.insert(source);
  }
  for (const std::string& object : words_of(read_file(work_ / "library.objects"))) {
    library_.insert(object);
  }
  read_programs(unit_only);
  read_units();
}

void Builder::read_programs(bool unit_only) {
  for (const auto& entry : fs::directory_iterator(work_)) {
    if (entry.path().extension() != ".link") continue;
    const std::string program = entry.path().stem();
    arguments_[program] = words_of(read_file(entry.path()));
    if (program.ends_with("_tests") && (!unit_only || program == "unit_tests"))
      programs_.push_back(program);
  }
  // The quickest tests first.
  std::stable_partition(programs_.begin(), programs_.end(),
                        [](const std::string& program) { return program == "unit_tests"; });
  if (!unit_only) programs_.emplace_back("screed");
  for (const char* program : {"unit_tests", "screed"}) {
    if (arguments_.contains(program)) continue;
    throw std::runtime_error((work_ / program).string() + ".link is missing: use `make mutants`");
  }
}

void Builder::read_units() {
  std::set<std::string> objects = library_;
  for (const std::string& program : programs_) {
    for (const std::string& word : arguments_.at(program)) {
      if (!word.ends_with(".o") && !word.ends_with(".a")) continue;
      if (!fs::exists(word)) refuse_unbuilt(word, program);
      if (word.ends_with(".o")) objects.insert(word);
    }
  }
  for (const std::string& object : objects) {
    const fs::path notes = fs::path(object).replace_extension(".d");
    if (!fs::exists(object) || !fs::exists(notes)) {
      throw std::runtime_error(object + ", of which the tests are linked, or its .d is not built");
    }
    newest_ = std::max(newest_, fs::last_write_time(object));
    units_.push_back(unit_of(read_file(notes)));
    if (units_.back().object == object) continue;
    throw std::runtime_error(notes.string() + " does not say what " + object + " is made of");
  }
}

std::vector<Unit> Builder::units_of(const std::string& source) const {
  std::vector<Unit> units;
  std::copy_if(units_.begin(), units_.end(), std::back_inserter(units),
               [&](const Unit& unit) { return lists(unit.included, source); });
  if (units.empty()) throw std::runtime_error("no object of the tests is made of " + source);
  return units;
}

Objects Builder::compile(const Unit& unit, const fs::path& folder, const fs::path& object,
                         const std::vector<std::string>& options) const {
  fs::create_directories(object.parent_path());
  const bool is_firmware =
      std::any_of(unit.included.begin(), unit.included.end(),
                  [&](const std::string& file) { return firmware_.contains(file); });
  std::vector<std::string> command{
      "g++", "-I" + folder.string(),
      "@" + (build_ / (is_firmware ? "firmware.flags" : "host.flags")).string()};
  for (const char* option : {"-w", "-fno-diagnostics-show-caret", "-fmax-errors=0", "-include",
                             "tools/mutants/mutant_switch.h"}) {
    command.emplace_back(option);
  }
  command.insert(command.end(), options.begin(), options.end());
  // A header, or a source that is compiled with others, is found in the folder by the compiler.
  const fs::path copy = folder / unit.source;
  command.insert(command.end(),
                 {"-c", fs::exists(copy) ? copy.string() : unit.source, "-o", object.string()});
  const fs::path output = fs::path(object).replace_extension(".txt");
  Ended ended = run(command, {{"LC_ALL", "C"}}, 0.0, output);
  if (!ended.good && ended.said.find("internal compiler error") != std::string::npos) {
    // GCC 12 breaks off where vectors of numbers are chosen by switches.
    command.emplace_back("-O0");
    ended = run(command, {{"LC_ALL", "C"}}, 0.0, output);
  }
  if (!ended.good) return {false, ended.said, {}};
  return {true, "", {{unit.object, object.string()}}};
}

Objects Builder::compile(const std::string& source, const std::string& text,
                         const fs::path& folder) const {
  write_file(folder / source, text);
  Objects all{true, "", {}};
  for (const Unit& unit : units_of(source)) {
    Objects one = compile(unit, folder, folder / unit.object, {});
    if (!one.compiled) return one;
    all.objects.push_back(one.objects.front());
  }
  return all;
}

Ended Builder::link(const std::string& program, const Objects& mutated,
                    const fs::path& result) const {
  fs::create_directories(result.parent_path());
  std::vector<std::string> command{"g++"};
  if (run({"ld.lld", "--version"}, {}, 0.0, result.string() + ".txt").good) {
    command.emplace_back("-fuse-ld=lld");
  }
  std::vector<std::string> arguments = arguments_.at(program);
  for (const auto& [original, object] : mutated.objects) {
    const auto at = std::find(arguments.begin(), arguments.end(), original);
    if (at != arguments.end()) {
      *at = object;
    } else if (library_.contains(original)) {
      command.push_back(object);  // before the library, which then does not add its own
    }
  }
  command.push_back((work_ / "mutant_switch.o").string());
  if (program != "screed") command.push_back((work_ / "reach_listener.o").string());
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.insert(command.end(), {"-o", result.string()});
  return run(command, {}, 0.0, result.string() + ".txt");
}

Objects Builder::compile_switches(const std::string& source, const Mutations& mutations,
                                  const fs::path& folder, std::set<std::size_t>& alone,
                                  std::set<std::string>& kept) const {
  const std::string original = read_file(source);
  for (;;) {
    Objects objects = compile(source, with_switches(original, mutations, alone, kept), folder);
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
    // Sizes of arrays and the like: no message names the constants in them.
    if (alone.size() + kept.size() == known) {
      for (const Constant& constant : mutations.constants) {
        if (is_named(constant.name, original, lines)) kept.insert(constant.name);
      }
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

}  // namespace screed::mutants
