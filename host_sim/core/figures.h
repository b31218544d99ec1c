// What a command found out, as one list of figures: a Json, which programs read, and from which the
// sentences and tables are filled that people read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "host_sim/core/json.h"

namespace screed {

/// The pattern with figures in place of what stands in braces: {NAME*FACTOR:FORM}, as in
/// "{time_s:.1f} s, {battery.charge*100:6.1f} %, {name:-20s}".
///
/// NAME is a member, behind points one of its members, or the place in a list, from 0; empty: the
/// next one of the list, or of what is no list the value itself. Of a number FACTOR makes another
/// unit. FORM is printf's between % and its letter: f, e or g of a number, s of anything as its
/// text. Without FORM: a text as it is, all else as JSON writes it. Throws JsonError for what is
/// not there.
std::string filled(std::string_view pattern, const Json& figures);
template <class... Figures>
std::string filled(std::string_view pattern, const Figures&... figures) {
  return filled(pattern, Json::array({Json(figures)...}));
}

/// The same on standard output.
void print(std::string_view pattern, const Json& figures);
template <class... Figures>
void print(std::string_view pattern, const Figures&... figures) {
  print(pattern, Json::array({Json(figures)...}));
}

/// "1 run", "2 runs"; of words whose plural ends in s.
std::string counted(std::uint64_t count, std::string_view one);

/// On standard output, as a result that programs read. A path need not be UTF-8, JSON must: what is
/// wrong becomes U+FFFD.
void print_json(const Json& json, int indent = 2);

}  // namespace screed
