// A skid-steered robot in the world.
#include "host_sim/physics/vehicle/vehicle.h"

#include <algorithm>
#include <limits>

#include "host_sim/core/constants.h"

namespace screed {
namespace {

// Factor on the inverse inertia that the terrain sees of a body with chains: they follow it one
// step late. 1 chatters, from 1.5 on it is calm (measured).
constexpr double kChainMobilityFactor = 2.0;

}  // namespace

Vehicle::Vehicle(OdeWorld& world, const Assembly& assembly, const VehicleOptions& options)
    : VehicleParts(assembly, options) {
  add_bodies(world);
  place(Eigen::Isometry3d::Identity());
  add_hinges(world, assembly);
}

void Vehicle::add_bodies(OdeWorld& world) {
  for (const Carrier& carrier : carriers_) {
    const Eigen::Matrix3d& tensor = carrier.inertia;
    dMass mass;
    dMassSetParameters(&mass, carrier.mass, 0, 0, 0, tensor(0, 0), tensor(1, 1), tensor(2, 2),
                       tensor(0, 1), tensor(0, 2), tensor(1, 2));
    bodies_.push_back(dBodyCreate(world.id()));
    dBodySetMass(bodies_.back(), &mass);
  }
}

void Vehicle::add_hinges(OdeWorld& world, const Assembly& assembly) {
  for (const AssemblyJoint& joint : assembly.joints) {
    const size_t parent = carrier_of_body_[static_cast<size_t>(joint.parent)];
    const size_t child = carrier_of_body_[static_cast<size_t>(joint.child)];
    if (parent == child) continue;  // fixed, or a wheel
    dJointID hinge = dJointCreateHinge(world.id(), nullptr);
    dJointAttach(hinge, bodies_[child], bodies_[parent]);
    const Eigen::Vector3d anchor = joint.pose.translation();
    dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(hinge, joint.axis.x(), joint.axis.y(), joint.axis.z());
    if (joint.limited) {
      dJointSetHingeParam(hinge, dParamLoStop, joint.lower_rad);
      dJointSetHingeParam(hinge, dParamHiStop, joint.upper_rad);
    }
  }
}

void Vehicle::place(const Eigen::Isometry3d& pose) {
  dMatrix3 rotation;
  to_ode(pose.linear(), rotation);
  for (size_t i = 0; i < carriers_.size(); ++i) {
    Carrier& carrier = carriers_[i];
    const Eigen::Vector3d at = pose * carrier.rest_pose.translation();
    dBodySetPosition(bodies_[i], at.x(), at.y(), at.z());
    dBodySetRotation(bodies_[i], rotation);
    dBodySetLinearVel(bodies_[i], 0, 0, 0);
    dBodySetAngularVel(bodies_[i], 0, 0, 0);
    carrier.hull.reset_contacts();
    carrier.walls.reset_contacts();
    carrier.memory = {};
  }
  for (Shaft& shaft : shafts_) shaft.shaft.halt();
  for (Unit& unit : units_) unit.gear.reset_contacts();
  for (Chain& chain : chains_) chain.track.reset();
}

void Vehicle::shift(double dx_m, double dy_m) {
  for (const dBodyID body : bodies_) {
    const dReal* at = dBodyGetPosition(body);
    dBodySetPosition(body, at[0] + dx_m, at[1] + dy_m, at[2]);
  }
}

Eigen::AlignedBox2d Vehicle::outline() const {
  Eigen::AlignedBox2d box;
  for (size_t c = 0; c < carriers_.size(); ++c) {
    const WallContact& walls = carriers_[c].walls;
    const Eigen::Matrix3d rotation = rotation_to_eigen(dBodyGetRotation(bodies_[c]));
    const Eigen::Vector3d origin = to_eigen(dBodyGetPosition(bodies_[c]));
    for (size_t i = 0; i < walls.points(); ++i) {
      const Eigen::Vector3d at = origin + rotation * walls.point(i);
      box.extend(Eigen::Vector2d(at.head<2>()));
    }
  }
  return box;
}

Vehicle::ContactRanges Vehicle::collect_contacts(const Terrain& terrain, size_t carrier,
                                                 const CarrierMotion& motion, double dt) {
  const FootprintShape shape = terrain.footprint_shape();
  contacts_.clear();
  for (Unit& unit : units_) {
    if (unit.carrier != carrier || shape == FootprintShape::kNone) continue;
    contacts_.push_back(unit.gear.make_footprint_contact(shape, motion, surface_speed(unit)));
  }
  ContactRanges begin{};
  begin.chains = contacts_.size();
  for (Chain& chain : chains_) {
    if (chain.carrier != carrier) continue;
    chain.track.begin_step(shape, motion, wheel_rates(chain), dt, contacts_);
  }
  begin.hull = contacts_.size();
  if (shape != FootprintShape::kNone) {
    carriers_[carrier].hull.add_footprint_contacts(terrain, motion, contacts_);
  }
  return begin;
}

PressingBody Vehicle::pressing_body(size_t carrier, const CarrierMotion& motion) const {
  const Carrier& pressing = carriers_[carrier];
  const auto here = [&](const auto& gear) { return gear.carrier == carrier; };
  const auto gears = std::count_if(units_.begin(), units_.end(), here) +
                     std::count_if(chains_.begin(), chains_.end(), here);
  PressingBody body;
  // What hangs on it by hinges rests on it, too: never less than its units' share of the robot.
  body.mass_kg = std::max(pressing.mass, mass_ * static_cast<double>(gears) /
                                             static_cast<double>(units_.size() + chains_.size()));
  const double mobility_factor = chains_.empty() ? 1.0 : kChainMobilityFactor;
  body.inverse_inertia =
      mobility_factor * motion.rotation * pressing.inverse_inertia * motion.rotation.transpose();
  body.centre = motion.origin;
  body.velocity = motion.velocity;
  body.omega = motion.omega;
  return body;
}

void Vehicle::end_chains(const Terrain& terrain, size_t carrier, size_t first,
                         const CarrierMotion& motion, double dt, Wrench& wrench) {
  const std::span<const FootprintContact> contacts = contacts_;
  for (Chain& chain : chains_) {
    if (chain.carrier != carrier) continue;
    const size_t count = chain.track.footprint_count(terrain.footprint_shape());
    const std::array<double, 2> torque =
        chain.track.end_step(terrain, contacts.subspan(first, count), motion, dt, wrench);
    for (const size_t wheel : {0U, 1U}) shafts_[chain.shafts[wheel]].torque += torque[wheel];
    first += count;
  }
}

void Vehicle::terrain_contact(Terrain& terrain, size_t carrier, const CarrierMotion& motion,
                              double dt, Wrench& wrench) {
  const HeightField* hard = terrain.hard_surface();
  const FootprintShape shape = terrain.footprint_shape();
  const ContactRanges begin = collect_contacts(terrain, carrier, motion, dt);
  if (shape != FootprintShape::kNone) {
    terrain.press(pressing_body(carrier, motion), contacts_, dt, carriers_[carrier].memory);
  }

  size_t next = 0;
  for (Unit& unit : units_) {
    if (unit.carrier != carrier) continue;
    const FootprintContact* pressed = shape == FootprintShape::kNone ? nullptr : &contacts_[next++];
    shafts_[unit.shaft].torque +=
        unit.gear.radius_m() *
        unit.gear.apply_contact(hard, pressed, motion, surface_speed(unit), dt, wrench);
  }
  // A band's force acts on the carrier as a whole; its pins are solved after the carrier has
  // received all forces.
  const bool bands = shape == FootprintShape::kLowerSurface;
  if (bands) {
    for (size_t i = begin.chains; i < begin.hull; ++i) wrench.add(contacts_[i]);
  } else {
    end_chains(terrain, carrier, begin.chains, motion, dt, wrench);
  }
  Hull& hull = carriers_[carrier].hull;
  if (hard != nullptr) hull.stand_on(*hard, motion, dt, wrench);
  for (size_t i = begin.hull; i < contacts_.size(); ++i) wrench.add(contacts_[i]);
  if (bands) end_chains(terrain, carrier, begin.chains, motion, dt, wrench);
}

void Vehicle::meet_walls(const BedBounds& bed, size_t carrier, const CarrierMotion& motion,
                         double dt, Wrench& wrench) {
  WallContact& walls = carriers_[carrier].walls;
  if (!walls.within_reach(bed, motion.origin)) {
    walls.reset_contacts();
    return;
  }
  list_shaft_drives();
  // A chain answers by itself, its wheels a step later (ChainTrack::pull).
  for (const Chain& chain : chains_) {
    const double radius = chain.track.radius_m();
    drives_.push_back({chain.track.surface_speed(motion) / radius,
                       1.0 / (chain.track.mass_kg() * radius * radius), 0.0});
  }
  walls.press(bed, moving_body(carrier, motion), motion.rotation, dt, drives_, wrench);
  for (size_t i = 0; i < shafts_.size(); ++i) shafts_[i].torque += drives_[i].torque_n_m;
  for (const WallContact::Touch& touch : walls.touches()) {
    const size_t drive = walls.drive(touch.point);
    if (drive == WallContact::kNoDrive || drive < shafts_.size()) continue;
    chains_[drive - shafts_.size()].track.pull(motion, touch.arm, touch.along,
                                               touch.friction() / dt);
  }
}

ChainTrack::WheelRates Vehicle::wheel_rates(const Chain& chain) const {
  return {shafts_[chain.shafts[0]].shaft.omega_rad_per_s(),
          shafts_[chain.shafts[1]].shaft.omega_rad_per_s()};
}

CarrierMotion Vehicle::motion_of(size_t carrier) const {
  const dBodyID body = bodies_[carrier];
  CarrierMotion motion;
  motion.origin = to_eigen(dBodyGetPosition(body));
  motion.rotation = rotation_to_eigen(dBodyGetRotation(body));
  motion.velocity = to_eigen(dBodyGetLinearVel(body));
  motion.omega = to_eigen(dBodyGetAngularVel(body));
  motion.mass_kg = carriers_[carrier].mass;
  motion.inverse_inertia = carriers_[carrier].inverse_inertia;
  return motion;
}

PressingBody Vehicle::moving_body(size_t carrier, const CarrierMotion& motion) const {
  PressingBody body;
  body.mass_kg = carriers_[carrier].mass;
  body.inverse_inertia =
      motion.rotation * carriers_[carrier].inverse_inertia * motion.rotation.transpose();
  body.centre = motion.origin;
  body.velocity = motion.velocity;
  body.omega = motion.omega;
  return body;
}

void Vehicle::list_shaft_drives() {
  drives_.clear();
  for (const Shaft& shaft : shafts_) {
    drives_.push_back({shaft.shaft.omega_rad_per_s(), 1.0 / shaft.shaft.inertia_kg_m2(), 0.0});
  }
}

void Vehicle::add_wrench(size_t carrier, const Wrench& wrench) {
  const dBodyID body = bodies_[carrier];
  dBodyAddForce(body, wrench.force.x(), wrench.force.y(), wrench.force.z());
  dBodyAddTorque(body, wrench.torque.x(), wrench.torque.y(), wrench.torque.z());
}

RobotBody Vehicle::robot_body(size_t carrier, const Eigen::Vector3d& offset, Wrench& wrench) {
  CarrierMotion motion = motion_of(carrier);
  motion.origin += offset;
  const Carrier& of = carriers_[carrier];
  return {moving_body(carrier, motion),
          motion.rotation,
          of.reach,
          of.points,
          of.solids,
          mass_,
          drives_,
          wrench};
}

bool Vehicle::within_reach(double gap_m, size_t mine, const Vehicle& other, size_t theirs,
                           const Eigen::Vector3d& to_other) const {
  const Eigen::Vector3d apart = to_eigen(dBodyGetPosition(other.bodies_[theirs])) + to_other -
                                to_eigen(dBodyGetPosition(bodies_[mine]));
  const double reach = carriers_[mine].reach + other.carriers_[theirs].reach + gap_m;
  return apart.squaredNorm() < reach * reach;
}

template <class Visit>
void Vehicle::visit_near(double gap_m, Vehicle& other, const Eigen::Vector3d& to_other,
                         Visit visit) {
  for (size_t mine = 0; mine < carriers_.size(); ++mine) {
    for (size_t theirs = 0; theirs < other.carriers_.size(); ++theirs) {
      if (within_reach(gap_m, mine, other, theirs, to_other)) visit(mine, theirs);
    }
  }
}

void Vehicle::collide(Vehicle& other, const Eigen::Vector3d& to_other, double dt,
                      RobotContact& contact) {
  visit_near(contact.notice_m(), other, to_other, [&](size_t mine, size_t theirs) {
    list_shaft_drives();
    other.list_shaft_drives();
    Wrench on_mine;
    Wrench on_theirs;
    contact.press(robot_body(mine, Eigen::Vector3d::Zero(), on_mine),
                  other.robot_body(theirs, to_other, on_theirs), dt);
    add_wrench(mine, on_mine);
    other.add_wrench(theirs, on_theirs);
    for (Vehicle* const robot : {this, &other}) {
      for (size_t i = 0; i < robot->shafts_.size(); ++i)
        robot->shafts_[i].torque += robot->drives_[i].torque_n_m;
    }
  });
}

double Vehicle::depth_in(Vehicle& other, const Eigen::Vector3d& to_other, RobotContact& contact) {
  double deepest = 0.0;
  visit_near(contact.notice_m(), other, to_other, [&](size_t mine, size_t theirs) {
    Wrench none;
    deepest = std::max(deepest, contact.depth(robot_body(mine, Eigen::Vector3d::Zero(), none),
                                              other.robot_body(theirs, to_other, none)));
  });
  return deepest;
}

void Vehicle::apply_forces(Terrain& terrain, const std::array<double, 2>& motor_voltage,
                           double dt) {
  const BedBounds bed = terrain.bounds();
  for (size_t c = 0; c < carriers_.size(); ++c) {
    const CarrierMotion motion = motion_of(c);
    Wrench wrench;
    terrain_contact(terrain, c, motion, dt, wrench);
    if (bed.edge == BedEdge::kWalled) meet_walls(bed, c, motion, dt, wrench);
    add_wrench(c, wrench);
  }
  for (Shaft& shaft : shafts_) {
    shaft.shaft.step(motor_voltage[static_cast<size_t>(shaft.side)], shaft.torque, dt);
    shaft.torque = 0.0;
  }
}

ChassisState Vehicle::chassis() const {
  const dBodyID body = bodies_[chassis_carrier_];
  ChassisState state;
  const Eigen::Matrix3d rotation = rotation_to_eigen(dBodyGetRotation(body));
  const Eigen::Vector3d omega = to_eigen(dBodyGetAngularVel(body));
  const Eigen::Vector3d offset = rotation * carriers_[chassis_carrier_].rest_pose.translation();
  state.pose.linear() = rotation;
  state.pose.translation() = to_eigen(dBodyGetPosition(body)) - offset;
  state.velocity = to_eigen(dBodyGetLinearVel(body)) - omega.cross(offset);
  state.omega_body = rotation.transpose() * omega;
  return state;
}

double Vehicle::energy_j() const {
  double energy = 0.0;
  for (size_t i = 0; i < carriers_.size(); ++i) {
    const CarrierMotion motion = motion_of(i);
    const Eigen::Vector3d omega = motion.rotation.transpose() * motion.omega;
    energy += carriers_[i].mass *
                  (0.5 * motion.velocity.squaredNorm() + kGravity_m_per_s2 * motion.origin.z()) +
              0.5 * omega.dot(carriers_[i].inertia * omega);
  }
  for (const Shaft& shaft : shafts_) {
    const double omega = shaft.shaft.omega_rad_per_s();
    energy += 0.5 * shaft.shaft.inertia_kg_m2() * omega * omega;
  }
  return energy;
}

double Vehicle::motor_work_j() const {
  double work = 0.0;
  for (const Shaft& shaft : shafts_) work += shaft.shaft.motor_work_j();
  return work;
}

double Vehicle::track_speed_m_per_s(Side side) const {
  return shaft_of(side).omega_rad_per_s() * wheel_radius_m(side);
}
double Vehicle::shaft_angle_rad(Side side) const {
  return shaft_of(side).angle_rad();
}
double Vehicle::wheel_radius_m(Side side) const {
  return VehicleParts::wheel_radius_m(side);
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
  const dBodyID body = bodies_[of(side).carrier];
  const Eigen::Matrix3d rotation = rotation_to_eigen(dBodyGetRotation(body));
  const Eigen::Vector3d arm = rotation * of(side).centre;
  const Eigen::Vector3d velocity =
      to_eigen(dBodyGetLinearVel(body)) + to_eigen(dBodyGetAngularVel(body)).cross(arm);
  return rotation.col(0).dot(velocity);
}

}  // namespace screed
