// A skid-steered robot in the world.
#include "host_sim/physics/vehicle/vehicle.h"

#include <algorithm>
#include <limits>

namespace screed {
namespace {

// How much easier soil has to think a body tilts whose chains follow it a step late (measured:
// calm from 1.5 on, chatter at 1).
constexpr double kChainYields = 2.0;

}  // namespace

void Vehicle::place(const Eigen::Isometry3d& pose) {
  dMatrix3 rotation;
  to_ode(pose.linear(), rotation);
  for (Carrier& carrier : carriers_) {
    const Eigen::Vector3d at = pose * carrier.rest.translation();
    dBodySetPosition(carrier.body, at.x(), at.y(), at.z());
    dBodySetRotation(carrier.body, rotation);
    dBodySetLinearVel(carrier.body, 0, 0, 0);
    dBodySetAngularVel(carrier.body, 0, 0, 0);
    carrier.hull.reset_contacts();
    carrier.soil_memory = {};
  }
  for (Shaft& shaft : shafts_) shaft.shaft.halt();
  for (Unit& unit : units_) unit.gear.reset_contacts();
  for (Chain& chain : chains_) chain.track.reset();
}

void Vehicle::shift(double dx_m, double dy_m) {
  for (const Carrier& carrier : carriers_) {
    const dReal* at = dBodyGetPosition(carrier.body);
    dBodySetPosition(carrier.body, at[0] + dx_m, at[1] + dy_m, at[2]);
  }
}

double Vehicle::resting_height(const HeightField& ground, double x, double y,
                               const Eigen::Matrix3d& rotation) const {
  double height = -std::numeric_limits<double>::infinity();
  const auto rest_on = [&](const Carrier& carrier, const Eigen::Vector3d& point) {
    const Eigen::Vector3d at = rotation * (carrier.rest * point);
    height = std::max(height, ground.at(x + at.x(), y + at.y()).height - at.z());
  };
  for (const Carrier& carrier : carriers_) {
    for (const Eigen::Vector3d& point : carrier.hull.points()) rest_on(carrier, point);
  }
  for (const Unit& unit : units_) {
    for (const Eigen::Vector3d& point : unit.gear.points()) rest_on(carriers_[unit.carrier], point);
  }
  for (const Chain& chain : chains_) {
    for (const Eigen::Vector3d& point : chain.track.points()) {
      rest_on(carriers_[chain.carrier], point);
    }
  }
  return height;
}

template <class Step>
void Vehicle::step_chains(size_t carrier, Step step) {
  for (Chain& chain : chains_) {
    if (chain.carrier != carrier) continue;
    const std::array<double, 2> torque = step(chain);
    for (const size_t wheel : {0U, 1U}) shafts_[chain.shafts[wheel]].torque += torque[wheel];
  }
}

void Vehicle::terrain_contact(SoilBed& soil, size_t carrier, const CarrierMotion& motion, double dt,
                              Wrench& wrench) {
  Carrier& pressing = carriers_[carrier];
  soil_contacts_.clear();
  for (Unit& unit : units_) {
    if (unit.carrier != carrier) continue;
    const double speed = shafts_[unit.shaft].shaft.omega_rad_per_s() * unit.gear.radius_m();
    soil_contacts_.push_back(unit.gear.soil_contact(motion, speed));
  }
  for (Chain& chain : chains_) {
    if (chain.carrier == carrier) soil_contacts_.push_back(chain.track.soil_contact(motion));
  }
  const size_t gear = soil_contacts_.size();
  pressing.hull.add_soil_contacts(soil, motion, soil_contacts_);

  PressingBody body;
  // What hangs on it by hinges rests on it, too: never less than its units' share of the robot.
  body.mass_kg = std::max(pressing.mass, mass_ * static_cast<double>(gear) /
                                             static_cast<double>(units_.size() + chains_.size()));
  const double yields = chains_.empty() ? 1.0 : kChainYields;
  body.inverse_inertia =
      yields * motion.rotation * pressing.inverse_inertia * motion.rotation.transpose();
  body.centre = motion.origin;
  body.velocity = motion.velocity;
  body.omega = motion.omega;
  soil.press(body, soil_contacts_, dt, pressing.soil_memory);

  for (const SoilContact& contact : soil_contacts_) {
    wrench.add(contact.reaction.force, contact.footprint->pose().translation() - motion.origin);
    wrench.torque += contact.reaction.torque;
  }
  size_t i = 0;
  for (Unit& unit : units_) {
    if (unit.carrier != carrier) continue;
    const SoilReaction& reaction = soil_contacts_[i++].reaction;
    shafts_[unit.shaft].torque += unit.gear.radius_m() * reaction.along_surface;
    unit.gear.set_soil_reaction(reaction);
  }
  step_chains(carrier, [&](Chain& chain) {
    return chain.track.step(soil_contacts_[i++].reaction, motion, wheel_rates(chain), dt, wrench);
  });
}

template <class Ground>
void Vehicle::terrain_contact(Ground& ground, size_t carrier, const CarrierMotion& motion,
                              double dt, Wrench& wrench) {
  for (Unit& unit : units_) {
    if (unit.carrier != carrier) continue;
    Shaft& shaft = shafts_[unit.shaft];
    const double radius = unit.gear.radius_m();
    const double speed = shaft.shaft.omega_rad_per_s() * radius;
    shaft.torque += radius * unit.gear.contact(ground, motion, speed, dt, wrench);
  }
  step_chains(carrier, [&](Chain& chain) {
    return chain.track.step(ground, motion, wheel_rates(chain), dt, wrench);
  });
  carriers_[carrier].hull.contact(ground, motion, dt, wrench);
}

ChainTrack::WheelRates Vehicle::wheel_rates(const Chain& chain) const {
  return {shafts_[chain.shafts[0]].shaft.omega_rad_per_s(),
          shafts_[chain.shafts[1]].shaft.omega_rad_per_s()};
}

template <class Ground>
void Vehicle::apply(Ground& ground, const std::array<double, 2>& motor_voltage, double dt) {
  for (Shaft& shaft : shafts_) shaft.torque = 0.0;
  for (size_t c = 0; c < carriers_.size(); ++c) {
    Carrier& carrier = carriers_[c];
    CarrierMotion motion;
    motion.origin = to_eigen(dBodyGetPosition(carrier.body));
    motion.rotation = rotation_to_eigen(dBodyGetRotation(carrier.body));
    motion.velocity = to_eigen(dBodyGetLinearVel(carrier.body));
    motion.omega = to_eigen(dBodyGetAngularVel(carrier.body));

    Wrench wrench;
    terrain_contact(ground, c, motion, dt, wrench);
    dBodyAddForce(carrier.body, wrench.force.x(), wrench.force.y(), wrench.force.z());
    dBodyAddTorque(carrier.body, wrench.torque.x(), wrench.torque.y(), wrench.torque.z());
  }
  for (Shaft& shaft : shafts_) {
    shaft.shaft.step(motor_voltage[static_cast<size_t>(shaft.side)], shaft.torque, dt);
  }
}

void Vehicle::apply_forces(const HeightField& ground, const std::array<double, 2>& motor_voltage,
                           double dt) {
  apply(ground, motor_voltage, dt);
}

void Vehicle::apply_forces(SoilBed& soil, const std::array<double, 2>& motor_voltage, double dt) {
  apply(soil, motor_voltage, dt);
}

void Vehicle::apply_forces(ParticleBed& particles, const std::array<double, 2>& motor_voltage,
                           double dt) {
  apply(particles, motor_voltage, dt);
}

ChassisState Vehicle::chassis() const {
  const Carrier& carrier = carriers_[chassis_carrier_];
  ChassisState state;
  const Eigen::Matrix3d rotation = rotation_to_eigen(dBodyGetRotation(carrier.body));
  const Eigen::Vector3d omega = to_eigen(dBodyGetAngularVel(carrier.body));
  const Eigen::Vector3d offset = rotation * carrier.rest.translation();
  state.pose.linear() = rotation;
  state.pose.translation() = to_eigen(dBodyGetPosition(carrier.body)) - offset;
  state.velocity = to_eigen(dBodyGetLinearVel(carrier.body)) - omega.cross(offset);
  state.omega_body = rotation.transpose() * omega;
  return state;
}

double Vehicle::track_speed_m_per_s(Side side) const {
  return shaft_of(side).omega_rad_per_s() * wheel_radius_m(side);
}
double Vehicle::shaft_angle_rad(Side side) const {
  return shaft_of(side).angle_rad();
}
double Vehicle::wheel_radius_m(Side side) const {
  return of(side).radius;
}

const ChainTrack* Vehicle::chain(Side side) const {
  return chains_.empty() ? nullptr : &chains_[static_cast<size_t>(side)].track;
}

double Vehicle::current_a(Side side) const {
  double sum = 0.0;
  for (const Shaft& shaft : shafts_) {
    if (shaft.side == side) sum += shaft.shaft.current_a();
  }
  return sum;
}

double Vehicle::load_n(Side side) const {
  double sum = chain(side) != nullptr ? chain(side)->normal_load_n() : 0.0;
  for (const Unit& unit : units_) {
    if (shafts_[unit.shaft].side == side) sum += unit.gear.normal_load_n();
  }
  return sum;
}

double Vehicle::sinkage_m(Side side) const {
  double deepest = chain(side) != nullptr ? chain(side)->sinkage_m() : 0.0;
  for (const Unit& unit : units_) {
    if (shafts_[unit.shaft].side == side) deepest = std::max(deepest, unit.gear.sinkage_m());
  }
  return deepest;
}

double Vehicle::ground_speed_m_per_s(Side side) const {
  const Carrier& carrier = carriers_[of(side).carrier];
  const Eigen::Matrix3d rotation = rotation_to_eigen(dBodyGetRotation(carrier.body));
  const Eigen::Vector3d arm = rotation * of(side).centre;
  const Eigen::Vector3d velocity = to_eigen(dBodyGetLinearVel(carrier.body)) +
                                   to_eigen(dBodyGetAngularVel(carrier.body)).cross(arm);
  return rotation.col(0).dot(velocity);
}

}  // namespace screed
