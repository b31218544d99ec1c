// A skid-steered robot in the world.
#include "host_sim/vehicle/vehicle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kHullSpacing_m = 0.04;  // of contact points on boxes
constexpr double kHullSinkIn_m = 0.001;  // when four points carry the whole robot
// How much easier soil has to think a body tilts whose chains follow it a step late (measured:
// calm from 1.5 on, chatter at 1).
constexpr double kChainYields = 2.0;

const char* const kWheels[2][2] = {{"fl_Wheel", "bl_Wheel"}, {"fr_Wheel", "br_Wheel"}};

bool is_wheel_name(const std::string& name) {
  for (const auto& side : kWheels) {
    for (const char* wheel : side) {
      if (name == wheel) return true;
    }
  }
  return false;
}

// Points on the surface of a shape, dense enough that the ground cannot pass between them
// unnoticed.
void add_hull_points(const Shape& shape, const Eigen::Isometry3d& pose,
                     std::vector<Eigen::Vector3d>& points) {
  const Eigen::Isometry3d at = pose * shape.pose;
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    Eigen::Vector3i count;
    for (int axis = 0; axis < 3; ++axis) {
      count[axis] = std::max(1, static_cast<int>(std::ceil(box->size[axis] / kHullSpacing_m)));
    }
    for (int i = 0; i <= count.x(); ++i) {
      for (int j = 0; j <= count.y(); ++j) {
        for (int k = 0; k <= count.z(); ++k) {
          const bool surface =
              i == 0 || j == 0 || k == 0 || i == count.x() || j == count.y() || k == count.z();
          if (!surface) continue;
          const Eigen::Vector3d share(static_cast<double>(i) / count.x() - 0.5,
                                      static_cast<double>(j) / count.y() - 0.5,
                                      static_cast<double>(k) / count.z() - 0.5);
          points.emplace_back(at * share.cwiseProduct(box->size));
        }
      }
    }
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    constexpr int kAround = 12;
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kAround;
      for (const double end : {-0.5, 0.5}) {
        points.emplace_back(at * Eigen::Vector3d(cylinder->radius * std::cos(angle),
                                                 cylinder->radius * std::sin(angle),
                                                 end * cylinder->length));
      }
    }
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
    for (const Eigen::Vector3d& vertex : mesh->vertices) points.emplace_back(at * vertex);
  }
}

// The box that stands for a shape on soil: itself, or the box round a cylinder or a mesh.
void add_hull_box(const Shape& shape, const Eigen::Isometry3d& pose, std::vector<Footprint>& boxes,
                  std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Isometry3d at = pose * shape.pose;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    size = box->size;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    size = {2.0 * cylinder->radius, 2.0 * cylinder->radius, cylinder->length};
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
    Eigen::AlignedBox3d bounds;
    for (const Eigen::Vector3d& vertex : mesh->vertices) bounds.extend(vertex);
    if (bounds.isEmpty()) return;
    size = bounds.sizes();
    at = at * Eigen::Translation3d(bounds.center());
  }
  boxes.push_back(Footprint::box(size));
  poses.push_back(at);
}

// The cylinder a wheel rolls on: its radius and length.
const Cylinder& wheel_cylinder(const AssemblyBody& wheel) {
  for (const Shape& shape : wheel.collision) {
    if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) return *cylinder;
  }
  throw InputError("robot model: wheel '" + wheel.name + "' has no collision cylinder to roll on");
}

const AssemblyJoint* joint_to(const Assembly& assembly, int child) {
  for (const AssemblyJoint& joint : assembly.joints) {
    if (joint.child == child) return &joint;
  }
  return nullptr;
}

// The wheels carry the mass of the tracks in the model: a chain has its own.
Assembly without_chains(Assembly assembly, double chain_kg) {
  for (const auto& side : kWheels) {
    for (const char* wheel : side) {
      Inertia& inertia = assembly.bodies[static_cast<size_t>(assembly.body_index(wheel))].inertia;
      const double left = inertia.mass - 0.5 * chain_kg;
      if (left <= 0.0) {
        throw InputError(std::string("robot model: a chain of ") + std::to_string(chain_kg) +
                         " kg is heavier than its two wheels; '" + wheel + "' has " +
                         std::to_string(inertia.mass) + " kg");
      }
      inertia.tensor *= left / inertia.mass;
      inertia.mass = left;
    }
  }
  return assembly;
}

}  // namespace

Attitude attitude_of(const Eigen::Matrix3d& r) {
  return {std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
          std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Matrix3d rotation_from(const Attitude& attitude) {
  // Nose up is a negative turn about y, which points left; left side up is a positive turn about x.
  return (Eigen::AngleAxisd(attitude.heading, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(-attitude.pitch, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(attitude.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Vehicle::Vehicle(OdeWorld& world, const Assembly& assembly, const VehicleOptions& options)
    : world_(world) {
  std::vector<bool> is_wheel(assembly.bodies.size());
  for (size_t i = 0; i < assembly.bodies.size(); ++i)
    is_wheel[i] = is_wheel_name(assembly.bodies[i].name);
  for (const AssemblyJoint& joint : assembly.joints) {
    if (joint.kind == AssemblyJoint::Kind::Motor && !is_wheel[static_cast<size_t>(joint.child)]) {
      throw InputError("robot model: motor joint '" + joint.name + "' drives '" +
                       assembly.bodies[static_cast<size_t>(joint.child)].name +
                       "'; only fl_Wheel, fr_Wheel, bl_Wheel and br_Wheel can be driven");
    }
  }
  if (options.tracks && options.track_model == TrackModel::kChain) {
    const Assembly without = without_chains(assembly, options.chain.mass_kg);
    mass_ = 2.0 * options.chain.mass_kg;
    add_carriers(without, is_wheel, options);
    add_hinges(without);
    add_running_gear(without, options);
    return;
  }
  add_carriers(assembly, is_wheel, options);
  add_hinges(assembly);
  add_running_gear(assembly, options);
}

void Vehicle::add_carriers(const Assembly& assembly, const std::vector<bool>& is_wheel,
                           const VehicleOptions& options) {
  constexpr size_t kNone = std::numeric_limits<size_t>::max();
  carrier_of_body_.assign(assembly.bodies.size(), kNone);
  std::vector<std::vector<int>> groups;
  // Parents come before their children's groups are closed: fixed joints first, then wheels join
  // whoever carries them.
  for (size_t i = 0; i < assembly.bodies.size(); ++i) {
    if (carrier_of_body_[i] != kNone || is_wheel[i]) continue;
    groups.push_back(rigid_group(assembly, static_cast<int>(i)));
    for (const int member : groups.back())
      carrier_of_body_[static_cast<size_t>(member)] = groups.size() - 1;
  }
  for (size_t i = 0; i < assembly.bodies.size(); ++i) {
    if (carrier_of_body_[i] != kNone) continue;
    const AssemblyJoint* joint = joint_to(assembly, static_cast<int>(i));
    if (joint == nullptr || is_wheel[static_cast<size_t>(joint->parent)]) {
      throw InputError("robot model: wheel '" + assembly.bodies[i].name +
                       "' has no body that carries it");
    }
    const size_t carrier = carrier_of_body_[static_cast<size_t>(joint->parent)];
    carrier_of_body_[i] = carrier;
    groups[carrier].push_back(static_cast<int>(i));
  }

  for (const std::vector<int>& group : groups) mass_ += composed_inertia(assembly, group).mass;
  for (const std::vector<int>& group : groups) {
    const Inertia inertia = composed_inertia(assembly, group);
    if (inertia.mass <= 0.0) {
      throw InputError("robot model: body '" +
                       assembly.bodies[static_cast<size_t>(group.front())].name + "' has no mass");
    }
    Carrier carrier{};
    carrier.rest = Eigen::Isometry3d::Identity();
    carrier.rest.translation() = inertia.pose.translation();
    const Eigen::Matrix3d axes = inertia.pose.linear();
    const Eigen::Matrix3d tensor = axes * inertia.tensor * axes.transpose();
    carrier.body = dBodyCreate(world_.id());
    dMass mass;
    dMassSetParameters(&mass, inertia.mass, 0, 0, 0, tensor(0, 0), tensor(1, 1), tensor(2, 2),
                       tensor(0, 1), tensor(0, 2), tensor(1, 2));
    dBodySetMass(carrier.body, &mass);
    for (const int member : group) {
      const AssemblyBody& body = assembly.bodies[static_cast<size_t>(member)];
      if (is_wheel[static_cast<size_t>(member)]) continue;
      for (const Shape& shape : body.collision) {
        const Eigen::Isometry3d at = carrier.rest.inverse() * body.pose;
        add_hull_points(shape, at, carrier.points);
        add_hull_box(shape, at, carrier.boxes, carrier.box_poses);
      }
    }
    carrier.bristles.assign(carrier.points.size(), Eigen::Vector3d::Zero());
    carrier.box_memories.assign(carrier.boxes.size(), ContactMemory{});
    carrier.mass = inertia.mass;
    carrier.inverse_inertia = tensor.inverse();
    carrier.law.friction = options.chassis_friction;
    carrier.law.stiffness = mass_ * kGravity_m_per_s2 / (4.0 * kHullSinkIn_m);
    carrier.law.damping = std::sqrt(carrier.law.stiffness * mass_ / 4.0);
    for (const Eigen::Vector3d& point : carrier.points)
      carrier.radius = std::max(carrier.radius, point.norm());
    carriers_.push_back(std::move(carrier));
  }
  chassis_carrier_ = carrier_of_body_[static_cast<size_t>(assembly.body_index("Body"))];
  place(Eigen::Isometry3d::Identity());
}

void Vehicle::add_hinges(const Assembly& assembly) {
  for (const AssemblyJoint& joint : assembly.joints) {
    const size_t parent = carrier_of_body_[static_cast<size_t>(joint.parent)];
    const size_t child = carrier_of_body_[static_cast<size_t>(joint.child)];
    if (parent == child) continue;  // fixed, or a wheel
    dJointID hinge = dJointCreateHinge(world_.id(), nullptr);
    dJointAttach(hinge, carriers_[child].body, carriers_[parent].body);
    const Eigen::Vector3d anchor = joint.pose.translation();
    dJointSetHingeAnchor(hinge, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(hinge, joint.axis.x(), joint.axis.y(), joint.axis.z());
    if (joint.limited) {
      dJointSetHingeParam(hinge, dParamLoStop, joint.lower_rad);
      dJointSetHingeParam(hinge, dParamHiStop, joint.upper_rad);
    }
  }
}

void Vehicle::add_running_gear(const Assembly& assembly, const VehicleOptions& options) {
  struct Wheel {
    size_t carrier;
    Eigen::Vector3d centre;  // from the carrier's centre of mass
    Cylinder cylinder;
    double spin_inertia;
    bool driven;
  };
  const auto wheel_named = [&](const char* name) {
    const int index = assembly.body_index(name);
    const AssemblyBody& body = assembly.bodies[static_cast<size_t>(index)];
    const AssemblyJoint* joint = joint_to(assembly, index);
    const size_t carrier = carrier_of_body_[static_cast<size_t>(index)];
    const Eigen::Vector3d centre = carriers_[carrier].rest.inverse() * body.pose.translation();
    const Eigen::Matrix3d axes = body.pose.linear() * body.inertia.pose.linear();
    const double spin =
        joint->axis.dot(axes * body.inertia.tensor * axes.transpose() * joint->axis);
    return Wheel{carrier, centre, wheel_cylinder(body), spin,
                 joint->kind == AssemblyJoint::Kind::Motor};
  };

  double side_y[2] = {0.0, 0.0};
  const double units = options.tracks ? 2.0 : 4.0;
  const GearLoad load{mass_ * kGravity_m_per_s2 / units, mass_ / units};
  for (const Side side : {kLeft, kRight}) {
    const Wheel front = wheel_named(kWheels[side][0]);
    const Wheel rear = wheel_named(kWheels[side][1]);
    side_y[side] = (carriers_[front.carrier].rest * front.centre).y();
    const int motors = (front.driven ? 1 : 0) + (rear.driven ? 1 : 0);
    if (motors == 0) {
      throw InputError(std::string("robot model: no motor joint at '") + kWheels[side][0] +
                       "' or '" + kWheels[side][1] +
                       "'; a revolute joint with <limit velocity=\"1.0\"> is one");
    }
    const auto add_shaft = [&](int of_it, double spin_inertia) {
      shafts_.push_back({side, DriveShaft(options.motor, of_it, spin_inertia)});
      return shafts_.size() - 1;
    };
    const auto add_unit = [&](const Wheel& a, const Wheel& b, size_t shaft) {
      const RunningGearGeometry geometry{a.centre, b.centre, a.cylinder.radius, a.cylinder.length};
      units_.push_back({a.carrier, shaft, RunningGear(geometry, options.track_friction, load)});
      Carrier& carrier = carriers_[a.carrier];
      for (const Eigen::Vector3d& point : units_.back().gear.points()) {
        carrier.radius = std::max(carrier.radius, point.norm());
      }
    };
    // The encoder is on the first motor's shaft, front before rear.
    const Wheel& motored = front.driven ? front : rear;
    sides_[static_cast<size_t>(side)] = {motored.carrier, shafts_.size(), motored.centre,
                                         motored.cylinder.radius};
    if (options.tracks && front.carrier != rear.carrier) {
      throw InputError(std::string("robot model: a track needs '") + kWheels[side][0] + "' and '" +
                       kWheels[side][1] +
                       "' on the same rigid body; with joints between them set tracks = false");
    }
    if (options.tracks)
      sides_[static_cast<size_t>(side)].centre = 0.5 * (front.centre + rear.centre);
    if (options.tracks && options.track_model == TrackModel::kChain) {
      const size_t of_front = add_shaft(front.driven ? 1 : 0, front.spin_inertia);
      const size_t of_rear = add_shaft(rear.driven ? 1 : 0, rear.spin_inertia);
      if (!front.driven) sides_[static_cast<size_t>(side)].shaft = of_rear;
      const RunningGearGeometry geometry{front.centre, rear.centre, front.cylinder.radius,
                                         front.cylinder.length};
      chains_.push_back({front.carrier,
                         {of_front, of_rear},
                         ChainTrack(geometry, options.chain, options.track_friction, load)});
    } else if (options.tracks) {
      add_unit(front, rear, add_shaft(motors, front.spin_inertia + rear.spin_inertia));
    } else if (motors == 2) {
      add_unit(front, front, add_shaft(1, front.spin_inertia));
      add_unit(rear, rear, add_shaft(1, rear.spin_inertia));
    } else {
      const size_t both = add_shaft(motors, front.spin_inertia + rear.spin_inertia);
      add_unit(front, front, both);
      add_unit(rear, rear, both);
    }
  }
  tread_ = side_y[kLeft] - side_y[kRight];
}

void Vehicle::place(const Eigen::Isometry3d& pose) {
  dMatrix3 rotation;
  to_ode(pose.linear(), rotation);
  for (Carrier& carrier : carriers_) {
    const Eigen::Vector3d at = pose * carrier.rest.translation();
    dBodySetPosition(carrier.body, at.x(), at.y(), at.z());
    dBodySetRotation(carrier.body, rotation);
    dBodySetLinearVel(carrier.body, 0, 0, 0);
    dBodySetAngularVel(carrier.body, 0, 0, 0);
    carrier.bristles.assign(carrier.points.size(), Eigen::Vector3d::Zero());
    carrier.box_memories.assign(carrier.boxes.size(), ContactMemory{});
    carrier.soil_memory = {};
  }
  for (Shaft& shaft : shafts_) shaft.shaft.halt();
  for (Unit& unit : units_) unit.gear.let_go();
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
    for (const Eigen::Vector3d& point : carrier.points) rest_on(carrier, point);
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

void Vehicle::hull_contact(Carrier& carrier, const HeightField& ground, const CarrierMotion& motion,
                           double dt, Wrench& wrench) {
  const double ceiling =
      ground.max_height_within(motion.origin.x(), motion.origin.y(), carrier.radius) -
      motion.origin.z();
  const Eigen::RowVector3d upwards = motion.rotation.row(2);
  GroundTouch touch;
  for (size_t i = 0; i < carrier.points.size(); ++i) {
    if (upwards.dot(carrier.points[i]) > ceiling) {
      carrier.bristles[i].setZero();
      continue;
    }
    const Eigen::Vector3d arm = motion.rotation * carrier.points[i];
    if (!touches(ground, motion.origin + arm, touch)) {
      carrier.bristles[i].setZero();
      continue;
    }
    const Eigen::Vector3d velocity = motion.velocity + motion.omega.cross(arm);
    wrench.add(contact_force(carrier.law, touch, velocity, velocity, dt, carrier.bristles[i]), arm);
  }
}

/// Adds the boxes of the hull that may touch.
template <class Step>
void Vehicle::step_chains(size_t carrier, Step step) {
  for (Chain& chain : chains_) {
    if (chain.carrier != carrier) continue;
    const std::array<double, 2> torque = step(chain);
    for (const size_t wheel : {0U, 1U}) shafts_[chain.shafts[wheel]].torque += torque[wheel];
  }
}

void Vehicle::hull_footprints(Carrier& carrier, const SoilBed& soil, const CarrierMotion& motion) {
  const double ceiling =
      soil.surface().max_height_within(motion.origin.x(), motion.origin.y(), carrier.radius);
  for (size_t i = 0; i < carrier.boxes.size(); ++i) {
    Eigen::Isometry3d pose = carrier.box_poses[i];
    pose.translation() = motion.origin + motion.rotation * pose.translation();
    pose.linear() = motion.rotation * pose.linear();
    Footprint& box = carrier.boxes[i];
    box.set_pose(pose);
    if (pose.translation().z() - box.reach_down() > ceiling) {
      carrier.box_memories[i] = {};
      continue;
    }
    SoilContact contact;
    contact.footprint = &box;
    contact.memory = &carrier.box_memories[i];
    soil_contacts_.push_back(contact);
  }
}

void Vehicle::ground_contact(SoilBed& soil, size_t carrier, const CarrierMotion& motion, double dt,
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
  hull_footprints(pressing, soil, motion);

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
    unit.gear.answered(reaction);
  }
  step_chains(carrier, [&](Chain& chain) {
    return chain.track.step(soil_contacts_[i++].reaction, motion, wheel_rates(chain), dt, wrench);
  });
}

void Vehicle::hull_contact(Carrier& carrier, ParticleBed& particles, const CarrierMotion& motion,
                           double dt, Wrench& wrench) {
  hull_contact(carrier, particles.floor(), motion, dt, wrench);
  for (size_t i = 0; i < carrier.boxes.size(); ++i) {
    Eigen::Isometry3d pose = carrier.box_poses[i];
    const Eigen::Vector3d arm = motion.rotation * pose.translation();
    pose.linear() = motion.rotation * pose.linear();
    pose.translation() = motion.origin + arm;
    Footprint& box = carrier.boxes[i];
    box.set_pose(pose);
    FootprintMotion moving;
    moving.velocity = motion.velocity + motion.omega.cross(arm);
    moving.omega = motion.omega;
    moving.friction = carrier.law.friction;
    const SoilReaction reaction = particles.press(box, moving, dt);
    wrench.add(reaction.force, arm);
    wrench.torque += reaction.torque;
  }
}

template <class Ground>
void Vehicle::ground_contact(Ground& ground, size_t carrier, const CarrierMotion& motion, double dt,
                             Wrench& wrench) {
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
  hull_contact(carriers_[carrier], ground, motion, dt, wrench);
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
    ground_contact(ground, c, motion, dt, wrench);
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
