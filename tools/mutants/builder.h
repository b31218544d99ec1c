// Compiles mutated copies of sources and links the programs that hold tests with them. What a build
// is made of stands in the files that mutants.mk writes: PROGRAM.link, the linker's arguments, and
// firmware.sources.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tools/mutants/operators.h"

namespace screed::mutants {

/// Objects of mutated sources, in place of those of the build.
struct Objects {
  bool compiled;
  std::string said;                                          ///< by the compiler
  std::vector<std::pair<std::string, std::string>> objects;  ///< original path, mutated path
};

class Builder {
 public:
  /// `build`: folder of the objects; `work`: of mutants.
  Builder(std::filesystem::path build, std::filesystem::path work, bool unit_only = false);

  /// Those that hold tests, and the one that they run.
  const std::vector<std::string>& programs() const { return programs_; }

  /// The source with this text, or when it is a header every source that includes it, in `folder`.
  Objects compile(const std::string& source, const std::string& text,
                  const std::filesystem::path& folder,
                  const std::vector<std::string>& options) const;
  /// Links a program; false when it does not link.
  bool link(const std::string& program, const std::vector<Objects>& objects,
            const std::filesystem::path& result) const;
  /// All switches of a source that compile: the others go to `alone`, with constants that must stay
  /// constants in `kept`. `text` is the source with them.
  Objects compile_switches(const std::string& source, const Mutations& mutations,
                           const std::filesystem::path& folder, std::set<std::size_t>& alone,
                           std::set<std::string>& kept, std::string& text) const;
  /// Time of the newest program of the build.
  std::filesystem::file_time_type newest_program() const;

 private:
  std::vector<std::string> units_of(const std::string& source) const;

  std::filesystem::path build_;
  std::filesystem::path work_;
  std::set<std::string> firmware_;
  std::vector<std::string> programs_;
};

}  // namespace screed::mutants
