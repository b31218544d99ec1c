// avr_cycles: how long the longest control tick of an image takes, and its interrupts, measured
// cycle by cycle in the simulator while the robot boots, is armed and drives.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/devices/mcu/board.h"
#include "host_sim/devices/mcu/wiring.h"
#include "host_sim/ground_station/station/command_key.h"
#include "tools/command_line/program.h"

namespace {

using namespace screed;

constexpr int kStandStill_ms = 6000;  // until the estimator is ready
constexpr int kDrive_ms = 4000;
constexpr double kCountsPerMs = 0.5;  // of a track at full duty

struct Options {
  std::string image;
  std::string wiring;
  std::uint64_t budget = CycleReport::kTickCycles / 2;
};

std::vector<std::uint8_t> line(const CanFrame& frame) {
  std::uint8_t text[kSlcanLineMax];
  return {text, text + slcan_encode(frame, text)};
}

/// The ground station's side: heartbeats, and the commands that make the robot drive.
class Ground {
 public:
  Ground() : signer_(test_key()) {
    message::Heartbeat first{};
    first.boot_epoch = kFirstBootEpoch;
    signer_.handle_frame(frame_of(first));
  }
  std::vector<std::uint8_t> heartbeat() {
    CanFrame frame = frame_of(message::GroundHeartbeat{});
    e2e_protect(frame.id, heartbeats_, frame.data, frame.size);
    heartbeats_ = static_cast<std::uint8_t>((heartbeats_ + 1) & 0x0F);
    return line(frame);
  }
  std::vector<std::uint8_t> command(CommandOp op) { return line(signer_.sign(op)); }

 private:
  CommandSigner signer_;
  std::uint8_t heartbeats_ = 0;
};

int run(const Options& options) {
  mcu::Board board(options.image, mcu::read_wiring(options.wiring));
  board.mcu.write_eeprom(kCredentialRecordAddress,
                         credential_record(credentials_of(test_key())).bytes);
  Ground ground;
  double travel[2] = {0, 0};
  double late_travel = 0;  // of both tracks in the last second, counts
  for (int ms = 0; ms < kStandStill_ms + kDrive_ms; ++ms) {
    const int noise = ms % 7 - 3;
    board.set_acceleration(0.244 * Eigen::Vector3d(noise, -noise, 4096 + noise));
    board.set_magnetic_field(0.160 * Eigen::Vector3d(noise, 1250, -2500 + noise));
    board.set_angular_rate(0.070 * Eigen::Vector3d(noise, 2 - noise, ms % 5 - 2));
    for (const Side side : {kLeft, kRight}) {
      const double counts = kCountsPerMs * board.motor_duty_ratio(side);
      travel[side] += counts;
      if (ms >= kStandStill_ms + kDrive_ms - 1000) late_travel += std::abs(counts);
      board.set_encoder(side, static_cast<std::int64_t>(travel[side]));
    }
    if (ms % 100 == 0) board.mcu.receive(ground.heartbeat());
    if (ms == kStandStill_ms) board.mcu.receive(ground.command(CommandOp::kArm));
    if (ms == kStandStill_ms + 50) board.mcu.receive(ground.command(CommandOp::kRun));
    // As often as a ground station may, at a different phase of the packets every time.
    if (ms > kStandStill_ms + 50 && ms % 237 == 0) {
      board.mcu.receive(ground.command(CommandOp::kRun));
    }
    board.mcu.run_ms(1);
  }
  board.check();
  if (late_travel == 0) throw RunError("the robot did not drive to the end");

  const CycleReport report = board.cycles();
  const auto longest = report.longest_tick_cycles;
  std::printf("longest tick             %6llu of %6llu cycles, %.1f %% of the tick\n",
              static_cast<unsigned long long>(longest),
              static_cast<unsigned long long>(options.budget),
              100.0 * static_cast<double>(longest) / CycleReport::kTickCycles);
  for (const CycleReport::Interrupt& it : report.interrupts) {
    std::printf("  %-22s %6llu cycles at most\n", it.name.c_str(),
                static_cast<unsigned long long>(it.longest_cycles));
  }
  std::printf("encoder interrupt begins %6llu cycles after the edge at most\n",
              static_cast<unsigned long long>(report.encoder_latency_cycles));
  if (longest > options.budget) throw RunError("the longest tick is over its budget");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  screed::Command app("Cycles of the longest control tick of an AVR image, in the simulator",
                      "avr_cycles");
  app.add_option("image", options.image, "ELF file of the image")->required();
  app.add_option("wiring", options.wiring, "Wiring of the board (boards/<board>/wiring.ini)")
      ->required();
  app.add_option("--budget", options.budget, "Budget of the longest control tick [cycles]")
      ->show_default();
  return screed::run_program(app, argc, argv, [&] { return run(options); });
}
