// Which bodies are one, what carries the wheels, which shafts turn them.
#include "host_sim/physics/vehicle/vehicle_parts.h"

#include <algorithm>
#include <limits>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

// The wheels carry the mass of the tracks in the model: a chain has its own.
Assembly without_chains(Assembly assembly, double chain_kg) {
  for (const auto& side : assembly.wheels) {
    for (const AssemblyWheel& wheel : side) {
      AssemblyBody& body = assembly.bodies[static_cast<size_t>(wheel.body)];
      Inertia& inertia = body.inertia;
      const double left = inertia.mass - 0.5 * chain_kg;
      if (left <= 0.0) {
        throw InputError(std::string("robot model: a chain of ") + std::to_string(chain_kg) +
                         " kg is heavier than its two wheels; '" + body.name + "' has " +
                         std::to_string(inertia.mass) + " kg");
      }
      inertia.tensor *= left / inertia.mass;
      inertia.mass = left;
    }
  }
  return assembly;
}

}  // namespace

VehicleParts::VehicleParts(const Assembly& assembly, const VehicleOptions& options) {
  std::vector<bool> is_wheel(assembly.bodies.size());
  for (size_t i = 0; i < assembly.bodies.size(); ++i)
    is_wheel[i] = assembly.is_wheel(static_cast<int>(i));
  for (const AssemblyJoint& joint : assembly.joints) {
    if (joint.kind == AssemblyJoint::Kind::Motor && !is_wheel[static_cast<size_t>(joint.child)]) {
      throw InputError("robot model: motor joint '" + joint.name + "' drives '" +
                       assembly.bodies[static_cast<size_t>(joint.child)].name +
                       "'; only the four wheels can be driven: another limit velocity than 1.0 "
                       "makes it a joint that swings freely");
    }
  }
  if (options.tracks && options.track_model == TrackModel::kChain) {
    const Assembly without = without_chains(assembly, options.chain.mass_kg);
    mass_ = 2.0 * options.chain.mass_kg;
    add_carriers(without, is_wheel, options);
    add_running_gear(without, options);
    add_wall_points(options);
    add_hull_surface();
    return;
  }
  add_carriers(assembly, is_wheel, options);
  add_running_gear(assembly, options);
  add_wall_points(options);
  add_hull_surface();
}

void VehicleParts::add_carriers(const Assembly& assembly, const std::vector<bool>& is_wheel,
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
    const AssemblyJoint* joint = assembly.joint_to(static_cast<int>(i));
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
    carrier.rest_pose = Eigen::Isometry3d::Identity();
    carrier.rest_pose.translation() = inertia.pose.translation();
    const Eigen::Matrix3d axes = inertia.pose.linear();
    const Eigen::Matrix3d tensor = axes * inertia.tensor * axes.transpose();
    for (const int member : group) {
      const AssemblyBody& body = assembly.bodies[static_cast<size_t>(member)];
      if (is_wheel[static_cast<size_t>(member)]) continue;
      for (const Shape& shape : body.collision) {
        const Eigen::Isometry3d at = carrier.rest_pose.inverse() * body.pose;
        carrier.hull.add(shape, at);
      }
    }
    carrier.hull.close(options.chassis_friction, mass_);
    carrier.mass = inertia.mass;
    carrier.inertia = tensor;
    carrier.inverse_inertia = tensor.inverse();
    carriers_.push_back(std::move(carrier));
  }
  chassis_carrier_ = carrier_of_body_[static_cast<size_t>(assembly.chassis)];
}

void VehicleParts::add_running_gear(const Assembly& assembly, const VehicleOptions& options) {
  struct Wheel {
    size_t carrier;
    Eigen::Vector3d centre;  // from the carrier's centre of mass
    double radius;
    double width;
    double spin_inertia;
    bool driven;
  };
  const auto in_carrier = [&](const AssemblyWheel& wheel) {
    const AssemblyBody& body = assembly.bodies[static_cast<size_t>(wheel.body)];
    const AssemblyJoint* joint = assembly.joint_to(wheel.body);
    const size_t carrier = carrier_of_body_[static_cast<size_t>(wheel.body)];
    const Eigen::Vector3d centre = carriers_[carrier].rest_pose.inverse() * wheel.centre;
    const Eigen::Matrix3d axes = body.pose.linear() * body.inertia.pose.linear();
    const double spin =
        joint->axis.dot(axes * body.inertia.tensor * axes.transpose() * joint->axis);
    return Wheel{carrier,       centre, wheel.radius_m,
                 wheel.width_m, spin,   joint->kind == AssemblyJoint::Kind::Motor};
  };

  double side_y[2] = {0.0, 0.0};
  const double units = options.tracks ? 2.0 : 4.0;
  const GearLoad load{mass_ * kGravity_m_per_s2 / units, mass_ / units};
  const auto names = [&](Side side, const char* between) {
    const auto& wheels = assembly.wheels.at(static_cast<size_t>(side));
    return "'" + assembly.bodies[static_cast<size_t>(wheels[0].body)].name + "' " + between + " '" +
           assembly.bodies[static_cast<size_t>(wheels[1].body)].name + "'";
  };
  const double lugs = options.lugs_m();
  for (const Side side : {kLeft, kRight}) {
    const Wheel front = in_carrier(assembly.wheels.at(static_cast<size_t>(side))[0]);
    const Wheel rear = in_carrier(assembly.wheels.at(static_cast<size_t>(side))[1]);
    side_y[side] = (carriers_[front.carrier].rest_pose * front.centre).y();
    const int motors = (front.driven ? 1 : 0) + (rear.driven ? 1 : 0);
    if (motors == 0) {
      throw InputError("robot model: no motor joint at " + names(side, "or") +
                       "; a revolute joint with <limit velocity=\"1.0\"> is one");
    }
    const auto add_shaft = [&](int of_it, double spin_inertia) {
      shafts_.push_back({side, DriveShaft(options.motor, of_it, spin_inertia)});
      return shafts_.size() - 1;
    };
    const auto add_unit = [&](const Wheel& a, const Wheel& b, size_t shaft) {
      const RunningGearGeometry geometry{a.centre, b.centre, a.radius, a.width, lugs};
      units_.push_back({a.carrier, shaft, RunningGear(geometry, options.track_friction, load)});
      add_gear_surface(a.carrier, geometry, shaft);
    };
    // The encoder is on the first motor's shaft, front before rear.
    const Wheel& motored = front.driven ? front : rear;
    sides_[static_cast<size_t>(side)] = {motored.carrier, shafts_.size(), motored.centre,
                                         motored.radius};
    if (options.tracks && front.carrier != rear.carrier) {
      throw InputError("robot model: a track needs " + names(side, "and") +
                       " on the same rigid body; with joints between them set tracks = false");
    }
    if (options.tracks)
      sides_[static_cast<size_t>(side)].centre = 0.5 * (front.centre + rear.centre);
    if (options.tracks && options.track_model == TrackModel::kChain) {
      const size_t of_front = add_shaft(front.driven ? 1 : 0, front.spin_inertia);
      const size_t of_rear = add_shaft(rear.driven ? 1 : 0, rear.spin_inertia);
      if (!front.driven) sides_[static_cast<size_t>(side)].shaft = of_rear;
      const RunningGearGeometry geometry{front.centre, rear.centre, front.radius, front.width,
                                         lugs};
      chains_.push_back({front.carrier,
                         {of_front, of_rear},
                         ChainTrack(geometry, options.chain, options.track_friction, load)});
      add_gear_surface(front.carrier, geometry, kNoSurfaceDrive);
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

void VehicleParts::add_wall_points(const VehicleOptions& options) {
  for (Carrier& carrier : carriers_) {
    for (const Eigen::Vector3d& point : carrier.hull.points()) carrier.walls.add_point(point);
  }
  const auto add_gear = [&](size_t carrier, const std::vector<Eigen::Vector3d>& points,
                            const std::vector<Eigen::Vector3d>& directions, size_t drive,
                            double radius_m) {
    for (size_t i = 0; i < points.size(); ++i)
      carriers_[carrier].walls.add_point(points[i], directions[i], drive, radius_m);
  };
  for (const Unit& unit : units_) {
    const RunningGear& gear = unit.gear;
    add_gear(unit.carrier, gear.points(), gear.directions(), unit.shaft, gear.radius_m());
  }
  for (size_t i = 0; i < chains_.size(); ++i) {
    const ChainTrack& track = chains_[i].track;
    add_gear(chains_[i].carrier, track.points(), track.directions(), shafts_.size() + i,
             track.radius_m());
  }
  for (Carrier& carrier : carriers_) carrier.walls.close(options.wall_friction, mass_);
}

void VehicleParts::add_gear_surface(size_t carrier, const RunningGearGeometry& gear, size_t drive) {
  Carrier& of = carriers_[carrier];
  of.solids.push_back(solid_of(gear, drive));
  for (const BodyPoint& point : middle_of(gear, drive)) of.points.push_back(point);
}

void VehicleParts::add_hull_surface() {
  for (Carrier& carrier : carriers_) {
    for (size_t i = 0; i < carrier.walls.points(); ++i)
      carrier.points.push_back(carrier.walls.body_point(i));
    const Hull& hull = carrier.hull;
    for (size_t i = 0; i < hull.boxes().size(); ++i)
      carrier.solids.push_back({hull.boxes()[i], hull.box_poses()[i]});
    carrier.reach = carrier.walls.reach_m();
    for (const SolidPart& solid : carrier.solids) {
      carrier.reach = std::max(carrier.reach, solid.pose.translation().norm() +
                                                  solid.shape.half().norm() + solid.shape.radius());
    }
  }
}

double VehicleParts::resting_height(const HeightField& terrain, double x, double y,
                                    const Eigen::Matrix3d& rotation) const {
  double height = -std::numeric_limits<double>::infinity();
  const auto rest_on = [&](const Carrier& carrier, const Eigen::Vector3d& point) {
    const Eigen::Vector3d at = rotation * (carrier.rest_pose * point);
    height = std::max(height, terrain.at(x + at.x(), y + at.y()).height - at.z());
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

Eigen::AlignedBox2d VehicleParts::outline_at_rest() const {
  Eigen::AlignedBox2d box;
  for (const Carrier& carrier : carriers_) {
    for (size_t i = 0; i < carrier.walls.points(); ++i) {
      const Eigen::Vector3d at = carrier.rest_pose.translation() + carrier.walls.point(i);
      box.extend(Eigen::Vector2d(at.head<2>()));
    }
  }
  return box;
}

}  // namespace screed
