// The ground end of the radio.
#include "host_sim/ground_station/station/ground_end.h"

#include "firmware/protocol/e2e.h"

namespace screed {

void GroundEnd::tick(uint64_t now_us, GroundStation& station, RadioLink& uplink,
                     RadioLink& downlink) {
  if (port_ != nullptr) {
    const std::vector<uint8_t> bytes = port_->receive();
    listen(bytes);
    uplink.send(now_us, bytes);
  }
  if (!handed_over_) uplink.send(now_us, station.transmit(now_us));
  const std::span<const uint8_t> arrived = downlink.receive(now_us, SIZE_MAX);
  station.receive(now_us, arrived);
  if (port_ != nullptr) port_->send(arrived);
}

void GroundEnd::listen(std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (outside_.feed(byte, frame) && frame.id == kIdGroundHeartbeat &&
        e2e_check(frame.id, frame.data, frame.size)) {
      handed_over_ = true;
    }
  }
}

}  // namespace screed
