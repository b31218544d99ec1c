#include "host_sim/run/comparison/session_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>
#include <utility>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/record.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/simulation/outcome.h"

namespace screed {
namespace {

constexpr std::uint64_t kBlockRows = 1024;

/// Recorded rows of one table, a block at a time.
template <class Row, std::size_t kBytes>
class RowBlock {
 public:
  void read(const SessionReader& session, std::uint64_t first, std::uint64_t count) {
    rows_.resize(count);
    session.read(first, std::span(rows_));
  }
  const Row& row(std::size_t i) const { return rows_[i]; }
  std::array<std::uint8_t, kBytes> bytes(std::size_t i) const {
    std::array<std::uint8_t, kBytes> packed{};
    pack(rows_[i], std::span<std::uint8_t, kBytes>(packed));
    return packed;
  }

 private:
  std::vector<Row> rows_;
};

/// All tables of one session.
struct SessionBlock {
  RowBlock<SensorSample, kSampleBytes> samples;
  RowBlock<RobotOutput, kOutputBytes> outputs;
  RowBlock<SimFrame, kFrameBytes> frames;

  void read(const SessionReader& session, std::uint64_t first, std::uint64_t count) {
    samples.read(session, first, count);
    outputs.read(session, first, count);
    frames.read(session, first, count);
  }
};

struct TickDifference {
  std::string column;
  ColumnDifference values;
};

template <class Block>
void add_differences(const char* table, std::span<const Column> columns, const Block& a,
                     const Block& b, std::size_t row, std::vector<TickDifference>& found) {
  const auto bytes_a = a.bytes(row);
  const auto bytes_b = b.bytes(row);
  if (bytes_a == bytes_b) return;
  for (ColumnDifference& it : column_differences(columns, bytes_a, bytes_b)) {
    std::string name = table;
    name += '.';
    name += it.column;
    found.push_back({std::move(name), std::move(it)});
  }
}

/// In the order of cause and effect: what the robot read, what it answered, what came of it.
std::vector<TickDifference> differences_of(const SessionBlock& a, const SessionBlock& b,
                                           std::size_t row) {
  std::vector<TickDifference> found;
  add_differences("samples", kSampleColumns, a.samples, b.samples, row, found);
  add_differences("outputs", kOutputColumns, a.outputs, b.outputs, row, found);
  add_differences("frames", kFrameColumns, a.frames, b.frames, row, found);
  return found;
}

/// The chassis' place as if the bed did not repeat.
struct Travelled {
  double x_m;
  double y_m;
};

class Bed {
 public:
  explicit Bed(const std::optional<HeightMap>& map) {
    if (!map.has_value() || !map->geometry.wrap) return;
    width_m_ = map->geometry.nx * map->geometry.spacing_m;
    depth_m_ = map->geometry.ny * map->geometry.spacing_m;
  }
  Travelled travelled(const SimFrame& frame) const {
    return {frame.x + frame.beds_x * width_m_, frame.y + frame.beds_y * depth_m_};
  }

 private:
  double width_m_ = 0.0;
  double depth_m_ = 0.0;
};

std::string name_of(const char* signal, std::int64_t value) {
  return find_signal(signal).signal->text(value);
}

/// The surface that counts, as in the summary of the run.
HeightField surface_of(const SessionReader& session, const HeightMap& map) {
  return TerrainMeasure(setup_of(session.info(), {}).experiment).surface(field_of(map));
}

/// Ten points a second and the last frame of one run, and its end.
void read_trace(const SessionReader& session, const Bed& bed, ComparedRun& run) {
  const std::uint64_t every = std::max<std::uint64_t>(1, session.info().tick_rate_hz / 10);
  const std::uint64_t count = session.frames();
  if (count == 0) return;
  const SimFrame last =
      for_each_frame(session, count, [&](std::uint64_t row, const SimFrame& frame) {
        if (std::isfinite(frame.delta_x) && std::isfinite(frame.delta_y)) {
          run.end.distance_m += portable::hypot(frame.delta_x, frame.delta_y);
        }
        if (row % every != 0 && row + 1 != count) return;
        run.trace.push_back({frame.time, frame.x, frame.y, frame.battery, frame.leveling_state,
                             frame.beds_x, frame.beds_y});
      });
  const Travelled place = bed.travelled(last);
  run.end.time_s = last.time;
  run.end.x_m = place.x_m;
  run.end.y_m = place.y_m;
  run.end.heading_rad = last.yaw;
  run.end.state = name_of("heartbeat.state", last.state);
  run.end.leveling_state = name_of("leveling.state", last.leveling_state);
  run.end.faults = flag_names("heartbeat", "faults", static_cast<std::uint32_t>(last.faults));
  if (run.end.faults.empty()) run.end.faults = "none";
  run.end.battery_v = last.battery;
  run.end.energy_j = last.energy;
}

/// A run, and its surface at the end where it was recorded.
struct MeasuredRun {
  ComparedRun run;
  std::optional<HeightField> surface;
};

MeasuredRun describe(const SessionReader& session) {
  ComparedRun run;
  run.name = session.info().experiment_name;
  run.program_version = session.info().program_version;
  run.seed = session.info().seed;
  run.frames = session.frames();
  run.complete = session.complete();
  run.content_hash = session.content_hash();
  run.before = session.terrain_before();
  run.terrain = session.terrain_after();
  read_trace(session, Bed(run.before), run);
  std::optional<HeightField> surface;
  if (run.terrain.has_value()) surface = surface_of(session, *run.terrain);
  if (run.before.has_value() && surface.has_value()) {
    run.end.change = terrain_change(surface_of(session, *run.before), *surface);
  }
  return {std::move(run), std::move(surface)};
}

/// The tick in which two recordings part, and how far the robots are apart until both have ended.
void compare_ticks(const SessionReader& a, const SessionReader& b, const std::array<Bed, 2>& beds,
                   SessionComparison& result) {
  SessionBlock block_a;
  SessionBlock block_b;
  const double dt = 1.0 / a.info().tick_rate_hz;
  const std::uint64_t every = std::max<std::uint64_t>(1, a.info().tick_rate_hz / 10);
  for (std::uint64_t first = 0; first < result.common_ticks; first += kBlockRows) {
    const std::uint64_t count = std::min(kBlockRows, result.common_ticks - first);
    block_a.read(a, first, count);
    block_b.read(b, first, count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t tick = first + i;
      if (!result.first.has_value()) {
        const std::vector<TickDifference> found = differences_of(block_a, block_b, i);
        if (!found.empty()) {
          result.first = {tick,
                          static_cast<double>(tick) * dt,
                          found[0].column,
                          found[0].values.expected,
                          found[0].values.got,
                          {}};
          for (const TickDifference& it : found) result.first->all_columns.push_back(it.column);
        }
      }
      const SimFrame& frame_a = block_a.frames.row(i);
      const SimFrame& frame_b = block_b.frames.row(i);
      const Travelled at_a = beds[0].travelled(frame_a);
      const Travelled at_b = beds[1].travelled(frame_b);
      const DeviationPoint point{frame_a.time,
                                 portable::hypot(at_b.x_m - at_a.x_m, at_b.y_m - at_a.y_m),
                                 std::remainder(frame_b.yaw - frame_a.yaw, 2.0 * std::numbers::pi)};
      if (!result.summary.has_value()) result.summary = {point, point, point};
      DeviationSummary& summary = *result.summary;
      summary.last = point;
      if (point.position_m > summary.largest_position.position_m) summary.largest_position = point;
      if (std::abs(point.heading_rad) > std::abs(summary.largest_heading.heading_rad)) {
        summary.largest_heading = point;
      }
      if (tick % every == 0 || tick + 1 == result.common_ticks) result.deviation.push_back(point);
    }
  }
}

std::string grid_text(const HeightMapGeometry& g) {
  char text[100];
  std::snprintf(text, sizeof text, "%u x %u heights of %g m%s", g.nx, g.ny, g.spacing_m,
                g.wrap ? ", wrapped" : "");
  return text;
}

TerrainDifference terrain_difference(const MeasuredRun& a, const MeasuredRun& b) {
  TerrainDifference result;
  if (!a.surface.has_value() || !b.surface.has_value()) {
    result.not_comparable = "not recorded";
    return result;
  }
  const HeightMapGeometry& grid_a = a.run.terrain->geometry;
  const HeightMapGeometry& grid_b = b.run.terrain->geometry;
  if (grid_a != grid_b) {
    result.not_comparable = "the grids differ: A " + grid_text(grid_a) + ", B " + grid_text(grid_b);
    return result;
  }
  const HeightField& surface_a = *a.surface;
  const HeightField& surface_b = *b.surface;
  result.change = terrain_change(surface_a, surface_b);
  double squares = 0.0;
  result.height_m.reserve(a.run.terrain->heights.size());
  for (int iy = 0; iy < surface_a.ny(); ++iy) {
    for (int ix = 0; ix < surface_a.nx(); ++ix) {
      const double height = kHeightUnit_m * (surface_b.node(ix, iy) - surface_a.node(ix, iy));
      result.height_m.push_back(height);
      squares += height * height;
    }
  }
  result.rms_m = std::sqrt(squares / static_cast<double>(result.height_m.size()));
  return result;
}

std::string key_of(const IniEntry& entry) {
  return entry.section.empty() ? entry.key : entry.section + "." + entry.key;
}

std::string shown(const IniEntry& entry) {
  return is_secret(entry) ? kSecretText : entry.value;
}

}  // namespace

bool SessionComparison::identical() const {
  return configuration.empty() && !first.has_value() && runs[0].frames == runs[1].frames &&
         same_terrain;
}

std::vector<KeyDifference> configuration_difference(const std::string& a, const std::string& b) {
  const std::vector<IniEntry> entries_a = read_ini_text(a, "experiment of A");
  const std::vector<IniEntry> entries_b = read_ini_text(b, "experiment of B");
  const auto find = [](const std::vector<IniEntry>& entries, const IniEntry& wanted) {
    return std::find_if(entries.begin(), entries.end(), [&](const IniEntry& it) {
      return it.section == wanted.section && it.key == wanted.key;
    });
  };
  std::vector<KeyDifference> differences;
  for (const IniEntry& entry : entries_a) {
    const auto other = find(entries_b, entry);
    if (other == entries_b.end()) {
      differences.push_back({key_of(entry), shown(entry), std::nullopt});
    } else if (other->value != entry.value) {
      differences.push_back({key_of(entry), shown(entry), shown(*other)});
    }
  }
  for (const IniEntry& entry : entries_b) {
    if (find(entries_a, entry) == entries_a.end()) {
      differences.push_back({key_of(entry), std::nullopt, shown(entry)});
    }
  }
  return differences;
}

SessionComparison compare_sessions(const SessionReader& a, const SessionReader& b) {
  if (a.info().tick_rate_hz != b.info().tick_rate_hz) {
    throw InputError("A has " + std::to_string(a.info().tick_rate_hz) + " ticks a second, B " +
                     std::to_string(b.info().tick_rate_hz) +
                     "; only runs of the same rate are compared");
  }
  SessionComparison result;
  result.configuration =
      configuration_difference(a.info().experiment_text, b.info().experiment_text);
  if (a.info().board_name != b.info().board_name) {
    result.configuration.insert(result.configuration.begin(),
                                {"board", a.info().board_name, b.info().board_name});
  }
  MeasuredRun run_a = describe(a);
  MeasuredRun run_b = describe(b);
  result.terrain = terrain_difference(run_a, run_b);
  result.runs = {std::move(run_a.run), std::move(run_b.run)};
  result.same_start = result.runs[0].before == result.runs[1].before;
  result.same_terrain = result.same_start && result.runs[0].terrain == result.runs[1].terrain;
  result.common_ticks = std::min(a.frames(), b.frames());
  compare_ticks(a, b, {Bed(result.runs[0].before), Bed(result.runs[1].before)}, result);
  return result;
}

}  // namespace screed
