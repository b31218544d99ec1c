#include "tools/mutants/subjects.h"

#include <algorithm>
#include <stdexcept>

namespace screed::mutants {
namespace {

Subject subject_of(const Target& target) {
  Subject subject;
  subject.target = target;
  subject.text = read_file(target.source);
  subject.mutations = find_mutations(subject.text);
  for (std::size_t i = 0; i < subject.mutations.sites.size(); ++i) {
    for (const Mutant& mutant : subject.mutations.sites[i].mutants) {
      Candidate candidate{i,      subject.candidates.size() + 1,
                          mutant, change_of(subject.text, mutant.edit),
                          "",     Fate::kUnknown,
                          ""};
      candidate.id = std::to_string(candidate.change.line) + ":" +
                     std::to_string(candidate.change.column) + ":" + mutant.name;
      subject.candidates.push_back(std::move(candidate));
    }
  }
  return subject;
}

}  // namespace

std::vector<Subject> read_subjects(const std::filesystem::path& targets,
                                   const std::filesystem::path& equivalents) {
  const std::vector<Equivalent> entries = read_equivalents(equivalents);
  std::set<std::size_t> used;
  std::vector<Subject> subjects;
  for (const Target& target : read_targets(targets, std::filesystem::current_path())) {
    subjects.push_back(subject_of(target));
    for (Candidate& candidate : subjects.back().candidates) {
      const Equivalent* entry = equivalent(entries, target.source, candidate.change);
      if (entry == nullptr) continue;
      candidate.fate = Fate::kEquivalent;
      candidate.detail = entry->reason;
      used.insert(entry->line);
    }
  }
  std::string stale;
  for (const Equivalent& entry : entries) {
    if (used.contains(entry.line)) continue;
    stale += "\n" + equivalents.string() + ":" + std::to_string(entry.line) +
             ": no such mutant of " + entry.file + " any more";
  }
  if (!stale.empty()) throw std::runtime_error(stale.substr(1));
  return subjects;
}

void draw_sample(Subject& subject, std::size_t size, unsigned seed) {
  std::vector<Candidate>& all = subject.candidates;
  if (size == 0 || all.size() <= size) return;
  const auto order = [&](const Candidate& candidate) {
    return hash(std::to_string(seed) + candidate.change.before + candidate.change.after +
                candidate.id);
  };
  std::sort(all.begin(), all.end(),
            [&](const Candidate& a, const Candidate& b) { return order(a) < order(b); });
  all.resize(size);
  std::sort(all.begin(), all.end(),
            [](const Candidate& a, const Candidate& b) { return a.number < b.number; });
}

}  // namespace screed::mutants
