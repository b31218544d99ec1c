// How a robot of a model is driven: on tracks or wheels, with which friction and motors. Apart from
// vehicle.h, which brings ODE: worlds without it take these options too.
#pragma once

#include <optional>

#include "host_sim/physics/vehicle/drive_train.h"

namespace screed {

enum class TrackModel {
  kBelt,   ///< a contour of fixed shape whose surface moves (running_gear.h)
  kChain,  ///< links round the wheels (chain_track.h)
};

struct ChainOptions {
  int links = 0;             ///< of each side; 0: as many as make links of about 10 mm
  double tension_n = 10.0;   ///< of the chain at rest on its wheels
  double mass_kg = 0.06;     ///< of one side, taken from the mass of its wheels
  double stiffness_n = 1e4;  ///< tension that would stretch it to twice its length
};

struct VehicleOptions {
  /// A track round the wheels of each side. false: the wheels alone, all four driven; a wheel
  /// without a motor of its own is geared to the other one of its side.
  bool tracks = true;
  TrackModel track_model = TrackModel::kBelt;
  ChainOptions chain;
  double track_friction = 0.8;         ///< Coulomb coefficient, rubber on the ground
  std::optional<double> lug_height_m;  ///< of the tread; left out: as lugs_m() says
  double chassis_friction = 0.4;
  double wall_friction = 0.3;  ///< of anything on the walls of a bed
  GearMotor motor;

  /// Height of the tread of tracks or wheels, m: 2 mm on tracks is assumed.
  double lugs_m() const { return lug_height_m.value_or(tracks ? 0.002 : 0.0); }
};

}  // namespace screed
