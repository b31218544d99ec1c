// The replay: a Robot, recorded samples, and a comparison of packed rows.
#include "host_sim/run/session/replay.h"

#include <algorithm>
#include <array>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/record.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

void check_replayable(const SessionReader& session, const std::filesystem::path& session_file) {
  if (session.frames() == 0) throw InputError(session_file.string() + ": no tick was recorded");
  const SessionInfo& info = session.info();
  if (info.tick_rate_hz != kTickRate_hz) {
    throw InputError(session_file.string() + ": recorded at " + std::to_string(info.tick_rate_hz) +
                     " ticks per second; this program replays " + std::to_string(kTickRate_hz));
  }
  for (const layout::BoardField& field : layout::kBoardFields) {
    // The firmware divides by them: a board constant of zero stops the program, not the robot.
    if (info.board.*field.field == 0) {
      throw InputError(session_file.string() + ": board constant '" + field.name +
                       "' is 0; no robot can run with it");
    }
  }
}

ReplayResult replay_session(const std::filesystem::path& session_file,
                            const ReplayOptions& options) {
  constexpr std::uint64_t kBlockRows = 1024;
  const SessionReader session(session_file);
  check_replayable(session, session_file);
  const SessionInfo& info = session.info();

  ReplayResult result;
  result.arithmetic = info.arithmetic;
  result.complete = session.complete();
  result.running = session.running();
  result.unchanged = !result.complete || !session.missing_columns().empty() ||
                     session.compute_content_hash() == session.content_hash();

  Robot robot(info.board, options.parameters.value_or(info.parameters), info.credentials);
  RobotOutput output{};  // one for all ticks, as in the main loop
  ContentHash hash;
  std::array<std::uint8_t, kOutputBytes> expected{};
  std::array<std::uint8_t, kOutputBytes> got{};
  std::vector<SensorSample> samples;
  std::vector<RobotOutput> outputs;
  while (result.ticks < session.frames()) {
    report_progress(options.progress, "replaying", result.ticks, session.frames());
    const std::uint64_t count = std::min(kBlockRows, session.frames() - result.ticks);
    samples.resize(count);
    outputs.resize(count);
    session.read(result.ticks, std::span(samples));
    session.read(result.ticks, std::span(outputs));
    for (std::uint64_t i = 0; i < count; ++i, ++result.ticks) {
      robot.tick(samples[i], output);
      if (options.on_tick) options.on_tick(result.ticks, outputs[i], output, robot);
      pack(output, OutputRow(got));
      hash.add_bytes(got);
      if (result.first_difference_tick) continue;
      pack(outputs[i], OutputRow(expected));
      if (const auto difference = first_difference(kOutputColumns, expected, got)) {
        result.first_difference_tick = result.ticks;
        result.first_difference = *difference;
      }
    }
  }
  result.output_hash = hash.hex();
  return result;
}

}  // namespace screed
