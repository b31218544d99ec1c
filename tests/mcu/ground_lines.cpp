// What a ground station sends and receives.
#include "tests/mcu/ground_lines.h"

#include <algorithm>
#include <iterator>

#include "firmware/math/crc16.h"
#include "firmware/parameters/parameters.h"
#include "firmware/protocol/e2e.h"

namespace screed::mcu {
namespace {

std::vector<std::uint8_t> line_of(const CanFrame& frame) {
  std::uint8_t line[kSlcanLineMax];
  return {line, line + slcan_encode(frame, line)};
}

}  // namespace

GroundLines::GroundLines() : signer_(test_key()) {
  message::Heartbeat heartbeat{};
  heartbeat.boot_epoch = kFirstBootEpoch;
  handle_frame(frame_of(heartbeat));
}

std::vector<std::uint8_t> GroundLines::heartbeat(std::uint32_t time_ms) {
  CanFrame frame = frame_of(message::GroundHeartbeat{time_ms});
  e2e_protect(frame.id, heartbeat_counter_, frame.data, frame.size);
  heartbeat_counter_ = static_cast<std::uint8_t>((heartbeat_counter_ + 1) & 0x0F);
  return line_of(frame);
}

std::vector<std::uint8_t> GroundLines::command(CommandOp op, DriveArgument argument) {
  return line_of(signer_.sign(op, argument));
}

std::vector<std::uint8_t> GroundLines::parameter(Parameters::Number number, std::int16_t value) {
  CanFrame stage = frame_of(message::ParamStage{number, value});
  e2e_protect(stage.id, stage_counter_, stage.data, stage.size);
  stage_counter_ = static_cast<std::uint8_t>((stage_counter_ + 1) & 0x0F);
  std::uint8_t bound[4];  // index and value, which the signed command binds by their CRC
  put_u16(bound, number);
  put_u16(bound + 2, static_cast<std::uint16_t>(value));
  const std::uint32_t crc = crc16_ccitt(bound, sizeof bound);
  std::vector<std::uint8_t> lines = line_of(stage);
  for (const std::uint8_t byte :
       line_of(signer_.sign(CommandOp::kParameterCommit, number | crc << 8))) {
    lines.push_back(byte);
  }
  return lines;
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
