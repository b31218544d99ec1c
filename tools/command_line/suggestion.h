// "Did you mean": the word that a mistyped one is nearest to.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace screed {

/// How many letters must be put in, left out, changed, or changed over with the next one, to make
/// `b` of `a` (Damerau 1964, no letter twice).
inline std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> last;
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  std::vector<std::size_t> next(b.size() + 1);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, changed});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) next[j] = std::min(next[j], last[j - 2] + 1);
    }
    last = row;
    row = next;
  }
  return row.back();
}

/// The nearest of `words`, the first of equals; empty where none differs by at most a third of its
/// letters.
inline std::string nearest_word(const std::string& mistyped,
                                const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = 0;
  for (const std::string& word : words) {
    const std::size_t distance = edit_distance(mistyped, word);
    if (distance > std::max<std::size_t>(1, word.size() / 3)) continue;
    if (nearest.empty() || distance < least) {
      nearest = word;
      least = distance;
    }
  }
  return nearest;
}

}  // namespace screed
