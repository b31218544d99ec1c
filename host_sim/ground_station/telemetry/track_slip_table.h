// Slip of both tracks over a log as a CSV table beside those of the messages: track_slip.csv, a row
// a message POSITION of a robot that tells enough (track_slip.h).
//
//   time [s],robot,slip_left [1],slip_right [1]
//   12.250000,1,0.183,
//
// A track that hardly runs has no slip: its cell is empty.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "firmware/parameters/board_constants.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/ground_station/telemetry/log_decoder.h"
#include "host_sim/ground_station/telemetry/track_slip.h"

namespace screed {

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
