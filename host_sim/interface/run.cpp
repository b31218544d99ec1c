// The C interface of experiments, runs and sessions.
#include <screed/run.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/core/record.h"
#include "host_sim/interface/checks.h"
#include "host_sim/interface/told_world.h"
#include "host_sim/physics/terrain/height_map.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/run_report.h"
#include "host_sim/run/simulation/simulation.h"
#include "host_sim/run/world/world_setup.h"
#include "host_sim/standin/standin_plant.h"
#include "version.h"

using namespace screed;  // of a file whose own names are C's
using namespace screed::interface;

namespace {

void give(std::string_view text, screed_bytes* bytes) {
  auto* data = static_cast<char*>(std::malloc(text.size() + 1));
  if (data == nullptr) throw std::bad_alloc();
  std::copy(text.begin(), text.end(), data);
  data[text.size()] = '\0';
  *bytes = {data, text.size()};
}

Experiment read(const char* experiment, const char* const* sets, size_t count) {
  require_pointer(experiment, "experiment");
  if (count > 0) require_pointer(sets, "sets");
  std::vector<std::string> all;
  for (size_t i = 0; i < count; ++i) {
    require_pointer(sets[i], "set");
    all.emplace_back(sets[i]);
  }
  return read_experiment(experiment, all);
}

SimulationOptions options_of(const char* hal, const char* folder) {
  require_pointer(hal, "hal");
  SimulationOptions options;
  options.program_version = SCREED_VERSION;
  options.pictures = false;
  if (folder != nullptr) options.out = folder;
  if (std::string_view(hal) == "surrogate") {
    options.environment = stand_in_environment();
    options.least_cell_m = kStandInCell_m;
  } else if (std::string_view(hal) != "native") {
    throw InputError("hal = " + std::string(hal) + "; allowed: native, surrogate");
  }
  return options;
}

/// Rows of a table of ticks, packed as record.h says.
template <typename Row, size_t kBytes>
void read_rows(const SessionReader& reader, int64_t first, int64_t count, uint8_t* rows) {
  constexpr int64_t kBlock = 1024;
  std::vector<Row> block;
  for (int64_t done = 0; done < count; done += kBlock) {
    block.resize(static_cast<size_t>(std::min(kBlock, count - done)));
    reader.read(static_cast<uint64_t>(first + done), std::span<Row>(block));
    for (const Row& row : block) {
      pack(row, std::span<uint8_t, kBytes>(rows, kBytes));
      rows += kBytes;
    }
  }
}

}  // namespace

struct screed_session : Handle {
  explicit screed_session(const std::filesystem::path& file) : reader(file) {}
  SessionReader reader;
};

void screed_free(screed_bytes* bytes) {
  if (bytes == nullptr) return;
  std::free(bytes->data);
  *bytes = {};
}

screed_status screed_prepare(const char* experiment, const char* const* sets, size_t count,
                             screed_bytes* prepared, screed_error* error) {
  return attempt(error, [&] {
    require_pointer(prepared, "prepared");
    give(to_bytes(prepare_standin(read(experiment, sets, count))), prepared);
  });
}

screed_status screed_sim(const char* experiment, const char* const* sets, size_t count,
                         const char* hal, const char* folder, screed_bytes* summary,
                         screed_error* error) {
  return attempt(error, [&] {
    require_pointer(summary, "summary");
    const SimulationOptions options = options_of(hal, folder);
    give(summary_json_with_folder(run_simulation(read(experiment, sets, count), options)).dump(),
         summary);
  });
}

screed_session* screed_session_open(const char* run, int robot, screed_error* error) {
  screed_session* session = nullptr;
  attempt(error, [&] {
    require_pointer(run, "run");
    const std::vector<std::filesystem::path> files = session_files(run);
    require(robot >= 0 && static_cast<size_t>(robot) < files.size(), "robot", robot,
            "numbers of robots");
    session = new screed_session(files[static_cast<size_t>(robot)]);
  });
  return session;
}

void screed_session_close(screed_session* session) {
  destroy(session);
}

screed_status screed_session_info(const screed_session* session, screed_bytes* info,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(session, "session");
    require_pointer(info, "info");
    const SessionInfo& its = session->reader.info();
    const Json json = {{"name", its.experiment_name},
                       {"experiment", its.experiment_text},
                       {"seed", its.seed},
                       {"board", its.board_name},
                       {"program", its.program_version},
                       {"complete", session->reader.complete()},
                       {"content_hash", session->reader.content_hash()}};
    give(json.dump(), info);
  });
}

int64_t screed_session_rows(const screed_session* session, int table, screed_error* error) {
  int64_t rows = -1;
  attempt(error, [&] {
    const Use use(session, "session");
    if (table == SCREED_LEVELING) {
      rows = static_cast<int64_t>(session->reader.leveling().size());
    } else {
      check_table(table);
      rows = static_cast<int64_t>(session->reader.frames());
    }
  });
  return rows;
}

screed_status screed_session_read(const screed_session* session, int table, int64_t first,
                                  int64_t count, void* rows, screed_error* error) {
  return attempt(error, [&] {
    const Use use(session, "session");
    require_pointer(rows, "rows");
    const SessionReader& reader = session->reader;
    const std::vector<LevelingPoint> points =
        table == SCREED_LEVELING ? reader.leveling() : std::vector<LevelingPoint>();
    const auto all =
        static_cast<int64_t>(table == SCREED_LEVELING ? points.size() : reader.frames());
    if (first < 0 || count < 0 || first > all || count > all - first)
      throw InputError("rows: beyond the table; allowed: within 0 to " + std::to_string(all));
    auto* bytes = static_cast<uint8_t*>(rows);
    switch (table) {
      case SCREED_FRAMES:
        return read_rows<SimFrame, kFrameBytes>(reader, first, count, bytes);
      case SCREED_SAMPLES:
        return read_rows<SensorSample, kSampleBytes>(reader, first, count, bytes);
      case SCREED_OUTPUTS:
        return read_rows<RobotOutput, kOutputBytes>(reader, first, count, bytes);
      case SCREED_LEVELING:
        std::memcpy(bytes, points.data() + first, static_cast<size_t>(count) * kLevelingBytes);
        return;
      default:
        check_table(table);
    }
  });
}

screed_status screed_session_ground(const screed_session* session, int after,
                                    screed_rectangle* nodes, double* spacing, double* heights,
                                    screed_error* error) {
  return attempt(error, [&] {
    const Use use(session, "session");
    require_pointer(nodes, "nodes");
    require_pointer(spacing, "spacing");
    const std::optional<HeightMap> map =
        after == 0 ? session->reader.terrain_before() : session->reader.terrain_after();
    if (!map.has_value()) throw InputError("ground: the session has none of that moment");
    const HeightMapGeometry& geometry = map->geometry;
    *nodes = {0, 0, static_cast<int>(geometry.nx), static_cast<int>(geometry.ny)};
    *spacing = geometry.spacing_m;
    if (heights == nullptr) return;
    std::transform(map->heights.begin(), map->heights.end(), heights,
                   [&](int32_t height) { return height * geometry.unit_m; });
  });
}
