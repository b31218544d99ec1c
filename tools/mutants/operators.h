// Where a source can be mutated, and how: as an edit of its own, and as a switch that is compiled
// in beside all others.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace screed::mutants {

/// Bytes [begin, end) of a source become `text`.
struct Edit {
  std::size_t begin;
  std::size_t end;
  std::string text;
};

struct Mutant {
  Edit edit;
  std::string name;  ///< of the operator, with its number when it makes several: "constant.2"
};

/// Text before and behind a part of the source. @0 and @1 stand for the numbers of a site's
/// mutants.
struct Wrap {
  std::size_t begin;
  std::size_t end;
  std::string before;
  std::string behind;
};

/// One place and its mutants, which share a switch.
struct Site {
  std::vector<Mutant> mutants;
  std::vector<Wrap> wraps;
  std::vector<Edit> replacements;
  std::size_t first_number = 0;  ///< of its mutants, counted from 1 through the source
  std::size_t function = 0;      ///< offset of the body that it lies in; 0: in none
  std::string constant;          ///< the constexpr name whose declaration it lies in, or ""
};

/// A constexpr declaration: with a switch in it, it is one no longer.
struct Constant {
  std::string name;
  std::size_t begin;  ///< of the word constexpr
  std::size_t end;    ///< behind the declaration
  bool is_function;
};

struct Mutations {
  std::vector<Site> sites;  ///< in the order of the source
  std::vector<Constant> constants;
};

Mutations find_mutations(std::string_view source);

std::string with_edit(std::string_view source, const Edit& edit);

/// The source with the switches of all sites but the `alone` ones; the constants named in `kept`
/// stay constexpr, and the sites in them are left alone too. As many lines as the source. `first`
/// is added to the mutants' numbers.
std::string with_switches(std::string_view source, const Mutations& mutations,
                          const std::set<std::size_t>& alone, const std::set<std::string>& kept,
                          std::size_t first = 0);

/// The number's text with other values.
std::vector<std::string> other_numbers(std::string_view number);

}  // namespace screed::mutants
