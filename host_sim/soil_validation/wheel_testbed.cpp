// A testbed's drive, step by step.
#include "host_sim/soil_validation/wheel_testbed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/rotation.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

// Of ground on each side of the track, and beyond its ends; walls disturb particles further in.
constexpr double kMargin_m = 0.03;
constexpr double kParticleMargin_m = 0.1;
constexpr double kParticleMargin_radii = 8.0;

void check(const WheelTest& test) {
  check_range("wheel", "mass", test.mass_kg, 1e-4, 1e4);
  check_range("wheel", "speed", test.speed_m_per_s, 1e-4, 10.0);
  check_range("wheel", "step", test.step_s, 1e-5, 0.02);
  check_range("wheel", "duration", test.duration_s, 0.1, 3600.0);
  check_range("wheel", "cell", test.cell_m, 0.0005, 0.1);
  check_range("wheel", "passes", test.passes, 1, 100);
  check_range("wheel", "radius", test.wheel.radius_m, 1e-3, 10.0);
  check_range("wheel", "width", test.wheel.width_m, 1e-3, 10.0);
  check_range("wheel", "load", test.wheel.load_n, 1e-3, 1e6);
  check_range("wheel", "slip", test.wheel.slip, -1.0, 0.99);
  check_range("wheel", "belt", test.belt_m, 0.0, 10.0);
  check_range("wheel", "lug height", test.lug_height_m, 0.0, 0.1);
  check_range("wheel", "depth", test.depth_m, 0.02, 1.0);
  if (test.particle && (test.lug_height_m > 0.0 || test.wheel.adhesion_pa > 0.0)) {
    throw InputError("wheel: lugs and adhesion do nothing to particles");
  }
}

/// A bed under what is so long along the track and so wide across it, its middle in the middle;
/// square to the grid's axes, whatever the track's yaw.
HeightField bed_under(const WheelTest& test, double along, double across) {
  const double margin =
      test.particle ? std::max(kParticleMargin_m, kParticleMargin_radii * test.particle->radius_m)
                    : kMargin_m;
  const double length = along + test.belt_m + 2.0 * (test.wheel.radius_m + margin);
  const double width = across + test.wheel.width_m + 2.0 * (margin + std::abs(test.offset_m));
  const double cos = std::abs(portable::cos(test.yaw_rad));
  const double sin = std::abs(portable::sin(test.yaw_rad));
  const auto nodes = [&](double extent) {
    return 2 * static_cast<int>(std::ceil(0.5 * extent / test.cell_m)) + 3;
  };
  return {nodes(length * cos + width * sin), nodes(length * sin + width * cos), test.cell_m, false};
}

double step_of(const WheelTest& test) {
  if (!test.particle) return test.step_s;
  return std::min(test.step_s, SphereLaw::longest_step_s(*test.particle));
}

std::unique_ptr<Terrain> ground_of(const WheelTest& test, HeightField level) {
  if (!test.particle) return std::make_unique<SoilBed>(std::move(level), test.soil, test.options);
  for (int iy = 0; iy < level.ny(); ++iy) {
    for (int ix = 0; ix < level.nx(); ++ix)
      level.set_node(ix, iy, static_cast<Height>(std::lround(test.depth_m / kHeightUnit_m)));
  }
  ParticleOptions options;
  options.material = *test.particle;
  options.ray_spacing_m = test.cell_m;
  options.seed = test.seed;
  return std::make_unique<ParticleBed>(level, options);
}

/// A drive over a bed; places in the track's axes.
class Drive {
 public:
  Drive(const WheelTest& test, Terrain& bed, const Eigen::Vector2d& start)
      : test_(test),
        bed_(bed),
        step_s_(step_of(test)),
        wheel_(Footprint::track(0.5 * test.belt_m, test.wheel.radius_m, test.wheel.width_m)),
        axes_(rotation_about(Eigen::Vector3d::UnitZ(), test.yaw_rad).toRotationMatrix()),
        place_(start) {
    constexpr double kGap_m = 1e-4;
    height_ = ground() + test.wheel.radius_m + kGap_m;
    if (test.particle) {
      const HeightField& surface = bed.surface();
      level_ = static_cast<double>(surface.height_sum()) * kHeightUnit_m /
               (static_cast<double>(surface.nx()) * surface.ny());
      height_ = level_ + test.wheel.radius_m + test.particle->radius_m;
      motion_.friction = std::min(test.wheel.friction, test.particle->friction);
    }
    body_.mass_kg = test.mass_kg;
    motion_.soil_friction = test.wheel.friction;
    motion_.adhesion_pa = test.wheel.adhesion_pa;
    motion_.lug_height_m = test.lug_height_m;
  }

  /// Force and torque about the axle, in the track's axes.
  TerrainReaction step(const WheelMotion& motion) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = axes_;
    pose.translation() = axes_ * Eigen::Vector3d(place_.x(), test_.offset_m + place_.y(), height_);
    wheel_.set_pose(pose);
    body_.centre = pose.translation();
    body_.velocity = motion_.velocity = axes_ * Eigen::Vector3d(motion.ahead, motion.left, rising_);
    motion_.surface_speed = motion.rim;
    motion_.slip = signed_slip(motion.rim, motion.ahead);
    FootprintContact contact{&wheel_, &memory_, motion_};
    bed_.press(body_, {&contact, 1}, step_s_, memory_.alone);
    bed_.end_step(step_s_);
    TerrainReaction& reaction = contact.reaction;
    reaction.force = axes_.transpose() * reaction.force;
    reaction.torque = axes_.transpose() * reaction.torque;
    sinkage_ = level_ + test_.wheel.radius_m - height_;
    rising_ += step_s_ * (reaction.force.z() - test_.wheel.load_n) / test_.mass_kg;
    height_ += step_s_ * rising_;
    place_ += step_s_ * Eigen::Vector2d(motion.ahead, motion.left);
    return reaction;
  }
  /// Of the wheel's lowest point below the untouched level, when the last step began, m.
  double sinkage() const { return sinkage_; }
  const Eigen::Vector2d& place() const { return place_; }
  double ground() const {
    const Eigen::Vector3d at = axes_ * Eigen::Vector3d(place_.x(), test_.offset_m + place_.y(), 0);
    return bed_.surface().at(at.x(), at.y()).height;
  }
  void go_to(const Eigen::Vector2d& place) { place_ = place; }

 private:
  const WheelTest& test_;
  Terrain& bed_;
  double step_s_;
  Footprint wheel_;
  Eigen::Matrix3d axes_;
  ContactMemory memory_;
  PressingBody body_;
  FootprintMotion motion_;
  Eigen::Vector2d place_;  // of the axle from the track's middle
  double level_ = 0.0;     // of the untouched ground
  double height_ = 0.0;
  double rising_ = 0.0;
  double sinkage_ = 0.0;
};

/// `after`: passes that come after it. Each rolls two radii further than the next one, which so is
/// in its rut to the end.
WheelPass roll(const WheelTest& test, SoilBed& bed, int after) {
  const double radius = test.wheel.radius_m;
  const double slip = test.wheel.slip;
  const double aside = portable::tan(test.wheel.slip_angle_rad);
  const WheelMotion motion = {
      test.speed_m_per_s, aside * test.speed_m_per_s,
      slip >= 0.0 ? test.speed_m_per_s / (1.0 - slip) : test.speed_m_per_s * (1.0 + slip)};
  const auto counted_steps = static_cast<int>(std::lround(test.duration_s / test.step_s));
  const int steps =
      counted_steps +
      static_cast<int>(std::lround(2.0 * radius * after / (test.speed_m_per_s * test.step_s)));
  const double begin = -0.5 * test.speed_m_per_s * test.duration_s;
  const auto on_track = [&](double along) { return Eigen::Vector2d(along, aside * along); };
  Drive drive(test, bed, on_track(begin));
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  WheelPass sum;
  int counted = 0;
  for (int i = 0; i < steps; ++i) {
    const TerrainReaction reaction = drive.step(motion);
    if (2 * i < counted_steps || i >= counted_steps) continue;
    ++counted;
    sum.sinkage_m += drive.sinkage();
    sum.drawbar_pull_n += reaction.force.x();
    sum.side_force_n += reaction.force.y();
    sum.load_n += reaction.force.z();
    sum.torque_nm -= reaction.torque.y();
    lowest = std::min(lowest, drive.sinkage());
    highest = std::max(highest, drive.sinkage());
  }
  for (double* mean :
       {&sum.sinkage_m, &sum.drawbar_pull_n, &sum.side_force_n, &sum.load_n, &sum.torque_nm}) {
    *mean /= counted;
  }
  sum.ripple_m = highest - lowest;
  // Its rut's mean depth along the middle of the track, behind the wheel.
  constexpr int kPlaces = 200;
  for (int i = 0; i < kPlaces; ++i) {
    drive.go_to(on_track((-begin - 2.0 * radius) * (i + 0.5) / kPlaces));
    sum.rut_m -= drive.ground() / kPlaces;
  }
  return sum;
}

}  // namespace

WheelTestResult run_wheel(const WheelTest& test) {
  check(test);
  if (test.particle) throw InputError("wheel: particles need a schedule or measured transients");
  const double along = test.speed_m_per_s * test.duration_s;
  const double longest = along + 4.0 * test.wheel.radius_m * (test.passes - 1);
  const double across = std::abs(portable::tan(test.wheel.slip_angle_rad)) *
                        (longest + 2.0 * (test.wheel.radius_m + kMargin_m));
  SoilBed bed(bed_under(test, longest, across), test.soil, test.options);
  std::vector<WheelPass> passes;
  passes.reserve(static_cast<size_t>(test.passes));
  for (int i = 0; i < test.passes; ++i) passes.push_back(roll(test, bed, test.passes - 1 - i));
  return {passes, bed.balance(), bed.surface()};
}

WheelScheduleResult run_wheel(const WheelTest& test, const WheelSchedule& schedule,
                              double interval_s) {
  check(test);
  check_range("wheel", "interval", interval_s, test.step_s, 3600.0);
  const double step_s = step_of(test);
  // Before the schedule begins.
  constexpr double kStanding_s = 2.0;
  const WheelMotion first = schedule.at(0.0);
  const double speed = portable::hypot(first.ahead, first.left);
  const auto lead = static_cast<int>(
      (speed > 1e-4 ? (test.belt_m + 3.0 * test.wheel.radius_m) / speed : kStanding_s) / step_s);
  const auto steps = static_cast<int>(std::lround(schedule.duration_s() / step_s));
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  Eigen::AlignedBox2d box(place);
  const auto motion_of = [&](int i) { return schedule.at(std::max(0, i) * step_s); };
  for (int i = -lead; i < steps; ++i) {
    const WheelMotion motion = motion_of(i);
    place += step_s * Eigen::Vector2d(motion.ahead, motion.left);
    box.extend(place);
  }
  const std::unique_ptr<Terrain> bed =
      ground_of(test, bed_under(test, box.sizes().x(), box.sizes().y()));
  Drive drive(test, *bed, -box.center());
  const int every = std::max(1, static_cast<int>(std::lround(interval_s / step_s)));
  WheelScheduleResult result;
  WheelSample now;
  for (int i = -lead; i <= steps; ++i) {
    const WheelMotion motion = motion_of(i);
    const TerrainReaction reaction = drive.step(motion);
    if (i < 0) continue;
    now.sinkage_m = drive.sinkage();
    now.drawbar_pull_n = reaction.force.x();
    now.side_force_n = reaction.force.y();
    if (i % every == 0) result.samples.push_back(now);
    now.time_s += step_s;
    now.travel_m += step_s * motion.ahead;
    now.side_path_m += step_s * motion.left;
    now.slip_path_m += step_s * (motion.rim - motion.ahead);
  }
  result.balance = bed->balance();
  return result;
}

}  // namespace screed
