// What a ground station sends and receives.
#include "tests/mcu/ground_lines.h"

#include "firmware/telemetry/e2e.h"

namespace screed::mcu {
namespace {

std::vector<std::uint8_t> line_of(CanFrame frame, std::uint8_t& counter) {
  e2e_protect(frame.id, counter, frame.data, frame.size);
  counter = static_cast<std::uint8_t>((counter + 1) & 0x0F);
  std::uint8_t line[kSlcanLineMax];
  return {line, line + slcan_encode(frame, line)};
}

}  // namespace

std::vector<std::uint8_t> GroundLines::heartbeat(std::uint32_t time_ms) {
  return line_of(frame_of(message::GroundHeartbeat{time_ms}), heartbeat_counter_);
}

std::vector<std::uint8_t> GroundLines::command(CommandOp op, DriveArgument argument) {
  CanFrame frame{};
  frame.id = kIdCommand;
  frame.size = 6;
  frame.data[2] = static_cast<std::uint8_t>(op);
  put_drive_argument(frame.data + 3, argument);
  return line_of(frame, command_counter_);
}

std::vector<CanFrame> frames_in(const std::vector<std::uint8_t>& bytes) {
  std::vector<CanFrame> frames;
  SlcanParser parser;
  for (const std::uint8_t byte : bytes) {
    CanFrame frame{};
    if (parser.feed(byte, frame) && e2e_check(frame.id, frame.data, frame.size)) {
      frames.push_back(frame);
    }
  }
  return frames;
}

}  // namespace screed::mcu
