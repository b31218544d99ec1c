// Raised and sunk volume of noisy height maps.
#include "host_sim/soil_validation/dig_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {

namespace {

/// Adds `volume` to what was raised where `direction` points up, and takes it off what was sunk
/// where it points down.
void count(MovedVolume& moved, double direction, double volume) {
  if (direction > 0.0) moved.raised_m3 += volume;
  if (direction < 0.0) moved.sunk_m3 -= volume;
}

RiseMap sum_of(std::span<const RiseMap> maps) {
  RiseMap sum(maps.empty() ? 0 : maps.front().size(), 0.0);
  for (const RiseMap& map : maps) {
    for (size_t node = 0; node < sum.size(); ++node) sum[node] += map[node];
  }
  return sum;
}

/// Volumes of the mean of all maps but this one.
MovedVolume volume_of_others(const RiseMap& sum, const RiseMap& map, double area_m2,
                             double others) {
  MovedVolume moved;
  for (size_t node = 0; node < sum.size(); ++node) {
    const double rise = (sum[node] - map[node]) / others;
    count(moved, rise, rise * area_m2);
  }
  return moved;
}

}  // namespace

MovedVolume volume_of_means(std::span<const RiseMap> maps, double area_m2, size_t group) {
  MovedVolume moved;
  if (group == 0) return moved;
  const size_t groups = maps.size() / group;
  if (groups == 0) return moved;
  const double share = area_m2 / static_cast<double>(group * groups);
  for (size_t i = 0; i < groups; ++i) {
    for (const double sum : sum_of(maps.subspan(i * group, group))) count(moved, sum, sum * share);
  }
  return moved;
}

MovedVolume volume_without_noise(std::span<const RiseMap> maps, double area_m2) {
  MovedVolume moved;
  if (maps.size() < 2) return moved;
  const RiseMap sum = sum_of(maps);
  const double share = area_m2 / static_cast<double>(maps.size());
  for (const RiseMap& map : maps) {
    for (size_t node = 0; node < sum.size(); ++node)
      count(moved, sum[node] - map[node], map[node] * share);
  }
  return moved;
}

MovedVolume standard_error(std::span<const RiseMap> maps, double area_m2) {
  if (maps.size() < 2) return {};
  const RiseMap sum = sum_of(maps);
  const auto count_of_maps = static_cast<double>(maps.size());
  std::vector<MovedVolume> without;
  MovedVolume mean;
  for (const RiseMap& map : maps) {
    without.push_back(volume_of_others(sum, map, area_m2, count_of_maps - 1.0));
    mean.raised_m3 += without.back().raised_m3 / count_of_maps;
    mean.sunk_m3 += without.back().sunk_m3 / count_of_maps;
  }
  MovedVolume squares;
  for (const MovedVolume& one : without) {
    squares.raised_m3 += portable::pow(one.raised_m3 - mean.raised_m3, 2);
    squares.sunk_m3 += portable::pow(one.sunk_m3 - mean.sunk_m3, 2);
  }
  const double factor = (count_of_maps - 1.0) / count_of_maps;
  return {std::sqrt(factor * squares.raised_m3), std::sqrt(factor * squares.sunk_m3)};
}

// ---- the digging robot

namespace {

// About the Rover: 1.2 kg on two belts.
constexpr double kMass_kg = 1.2;
constexpr double kHalfBelt_m = 0.055;
constexpr double kWheelRadius_m = 0.03;
constexpr double kBeltWidth_m = 0.04;
constexpr double kTread_m = 0.18;
constexpr double kBodyAboveAxles_m = 0.01;
const Eigen::Vector3d kBody_m(0.20, 0.14, 0.06);

constexpr int64_t kReportSteps = 32;
// The robot is lowered onto the ground as slowly as the plate of plate_press.cpp: on particles
// it would else fall onto them from the highest one.
constexpr double kLowering_s = 1.0;
constexpr double kLowering_m_per_s = 0.01;
constexpr double kTether_n_per_m = 400.0;  // a centimetre on the steepest slope
constexpr double kTether_ns_per_m = 44.0;  // without overshoot
constexpr double kWinch_s = 0.05;          // in which the winch makes good an error of speed
// The mound: a cone's flank at 20 degrees, cut off at this height.
constexpr double kMound_m = 0.08;
constexpr double kMoundSlope_rad = 20.0 * std::numbers::pi / 180.0;
constexpr double kAverage_m = 0.035;

/// It works about the place where it begins.
bool stays(Manoeuvre manoeuvre) {
  return manoeuvre == Manoeuvre::kSpin || manoeuvre == Manoeuvre::kStrokes;
}

double start_x(const DigTest& test) {
  return stays(test.manoeuvre) ? 0.0 : -0.5 * test.size_m + 0.17;
}

HeightField ground_before(const DigTest& test, double floor_m) {
  const int nodes = static_cast<int>(std::lround(test.size_m / test.cell_m)) + 1;
  const bool mound = test.manoeuvre == Manoeuvre::kCharge;
  return HeightField::from_function(nodes, nodes, test.cell_m, false, [&](double x, double y) {
    if (!mound) return floor_m + x * portable::tan(test.slope_deg * std::numbers::pi / 180.0);
    const double flank = kMound_m / portable::tan(kMoundSlope_rad);
    const double out = std::max(0.0, portable::hypot(x - 0.12, y) - 0.06);
    return floor_m + kMound_m * std::max(0.0, 1.0 - out / flank);
  });
}

void check(const DigTest& test) {
  check_range("dig", "cell", test.cell_m, 0.001, 0.02);
  check_range("dig", "step", test.step_s, 1e-5, 0.01);
  check_range("dig", "depth", test.depth_m, 0.02, 1.0);
  check_range("dig", "size", test.size_m, 0.5, 5.0);
  check_range("dig", "speed", test.track_m_per_s, 0.01, 1.0);
  check_range("dig", "duration", test.duration_s, 0.1, 600.0);
  check_range("dig", "stroke", test.stroke_s, 0.0, 5.0);
  check_range("dig", "stroke back", test.stroke_back_s, 0.0, 5.0);
  check_range("dig", "stroke acceleration", test.stroke_accel_m_per_s2, 0.1, 100.0);
  check_range("dig", "beds", test.beds, 1, 256);
  check_range("dig", "slope", test.slope_deg, 0, 25);
  check_range("dig", "slip", test.slip, 0.05, 0.99);
  check_range("dig", "lug height", test.lug_height_m, 0.0, 0.1);
  if (test.slope_deg > 0.0 && test.manoeuvre == Manoeuvre::kCharge) {
    throw InputError("dig: slope = " + shortest(test.slope_deg) + "; a charge is on level ground");
  }
}

class DiggingRobot {
 public:
  DiggingRobot(double x, double ground_m, double lug_height_m)
      : body_(dBodyCreate(world_.id())), lug_height_m_(lug_height_m) {
    dMass mass;
    dMassSetBoxTotal(&mass, kMass_kg, kBody_m.x(), kBody_m.y(), kBody_m.z());
    dBodySetMass(body_, &mass);
    inverse_inertia_ = rotation_to_eigen(mass.I).inverse();
    dBodySetPosition(body_, x, 0.0, ground_m + kWheelRadius_m + kBodyAboveAxles_m);
  }

  void step(Terrain& bed, const std::array<double, 2>& belts, double hold_m_per_s, double dt) {
    PressingBody body;
    const Eigen::Matrix3d axes = rotation();
    body.mass_kg = kMass_kg;
    body.inverse_inertia = axes * inverse_inertia_ * axes.transpose();
    body.centre = position();
    body.velocity = to_eigen(dBodyGetLinearVel(body_));
    body.omega = to_eigen(dBodyGetAngularVel(body_));
    std::array<FootprintContact, 2> contacts;
    for (size_t i = 0; i < 2; ++i) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = axes;
      const double side = i == 0 ? 0.5 : -0.5;
      pose.translation() =
          body.centre + axes * Eigen::Vector3d(0.0, side * kTread_m, -kBodyAboveAxles_m);
      belts_[i].set_pose(pose);
      contacts[i].footprint = &belts_[i];
      contacts[i].memory = &memories_[i];
      contacts[i].arm = pose.translation() - body.centre;
      contacts[i].motion.velocity = body.velocity + body.omega.cross(contacts[i].arm);
      contacts[i].motion.omega = body.omega;
      contacts[i].motion.surface_speed = belts[i];
      contacts[i].motion.slip = hold_m_per_s > 0.0 ? 1.0 - hold_m_per_s / belts[i] : 0.0;
      contacts[i].motion.lug_height_m = lug_height_m_;
    }
    bed.press(body, contacts, dt, memory_);
    bed.end_step(dt);
    for (const FootprintContact& contact : contacts) {
      const Eigen::Vector3d& force = contact.reaction.force;
      const Eigen::Vector3d torque = contact.arm.cross(force) + contact.reaction.torque;
      dBodyAddForce(body_, force.x(), force.y(), force.z());
      dBodyAddTorque(body_, torque.x(), torque.y(), torque.z());
    }
    if (hold_m_per_s > 0.0) {
      // A winch at the middle of the body that holds this speed, whatever it takes, and keeps the
      // body on its line.
      const double gain = 0.1 * kMass_kg / dt;
      const double faster = body.velocity.x() - hold_m_per_s;
      winch_n_ += gain * faster * dt / kWinch_s;
      const Eigen::Vector3d pull(-gain * faster - winch_n_, -gain * body.velocity.y(), 0.0);
      dBodyAddForce(body_, pull.x(), pull.y(), 0.0);
      held_ -= pull.x() * dt;
      dBodyAddTorque(body_, 0.0, 0.0, -0.1 / dt * body.omega.z() / body.inverse_inertia(2, 2));
    }
    if (tether_) {
      // Holds the body where it is, seen from above.
      const Eigen::Vector3d pull =
          -kTether_n_per_m * (body.centre - *tether_) - kTether_ns_per_m * body.velocity;
      dBodyAddForce(body_, pull.x(), pull.y(), 0.0);
    }
    world_.step(dt);
    turned_ += body.omega.z() * dt;
  }

  /// A step in which the robot goes down at no more than the speed of lowering.
  void lower(Terrain& bed, double dt) {
    step(bed, {0.0, 0.0}, 0.0, dt);
    const double kept = 1.0 / (1.0 + dt * kGravity_m_per_s2 / kLowering_m_per_s);
    const Eigen::Vector3d velocity = kept * to_eigen(dBodyGetLinearVel(body_));
    const Eigen::Vector3d omega = kept * to_eigen(dBodyGetAngularVel(body_));
    dBodySetLinearVel(body_, velocity.x(), velocity.y(), velocity.z());
    dBodySetAngularVel(body_, omega.x(), omega.y(), omega.z());
  }

  /// From now on something holds the middle of the body where it is, seen from above.
  void tether() { tether_ = position(); }

  Eigen::Vector3d position() const { return to_eigen(dBodyGetPosition(body_)); }
  Eigen::Matrix3d rotation() const { return rotation_to_eigen(dBodyGetRotation(body_)); }
  double turned_rad() const { return turned_; }
  double held_ns() const { return held_; }  ///< the winch's force over time

 private:
  OdeWorld world_;
  dBodyID body_;
  double lug_height_m_;
  Eigen::Matrix3d inverse_inertia_;
  BodyMemory memory_;
  std::array<Footprint, 2> belts_{Footprint::track(kHalfBelt_m, kWheelRadius_m, kBeltWidth_m),
                                  Footprint::track(kHalfBelt_m, kWheelRadius_m, kBeltWidth_m)};
  std::array<ContactMemory, 2> memories_;
  std::optional<Eigen::Vector3d> tether_;
  double turned_ = 0.0;
  double winch_n_ = 0.0;
  double held_ = 0.0;
};

/// Means over squares, on the same nodes.
HeightField averaged(const HeightField& field) {
  const int half = static_cast<int>(std::lround(0.5 * (kAverage_m / field.spacing_m() - 1.0)));
  HeightField means = field;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      int64_t sum = 0;
      int64_t count = 0;
      for (int y = std::max(0, iy - half); y <= std::min(field.ny() - 1, iy + half); ++y) {
        for (int x = std::max(0, ix - half); x <= std::min(field.nx() - 1, ix + half); ++x) {
          sum += field.node(x, y);
          ++count;
        }
      }
      means.set_node(ix, iy, static_cast<Height>(sum / count));
    }
  }
  means.refresh_bounds();
  return means;
}

void measure(DigResult& result) {
  const HeightField& field = result.before;
  const double area = field.spacing_m() * field.spacing_m();
  double moment_m4 = 0.0;
  double sunk_moment_m4 = 0.0;
  double net_m3 = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double rise =
          (static_cast<double>(result.after.node(ix, iy)) - field.node(ix, iy)) * kHeightUnit_m;
      const double dx = field.node_x(ix) - result.end_x_m;
      const double away = portable::hypot(dx, field.node_y(iy) - result.end_y_m);
      result.highest_m = std::max(result.highest_m, rise);
      result.deepest_m = std::max(result.deepest_m, -rise);
      const double volume = std::abs(rise) * area;
      (rise > 0.0 ? result.raised_m3 : result.sunk_m3) += volume;
      result.downhill_m4 -= rise * area * dx;
      moment_m4 += rise * area * dx;
      net_m3 += rise * area;
      if (rise < 0.0) sunk_moment_m4 += volume * dx;
      (rise > 0.0 ? result.raised_radius_m : result.sunk_radius_m) += volume * away;
      if (rise > 0.0 && dx < 0.0) result.behind_share += volume;
    }
  }
  if (result.raised_m3 > 0.0) {
    result.raised_radius_m /= result.raised_m3;
    result.behind_share /= result.raised_m3;
  }
  if (result.sunk_m3 > 0.0) {
    result.sunk_radius_m /= result.sunk_m3;
    const double sunk_dx = sunk_moment_m4 / result.sunk_m3;
    result.sunk_x_m = result.end_x_m + sunk_dx;
    result.carried_m4 = moment_m4 - net_m3 * sunk_dx;
  }
}

/// Receives the share that is done of a drive, 0..1.
using OfDrive = std::function<void(double)>;

/// That of drive `number` of so many, as the share of all.
OfDrive of_drive(const TaskProgress& progress, int number, int drives) {
  return [&progress, number, drives](double share) {
    report_progress(progress, "digging", (number + share) / drives);
  };
}

/// Belt speed of the strokes at this time: up from -v to v gently, some time at v, down to -v at
/// once, some time at -v.
double stroke_speed(const DigTest& test, double time_s) {
  const double v = test.track_m_per_s;
  const double ramp = 2.0 * v / test.stroke_accel_m_per_s2;
  const double at = std::fmod(time_s, ramp + test.stroke_s + test.stroke_back_s);
  if (at < ramp) return -v + test.stroke_accel_m_per_s2 * at;
  return at < ramp + test.stroke_s ? v : -v;
}

/// Drives the manoeuvre, with the robot standing at its start.
DigResult drive(const DigTest& test, DiggingRobot& robot, double dt, Terrain& bed,
                const OfDrive& progress) {
  DigResult result{averaged(bed.surface()), HeightField::flat(1.0, 0.1)};
  const auto lowering = static_cast<int>(std::lround(kLowering_s / dt));
  for (int i = 0; i < lowering; ++i) robot.lower(bed, dt);
  if (test.slope_deg > 0.0 && test.manoeuvre == Manoeuvre::kSpin) robot.tether();
  const Eigen::Vector3d start = robot.position();
  const double v = test.track_m_per_s;
  const bool spin = test.manoeuvre == Manoeuvre::kSpin;
  const double hold = test.manoeuvre == Manoeuvre::kSlip ? (1.0 - test.slip) * v : 0.0;
  std::array<double, 2> belts = {spin ? -v : v, v};
  const double edge = 0.5 * test.size_m - 0.17;
  const auto steps = static_cast<int64_t>(std::llround(test.duration_s / dt));
  for (int64_t i = 0; i < steps; ++i) {
    if (i % kReportSteps == 0) progress(static_cast<double>(i) / static_cast<double>(steps));
    if (test.manoeuvre == Manoeuvre::kStrokes) {
      const double speed = stroke_speed(test, result.time_s);
      belts.fill(test.slope_deg > 0.0 ? -speed : speed);
    }
    robot.step(bed, belts, hold, dt);
    result.time_s += dt;
    const Eigen::Vector3d place = robot.position();
    result.pitch_rad =
        std::max(result.pitch_rad, portable::asin(std::clamp(robot.rotation()(2, 0), -1.0, 1.0)));
    if (std::max(std::abs(place.x()), std::abs(place.y())) > edge + 0.01) break;
  }
  result.after = averaged(bed.surface());
  const Eigen::Vector3d end = robot.position();
  result.end_x_m = end.x();
  result.end_y_m = end.y();
  result.distance_m = (end - start).head<2>().norm();
  result.pull_n = robot.held_ns() / result.time_s;
  result.turned_rad = robot.turned_rad();
  result.lower_by_m = start.z() - end.z();
  return result;
}

}  // namespace

DigResult dig_soil(const DigTest& test, const TaskProgress& progress) {
  check(test);
  SoilBed bed(ground_before(test, 0.0), test.soil, test.options);
  bed.relax_slopes();
  DiggingRobot robot(start_x(test), bed.surface().max_height_within(start_x(test), 0.0, 0.1),
                     test.lug_height_m);
  DigResult result = drive(test, robot, test.step_s, bed, of_drive(progress, 0, 1));
  result.balance = bed.balance();
  measure(result);
  return result;
}

namespace {

DigResult dig_one_bed(const DigTest& test, int number, const TaskProgress& progress) {
  ParticleOptions options;
  options.material = test.particle;
  options.ray_spacing_m = test.cell_m;
  options.seed = test.seed + static_cast<uint64_t>(number);
  const OfDrive of_bed = of_drive(progress, number, test.beds);
  ParticleBed bed(ground_before(test, test.depth_m), options,
                  [&](std::string_view /*laying*/, double /*share*/) { of_bed(0.0); });
  DiggingRobot robot(start_x(test), bed.surface().max_height_within(start_x(test), 0.0, 0.1),
                     test.lug_height_m);
  return drive(test, robot, bed.longest_step_s(), bed, of_bed);
}

constexpr double DigResult::*kMeans[] = {
    &DigResult::end_x_m,    &DigResult::end_y_m,    &DigResult::time_s,     &DigResult::pull_n,
    &DigResult::distance_m, &DigResult::turned_rad, &DigResult::lower_by_m, &DigResult::pitch_rad};

RiseMap rise_of(const DigResult& result) {
  const HeightField& field = result.before;
  RiseMap rise;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix)
      rise.push_back((result.after.node(ix, iy) - field.node(ix, iy)) * kHeightUnit_m);
  }
  return rise;
}

/// Standard error of the mean of the beds of what has moved along x, from there.
double moment_error(const HeightField& field, std::span<const RiseMap> rises, double from_x_m) {
  const double area = field.spacing_m() * field.spacing_m();
  double sum = 0.0;
  double squares = 0.0;
  for (const RiseMap& rise : rises) {
    double one = 0.0;
    for (size_t i = 0; i < rise.size(); ++i)
      one += rise[i] * area * (field.node_x(static_cast<int>(i) % field.nx()) - from_x_m);
    sum += one;
    squares += one * one;
  }
  const auto n = static_cast<double>(rises.size());
  return n < 2 ? 0.0 : std::sqrt(std::max(0.0, squares - sum * sum / n) / (n - 1) / n);
}

template <typename Change>
void change_nodes(HeightField& field, const Change& change) {
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) field.set_node(ix, iy, change(ix, iy));
  }
}

}  // namespace

DigResult dig_particles(const DigTest& test, const TaskProgress& progress) {
  check(test);
  DigResult mean = dig_one_bed(test, 0, progress);
  std::vector<RiseMap> rises = {rise_of(mean)};
  for (int i = 1; i < test.beds; ++i) {
    const DigResult one = dig_one_bed(test, i, progress);
    rises.push_back(rise_of(one));
    for (double DigResult::*figure : kMeans) mean.*figure += one.*figure;
    for (HeightField DigResult::*map : {&DigResult::before, &DigResult::after}) {
      change_nodes(mean.*map, [&](int x, int y) {
        return static_cast<Height>((mean.*map).node(x, y) + (one.*map).node(x, y));
      });
    }
  }
  for (double DigResult::*figure : kMeans) mean.*figure /= test.beds;
  for (HeightField DigResult::*map : {&DigResult::before, &DigResult::after}) {
    change_nodes(mean.*map, [&](int x, int y) { return (mean.*map).node(x, y) / test.beds; });
    (mean.*map).refresh_bounds();
  }
  measure(mean);
  const double area = mean.before.spacing_m() * mean.before.spacing_m();
  mean.error = standard_error(rises, area);
  mean.downhill_error_m4 = moment_error(mean.before, rises, mean.end_x_m);
  mean.carried_error_m4 = moment_error(mean.before, rises, mean.sunk_x_m);
  mean.at_least = volume_without_noise(rises, area);
  for (int beds = 1; beds < test.beds; beds *= 4)
    mean.of_beds.push_back({beds, volume_of_means(rises, area, static_cast<size_t>(beds))});
  return mean;
}

}  // namespace screed
