// The keys that a file may have, as --keys prints them.
#pragma once

#include <cstddef>
#include <string>

namespace screed {

/// `rows`: lines "| key | unit | default | allowed | meaning |". On a terminal an aligned table as
/// wide as it, for people; elsewhere a Markdown table of these very rows, for programs and pages.
void print_key_table(const std::string& rows);

/// The aligned table, no wider than so many letters where its columns allow it.
std::string aligned_key_table(const std::string& rows, std::size_t width);

}  // namespace screed
