// Decoded messages as tables: one CSV file a message, a row a frame, units in the header.
//
//   time [s],robot,roll [deg],pitch [deg],heading [deg]
//   12.340000,1,-0.25,3.10,271.44
//
// Numbers have all decimals of their scale, so that nothing is rounded. Named values stand by their
// names, flags as 0 and 1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/track_slip.h"

namespace screed {

class CsvTables {
 public:
  /// Writes into `folder`, which is made when it is not there; tables of the same names are
  /// replaced. numbers: named values as numbers. Throws RunError when the folder cannot be made.
  CsvTables(const std::filesystem::path& folder, bool numbers);

  /// Throws RunError when a file cannot be written.
  void add(const DecodedFrame& frame);

  /// Writes what is left and gives the tables their names, which they do not have before; RunError
  /// as above. Returns the names of the files, in the order of the schema.
  std::vector<std::string> finish();

 private:
  struct Table {
    std::unique_ptr<AtomicFile> file;
    std::string path;
    std::vector<char> buffer;
    size_t used = 0;
    std::vector<const SignalInfo*> columns;
    size_t longest_row = 0;
  };
  void open(Table& table, const MessageInfo& message) const;
  static void flush(Table& table);

  std::filesystem::path folder_;
  bool numbers_;
  std::vector<Table> tables_;  ///< a table a message of the schema
};

// Slip of both tracks over a log as a CSV table beside those of the messages: track_slip.csv, a row
// a message POSITION of a robot that tells enough (track_slip.h).
//
//   time [s],robot,slip_left [1],slip_right [1]
//   12.250000,1,0.183,
//
// A track that hardly runs has no slip: its cell is empty.

class TrackSlipTable {
 public:
  /// Into `folder`, which exists. All robots of the log are of that board.
  TrackSlipTable(const std::filesystem::path& folder, const BoardConstants& board);

  /// Throws RunError when the file cannot be written.
  void add(const DecodedFrame& frame);

  /// Gives the file its name, which it does not have before; RunError as above. Returns the name;
  /// nothing, and no file, when the log had no row.
  std::optional<std::string> finish();

 private:
  std::filesystem::path path_;
  const BoardConstants& board_;
  std::map<std::uint8_t, TrackSlipEstimate> robots_;  ///< by node
  std::unique_ptr<AtomicFile> file_;
};

}  // namespace screed
