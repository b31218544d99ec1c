#include "host_sim/ground_station/telemetry/track_slip_table.h"

#include <cinttypes>
#include <cstdio>

namespace screed {
namespace {

std::string cell(const std::optional<double>& slip) {
  if (!slip.has_value()) return ",";
  char text[16];
  std::snprintf(text, sizeof text, ",%.3f", *slip);
  return text;
}

}  // namespace

TrackSlipTable::TrackSlipTable(const std::filesystem::path& folder, const BoardConstants& board)
    : path_(folder / "track_slip.csv"), board_(board) {}

void TrackSlipTable::add(const DecodedFrame& frame) {
  const auto robot = robots_.try_emplace(frame.node, board_).first;
  const auto slip = robot->second.add(frame.time_us, *frame.message, frame.bits);
  if (!slip.has_value()) return;
  if (file_ == nullptr) {
    file_ = std::make_unique<AtomicFile>(path_.string());
    file_->write("time [s],robot,slip_left [1],slip_right [1]\n");
  }
  char begin[48];
  std::snprintf(begin, sizeof begin, "%" PRIu64 ".%06" PRIu64 ",%d", frame.time_us / 1'000'000,
                frame.time_us % 1'000'000, frame.node);
  file_->write(begin + cell(slip->left) + cell(slip->right) + "\n");
}

std::optional<std::string> TrackSlipTable::finish() {
  if (file_ == nullptr) return std::nullopt;
  file_->commit();
  return path_.string();
}

}  // namespace screed
