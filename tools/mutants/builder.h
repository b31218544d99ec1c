// Compiles mutated copies of sources and links the programs that hold tests with them. What a build
// is made of stands in the files that mutants.mk writes: PROGRAM.link, the linker's arguments;
// library.objects, what the library in them is made of; firmware.sources. The compiler's own notes
// (.d) say which source is in which object, on its own or with others.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/mutants/operators.h"
#include "tools/mutants/process.h"

namespace screed::mutants {

/// What the compiler makes one object of.
struct Unit {
  std::string object;
  std::string source;                 ///< what is compiled
  std::vector<std::string> included;  ///< the source itself and all that it includes
};

/// The unit of a compiler's notes, "OBJECT: SOURCE INCLUDED...".
Unit unit_of(const std::string& notes);

/// Objects of mutated sources, in place of those of the build.
struct Objects {
  bool compiled;
  std::string said;                                          ///< by the compiler
  std::vector<std::pair<std::string, std::string>> objects;  ///< original path, mutated path
};

class Builder {
 public:
  /// `build`: folder of the flags; `work`: of mutants. Throws std::runtime_error with the name of
  /// what is missing.
  Builder(std::filesystem::path build, std::filesystem::path work, bool unit_only);

  /// Those that hold tests, unit_tests first, and behind others the one that they run.
  const std::vector<std::string>& programs() const { return programs_; }

  /// The objects that this source, or header, is in; throws when it is in none.
  std::vector<Unit> units_of(const std::string& source) const;
  /// A unit with the sources in `folder` in place of the tree's.
  Objects compile(const Unit& unit, const std::filesystem::path& folder,
                  const std::filesystem::path& object,
                  const std::vector<std::string>& options) const;
  /// All units of the source with this text, in `folder`, which holds no other source.
  Objects compile(const std::string& source, const std::string& text,
                  const std::filesystem::path& folder) const;
  Ended link(const std::string& program, const Objects& mutated,
             const std::filesystem::path& result) const;
  /// All switches of a source that compile: the others go to `alone`, with constants that must stay
  /// constants in `kept`.
  Objects compile_switches(const std::string& source, const Mutations& mutations,
                           const std::filesystem::path& folder, std::set<std::size_t>& alone,
                           std::set<std::string>& kept) const;
  /// Time of the newest object of the build.
  std::filesystem::file_time_type newest_object() const { return newest_; }

 private:
  void read_programs(bool unit_only);
  void read_units();

  std::filesystem::path build_;
  std::filesystem::path work_;
  std::set<std::string> firmware_;
  std::set<std::string> library_;
  std::vector<std::string> programs_;
  std::map<std::string, std::vector<std::string>> arguments_;  // of the linker, by program
  std::vector<Unit> units_;
  std::filesystem::file_time_type newest_{};
};

}  // namespace screed::mutants
