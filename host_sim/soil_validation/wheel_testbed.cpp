// The single-wheel testbed.
#include "host_sim/soil_validation/wheel_testbed.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/rotation.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

constexpr double kMargin_m = 0.03;  // of soil on each side of the track, and beyond its ends

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
}

/// A bed along the track; square to the grid's axes, whatever the track's yaw.
HeightField bed_under(const WheelTest& test) {
  const double length = test.speed_m_per_s * test.duration_s +
                        2.0 * (test.wheel.radius_m + kMargin_m) +
                        4.0 * test.wheel.radius_m * (test.passes - 1);
  const double width = test.wheel.width_m + 2.0 * (kMargin_m + std::abs(test.offset_m)) +
                       std::abs(portable::tan(test.wheel.slip_angle_rad)) * length;
  const double cos = std::abs(portable::cos(test.yaw_rad));
  const double sin = std::abs(portable::sin(test.yaw_rad));
  const auto nodes = [&](double extent) {
    return 2 * static_cast<int>(std::ceil(0.5 * extent / test.cell_m)) + 3;
  };
  return {nodes(length * cos + width * sin), nodes(length * sin + width * cos), test.cell_m, false};
}

class Testbed {
 public:
  explicit Testbed(const WheelTest& test)
      : test_(test),
        bed_(bed_under(test), test.soil, test.options),
        wheel_(Footprint::wheel(test.wheel.radius_m, test.wheel.width_m)) {
    axes_ = rotation_about(Eigen::Vector3d::UnitZ(), test.yaw_rad).toRotationMatrix();
  }

  /// `after`: passes that come after it. Each rolls two radii further than the next one, which so
  /// is in its rut to the end.
  WheelPass pass(int after) {
    const double radius = test_.wheel.radius_m;
    const auto counted_steps = static_cast<int>(std::lround(test_.duration_s / test_.step_s));
    const int steps =
        counted_steps +
        static_cast<int>(std::lround(2.0 * radius * after / (test_.speed_m_per_s * test_.step_s)));
    const double begin = -0.5 * test_.speed_m_per_s * test_.duration_s;
    ContactMemory memory;
    FootprintMotion motion;
    motion.mass_kg = test_.mass_kg;
    motion.slip = test_.wheel.slip;
    motion.surface_speed = test_.wheel.slip >= 0.0 ? test_.speed_m_per_s / (1.0 - test_.wheel.slip)
                                                   : test_.speed_m_per_s * (1.0 + test_.wheel.slip);
    motion.soil_friction = test_.wheel.friction;
    motion.adhesion_pa = test_.wheel.adhesion_pa;
    const double aside = portable::tan(test_.wheel.slip_angle_rad);
    double height =
        bed_.surface().at(begin * axes_(0, 0), begin * axes_(1, 0)).height + radius + 1e-4;
    double rising = 0.0;
    double lowest = std::numeric_limits<double>::infinity();
    double highest = -lowest;
    WheelPass sum;
    int counted = 0;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = axes_;
    for (int i = 0; i < steps; ++i) {
      const double along = begin + test_.speed_m_per_s * i * test_.step_s;
      pose.translation() = axes_ * Eigen::Vector3d(along, test_.offset_m + aside * along, height);
      wheel_.set_pose(pose);
      motion.velocity =
          axes_ * Eigen::Vector3d(test_.speed_m_per_s, aside * test_.speed_m_per_s, rising);
      const TerrainReaction reaction = bed_.press(wheel_, motion, test_.step_s, memory);
      bed_.end_step();
      const Eigen::Vector3d force = axes_.transpose() * reaction.force;
      const double sinkage = radius - height;
      rising += test_.step_s * (force.z() - test_.wheel.load_n) / test_.mass_kg;
      height += test_.step_s * rising;
      if (2 * i < counted_steps || i >= counted_steps) continue;
      ++counted;
      sum.sinkage_m += sinkage;
      sum.drawbar_pull_n += force.x();
      sum.side_force_n += force.y();
      sum.load_n += force.z();
      sum.torque_nm -= (axes_.transpose() * reaction.torque).y();
      lowest = std::min(lowest, sinkage);
      highest = std::max(highest, sinkage);
    }
    for (double* mean :
         {&sum.sinkage_m, &sum.drawbar_pull_n, &sum.side_force_n, &sum.load_n, &sum.torque_nm}) {
      *mean /= counted;
    }
    sum.ripple_m = highest - lowest;
    sum.rut_m = rut(0.0, -begin - 2.0 * radius);
    return sum;
  }

  const SoilBed& bed() const { return bed_; }

 private:
  /// Mean depth along the middle of the track.
  double rut(double from, double to) const {
    constexpr int kPlaces = 200;
    double sum = 0.0;
    for (int i = 0; i < kPlaces; ++i) {
      const double along = from + (to - from) * (i + 0.5) / kPlaces;
      const Eigen::Vector3d place =
          axes_ *
          Eigen::Vector3d(along, test_.offset_m + portable::tan(test_.wheel.slip_angle_rad) * along,
                          0.0);
      sum -= bed_.surface().at(place.x(), place.y()).height;
    }
    return sum / kPlaces;
  }

  WheelTest test_;
  SoilBed bed_;
  Footprint wheel_;
  Eigen::Matrix3d axes_;
};

}  // namespace

WheelTestResult run_wheel(const WheelTest& test) {
  check(test);
  Testbed testbed(test);
  std::vector<WheelPass> passes;
  passes.reserve(static_cast<size_t>(test.passes));
  for (int i = 0; i < test.passes; ++i) passes.push_back(testbed.pass(test.passes - 1 - i));
  return {passes, testbed.bed().balance(), testbed.bed().surface()};
}

}  // namespace screed
