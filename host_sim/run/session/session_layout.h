// What a session file holds: the run as a whole, names and types of its tables, its hash.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/record.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/height_map.h"

namespace screed {

// What a session says about its run as a whole.

struct SessionInfo {
  std::string program_version;  ///< not part of the content hash
  std::string arithmetic;       ///< of the world (session_layout.h); not part of it either
  std::string experiment_name;  ///< not part of the content hash
  /// the whole INI text that was in force, overrides applied; any size, no NUL byte
  std::string experiment_text;
  std::uint64_t seed = 0;
  std::uint32_t tick_rate_hz = kTickRate_hz;
  std::string board_name;
  BoardConstants board{};
  Parameters parameters;
  Credentials credentials = credentials_of(test_key());
};

// How this program computes worlds.

/// Two programs of one version with one arithmetic give the same bits, on whatever processor.
std::string arithmetic();

/// What a file means that names none: it is older than the names.
inline constexpr char kUnnamedArithmetic[] = "the C library's";

}  // namespace screed

// The names and types inside a session file, for the writer and the reader. docs/sessions.md
// describes them for users.

namespace screed::layout {

inline constexpr char kFormat[] = "screed-session";
/// Raised when a reader of the version before would misunderstand the file; new columns and
/// attributes do not count.
inline constexpr std::uint64_t kFormatVersion = 1;

inline constexpr char kFormatAttribute[] = "format";
inline constexpr char kVersionAttribute[] = "format_version";
inline constexpr char kProgramAttribute[] = "program_version";
inline constexpr char kArithmeticAttribute[] = "arithmetic";
inline constexpr char kExperimentNameAttribute[] = "experiment_name";
inline constexpr char kExperimentTextAttribute[] = "experiment_text";
inline constexpr char kSeedAttribute[] = "seed";
inline constexpr char kTickRateAttribute[] = "tick_rate_hz";
inline constexpr char kBoardNameAttribute[] = "board_name";
inline constexpr char kFramesAttribute[] = "frames";
/// Written last: a file without it is that of a run that did not end.
inline constexpr char kHashAttribute[] = "content_hash";

inline constexpr char kParametersGroup[] = "parameters";
inline constexpr char kBoardGroup[] = "board";
inline constexpr char kCredentialsGroup[] = "credentials";
inline constexpr char kKeyAttribute[] = "key";  ///< hexadecimal digits and robot id
inline constexpr char kKeySetAttribute[] = "key_set";
inline constexpr char kBootEpochAttribute[] = "boot_epoch";
inline constexpr char kTerrainGroup[] = "terrain";
inline constexpr char kTerrainBefore[] = "before";
inline constexpr char kTerrainAfter[] = "after";
inline constexpr char kHeightsGroup[] = "heights";
inline constexpr char kHeightKeys[] = "key_frames";
inline constexpr char kHeightKeyTicks[] = "key_frame_ticks";
inline constexpr char kHeightNodes[] = "change_nodes";
inline constexpr char kHeightChanges[] = "changes";
inline constexpr char kHeightEnds[] = "change_ends";
inline constexpr char kSoilGroup[] = "soil";
inline constexpr char kParticlesGroup[] = "particles";
inline constexpr char kParticlesBefore[] = "before";
inline constexpr char kParticlesAfter[] = "after";
inline constexpr char kParticleRadius[] = "radius_m";

struct TableLayout {
  const char* dataset;
  std::span<const Column> columns;
};
inline constexpr TableLayout kFramesTable{"frames", kFrameColumns};
inline constexpr TableLayout kSamplesTable{"samples", kSampleColumns};
inline constexpr TableLayout kOutputsTable{"outputs", kOutputColumns};
inline constexpr TableLayout kLevelingTable{"leveling", kLevelingColumns};

struct BoardField {
  const char* name;
  const char* unit;
  std::uint16_t BoardConstants::*field;
};
inline constexpr BoardField kBoardFields[] = {
    {"count_um_q4", "1/16 um", &BoardConstants::count_um_q4},
    {"battery_uv_per_lsb", "uV", &BoardConstants::battery_uv_per_lsb},
    {"tread_mm", "mm", &BoardConstants::tread_mm},
    {"motor_nominal_mv", "mV", &BoardConstants::motor_nominal_mv},
    {"full_speed_mm_per_s", "mm/s", &BoardConstants::full_speed_mm_per_s},
    {"hull_reach_mm", "mm", &BoardConstants::hull_reach_mm},
};
static_assert(sizeof(BoardConstants) == std::size(kBoardFields) * sizeof(std::uint16_t),
              "a board constant is missing from the list");

/// The HDF5 type of one column, without the array around it.
hid_t element_type(ColumnType type);

/// The compound type of a row as record.h packs it: the same in the file and in memory, so nothing
/// is converted.
h5::Handle row_type(std::span<const Column> columns);

/// Creation options: chunked, shuffled, deflated, and without time stamps, so that equal runs give
/// equal files.
h5::Handle compressed(std::span<const hsize_t> chunk);
/// Without time stamps.
h5::Handle create_group(hid_t file, const char* name);

/// How a map lies in the world, as attributes of its dataset.
void write_geometry(hid_t dataset, const HeightMapGeometry& geometry);
/// The same from a file. Throws h5::Hdf5Failure for a size that no bed has.
HeightMapGeometry read_geometry(hid_t dataset, hsize_t nx, hsize_t ny);
/// A hash over a map and how it lies.
std::string map_hash(const HeightMapView& map);

}  // namespace screed::layout

namespace screed {

// The content hash of a session: what "same seed, same bytes" is checked with.
//
// Covers seed, experiment text, tick rate, board constants, parameters, every frame, sample and
// output, the terrains and the recorded heights; not the program version, names, or anything of the
// file that holds them.

class SessionHash {
 public:
  explicit SessionHash(const SessionInfo& info);

  /// Packed rows (record.h) in order; the three tables may be added in any interleaving and in
  /// blocks of any size.
  void add_frames(std::span<const std::uint8_t> rows) { frames_.add_bytes(rows); }
  void add_samples(std::span<const std::uint8_t> rows) { samples_.add_bytes(rows); }
  void add_outputs(std::span<const std::uint8_t> rows) { outputs_.add_bytes(rows); }
  void set_terrain_before(const HeightMapView& map);
  void set_terrain_after(const HeightMapView& map);
  /// Of the height series (height_series.h).
  void set_heights(std::string hash) { heights_ = std::move(hash); }

  /// The hash of all of it, 32 hexadecimal digits.
  std::string hex(std::uint64_t frames) const;

 private:
  ContentHash info_;
  ContentHash frames_;
  ContentHash samples_;
  ContentHash outputs_;
  std::string terrain_before_;
  std::string terrain_after_;
  std::string heights_;
};

}  // namespace screed
