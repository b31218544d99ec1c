// One hash per part, joined at the end, so that it does not matter when a part becomes known.
#include "host_sim/session/session_hash.h"

#include "firmware/robot/parameter_table.h"
#include "host_sim/session/session_layout.h"

namespace screed {
namespace {

std::string terrain_hash(const HeightMapView& map) {
  const HeightMapGeometry& g = map.geometry;
  ContentHash hash;
  hash.add(g.nx);
  hash.add(g.ny);
  hash.add(g.unit_m);
  hash.add(g.spacing_m);
  hash.add(g.origin_x_m);
  hash.add(g.origin_y_m);
  hash.add(g.wrap);
  for (const std::int32_t height : map.heights) hash.add(height);
  return hash.hex();
}

}  // namespace

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
    info_.add(info.parameters.*parameter.field);
  }
  info_.add(key_text(command_key_of(info.credentials)));
  info_.add(info.credentials.key_set);
  info_.add(info.credentials.boot_epoch);
}

void SessionHash::set_terrain_before(const HeightMapView& map) {
  terrain_before_ = terrain_hash(map);
}

void SessionHash::set_terrain_after(const HeightMapView& map) {
  terrain_after_ = terrain_hash(map);
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
  return hash.hex();
}

}  // namespace screed
