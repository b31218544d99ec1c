// One hash per part, joined at the end, so that it does not matter when a part becomes known.
#include "host_sim/run/session/session_hash.h"

#include "firmware/parameters/parameter_table.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

SessionHash::SessionHash(const SessionInfo& info) {
  info_.add(info.seed);
  info_.add(info.experiment_text);
  info_.add(info.tick_rate_hz);
  for (const layout::BoardField& field : layout::kBoardFields) {
    info_.add(field.name);
    info_.add(info.board.*field.field);
  }
  for (const ParameterInfo& parameter : kParameterTable) {
    info_.add(parameter.name);
    info_.add(info.parameters.values[parameter.number]);
  }
  info_.add(key_text(command_key_of(info.credentials)));
  info_.add(info.credentials.key_set);
  info_.add(info.credentials.boot_epoch);
}

void SessionHash::set_terrain_before(const HeightMapView& map) {
  terrain_before_ = layout::map_hash(map);
}

void SessionHash::set_terrain_after(const HeightMapView& map) {
  terrain_after_ = layout::map_hash(map);
}

std::string SessionHash::hex(std::uint64_t frames) const {
  ContentHash hash;
  hash.add(info_.hex());
  hash.add(frames);
  hash.add(frames_.hex());
  hash.add(samples_.hex());
  hash.add(outputs_.hex());
  hash.add(terrain_before_);
  hash.add(terrain_after_);
  // Not of a session without: its hash stays what it was.
  if (!heights_.empty()) hash.add(heights_);
  return hash.hex();
}

}  // namespace screed
