// `screed decode LOG --csv|--mcap`: a log of CAN frames as tables or as an MCAP file.
#pragma once

#include <iosfwd>
#include <string>

#include "host_sim/run/experiment/board_table.h"

namespace screed {

struct DecodeOptions {
  std::string log;  ///< as candump -L writes it; "-": standard input
  bool csv = false;
  bool mcap = false;                  ///< one of both
  std::string out;                    ///< folder of the tables, or the file; empty: beside the log
  bool numbers = false;               ///< CSV: named values as numbers
  std::string board = kDefaultBoard;  ///< of the robots, for the slip of their tracks (CSV)
};

/// Decodes what can be read, prints the files written to `out`, and the account of the log to
/// `err`. Returns 0, or 1 when lines or frames of the log were damaged. Throws InputError when the
/// log cannot be opened or the board is not known, RunError when a file cannot be written.
int run_decode(const DecodeOptions& options, std::ostream& out, std::ostream& err);

}  // namespace screed
