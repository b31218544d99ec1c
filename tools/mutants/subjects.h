// The sources that are mutated, each with its mutants.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tools/mutants/builder.h"
#include "tools/mutants/operators.h"
#include "tools/mutants/tables.h"

namespace screed::mutants {

enum class Fate { kUnknown, kKilled, kSurvived, kInvalid, kEquivalent };

/// A mutant of a source.
struct Candidate {
  std::size_t site;
  std::size_t number;  ///< in its source, from 1
  Mutant mutant;
  Change change;
  std::string id;  ///< "line:column:operator"
  Fate fate = Fate::kUnknown;
  std::string detail;  ///< the test that kills it, or the reason why none can
};

struct Subject {
  Target target;
  std::string text;
  Mutations mutations;
  std::vector<Candidate> candidates;
  std::size_t first = 0;  ///< its number 0 among those of all sources of a campaign
  // What is built of it:
  std::filesystem::path folder;
  Objects objects{};
  std::set<std::size_t> alone;
  std::set<std::string> kept;
};

/// The sources of the first table with all their mutants, those of the second one marked. Throws
/// std::runtime_error where a row names no source or an entry no mutant.
std::vector<Subject> read_subjects(const std::filesystem::path& targets,
                                   const std::filesystem::path& equivalents);

/// So many of its mutants, by a hash: a larger sample of the same seed contains a smaller one.
void draw_sample(Subject& subject, std::size_t size, unsigned seed);

}  // namespace screed::mutants
