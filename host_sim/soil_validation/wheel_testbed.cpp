// Integrals along the contact of a wheel.
#include "host_sim/soil_validation/wheel_testbed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/rotation.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/terrain/shear_field.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {

namespace {

constexpr int kSlices = 1000;  // along the contact; doubling it moves no figure by 1e-5 of itself
// Of a locked wheel: its rim has slid over the soil for ever.
constexpr double kForEver = 1e6;

class Contact {
 public:
  Contact(const RollingWheel& wheel, const SoilParameters& soil, NormalStress normal_stress)
      : wheel_(wheel),
        soil_(soil),
        passive_(soil),
        radial_(normal_stress == NormalStress::kRadial),
        exponent_(soil.exponent + soil.slip_sinkage * std::abs(wheel.slip)),
        tan_friction_(portable::tan(soil.friction_deg * kDegree)),
        // Speeds ahead and to the left over that of the rim; a locked rim's is 1 / kForEver.
        ahead_over_rim_(wheel.slip >= 0.0 ? 1.0 - wheel.slip
                                          : 1.0 / std::max(1.0 + wheel.slip, 1.0 / kForEver)),
        left_over_rim_(ahead_over_rim_ * portable::tan(wheel.slip_angle_rad)) {}

  /// Vertical force of the soil at this sinkage, and what comes with it.
  double load(double sinkage, WheelReaction& reaction) const {
    const double r = wheel_.radius_m;
    const Shape shape = shape_at(sinkage);
    reaction = {};
    reaction.sinkage_m = sinkage;
    reaction.contact_front_m = r * portable::sin(shape.entry);
    reaction.contact_rear_m = r * portable::sin(-shape.exit);
    const double deepest = going_down(shape.bekker, sinkage);
    reaction.rut_m = shape.shaped ? wheel_.rut_m + (sinkage - wheel_.rut_m) *
                                                       (1.0 - soil_.exit_angle * soil_.exit_angle)
                                  : std::max(wheel_.rut_m,  // soil that only gives at E, rounded
                                             sinkage - deepest / soil_.elastic_pa_per_m);
    const double slice = (shape.entry - shape.exit) / kSlices;
    const double per_k = r * slice / soil_.shear_modulus_m;
    double vertical = 0.0;
    ShearState shear;   // of the rim, from its entry on
    ShearState beside;  // of the soil beside it
    for (int i = 0; i < kSlices; ++i) {
      const double theta = shape.entry - (i + 0.5) * slice;
      const auto [sin, cos] = portable::sine_cosine(theta);
      // While the rim turns by a slice. Positive: it slides ahead over the soil, or to the left.
      const double ahead = radial_ ? ahead_over_rim_ * cos - 1.0 : ahead_over_rim_ - cos;
      shear.slide(0.5 * ahead * per_k, 0.5 * left_over_rim_ * per_k);
      beside.slide(0.0, 0.5 * portable::tan(wheel_.slip_angle_rad) * per_k);
      const double depth = sinkage - r * (1.0 - cos);
      const double pressure = pressure_at(shape, sinkage, theta);
      const double strength =
          std::min(soil_.cohesion_pa + pressure * tan_friction_,
                   pressure > 0.0 ? wheel_.adhesion_pa + pressure * wheel_.friction : 0.0);
      const double tau = -strength * shear.along;
      const double area = wheel_.width_m * r * cos * slice;  // horizontal; the rim's is area / cos
      reaction.side_force_n -= area / (radial_ ? cos : 1.0) * strength * shear.across;
      if (radial_) {
        vertical += area * (pressure + tau * sin / cos);
        reaction.drawbar_pull_n += area * (tau - pressure * sin / cos);
        reaction.torque_nm += area * tau * r / cos;
      } else {
        vertical += area * pressure;
        reaction.drawbar_pull_n += area * tau;
        reaction.torque_nm += area * r * (tau * cos + pressure * sin);
      }
      if (pressure > 0.0) {
        const double facing = std::max(0.0, shear.along) * std::max(0.0, sin / cos);
        reaction.drawbar_pull_n -= area * std::max(0.0, passive_.pressure(depth)) * facing;
        reaction.side_force_n -=
            area / wheel_.width_m * passive_.resistance(std::max(0.0, depth)) * beside.across;
      }
      shear.slide(0.5 * ahead * per_k, 0.5 * left_over_rim_ * per_k);
      beside.slide(0.0, 0.5 * portable::tan(wheel_.slip_angle_rad) * per_k);
    }
    return vertical;
  }

 private:
  struct Shape {
    double entry;   // angles from the lowest point forward
    double middle;  // of the greatest stress
    double exit;
    bool shaped;
    double bekker;
  };

  Shape shape_at(double sinkage) const {
    const double r = wheel_.radius_m;
    Shape shape{angle(std::max(0.0, sinkage - wheel_.rut_m)), 0.0, 0.0, false, 0.0};
    const double s = wheel_.slip;
    const double share = s >= 0.0 ? soil_.front_angle + soil_.front_angle_driven * s
                                  : soil_.front_angle - soil_.front_angle_braked * s;
    shape.middle = std::clamp(share, 0.0, 0.95) * shape.entry;
    shape.exit = -soil_.exit_angle * shape.entry;
    shape.shaped = shape.middle - shape.exit > 1e-4;
    // The touched rectangle's shorter side is Bekker's b, and its length ends where the elastic
    // part is used up: a fixed point, reached in a few turns.
    for (int i = 0; i < (shape.shaped ? 1 : 30); ++i) {
      const double b =
          std::min(wheel_.width_m, r * (portable::sin(shape.entry) - portable::sin(shape.exit)));
      shape.bekker = bekker_modulus(soil_, std::max(b, 1e-3));
      if (shape.shaped) continue;
      const double rise = going_down(shape.bekker, sinkage) / soil_.elastic_pa_per_m;
      shape.exit = -angle(std::min(rise, sinkage));
    }
    return shape;
  }
  double pressure_at(const Shape& shape, double sinkage, double theta) const {
    const double r = wheel_.radius_m;
    if (!shape.shaped) {
      if (theta > 0.0) return going_down(shape.bekker, sinkage - r * (1.0 - portable::cos(theta)));
      return std::max(0.0, going_down(shape.bekker, sinkage) -
                               soil_.elastic_pa_per_m * r * (1.0 - portable::cos(theta)));
    }
    const double ahead = theta >= shape.middle
                             ? theta
                             : shape.entry - (theta - shape.exit) * (shape.entry - shape.middle) /
                                                 (shape.middle - shape.exit);
    return going_down(shape.bekker, sinkage - r * (1.0 - portable::cos(ahead)));
  }
  /// From the lowest point to where the rim is higher by `rise`.
  double angle(double rise) const { return portable::acos(1.0 - rise / wheel_.radius_m); }
  /// On the way down: Bekker's law, never stiffer than the soil's own elasticity, which is what
  /// begins at the floor of a rut.
  double going_down(double bekker, double depth) const {
    if (depth <= wheel_.rut_m) return 0.0;
    return std::min(bekker * portable::pow(depth, exponent_),
                    soil_.elastic_pa_per_m * (depth - wheel_.rut_m));
  }

  RollingWheel wheel_;
  SoilParameters soil_;
  PassivePressure passive_;
  bool radial_;
  double exponent_;
  double tan_friction_;
  double ahead_over_rim_;
  double left_over_rim_;
};

}  // namespace

WheelReaction wheel_limit(const RollingWheel& wheel, const SoilParameters& soil,
                          NormalStress normal_stress, AtAxle at_axle) {
  check_range("wheel", "radius", wheel.radius_m, 1e-3, 10.0);
  check_range("wheel", "width", wheel.width_m, 1e-3, 10.0);
  check_range("wheel", "load", wheel.load_n, 1e-3, 1e6);
  check_range("wheel", "slip", wheel.slip, -1.0, 0.99);
  check_range("wheel", "slip angle", wheel.slip_angle_rad, -1.4, 1.4);
  check_range("wheel", "friction", wheel.friction, 0.0, std::numeric_limits<double>::infinity());
  check_range("wheel", "adhesion", wheel.adhesion_pa, 0.0, 1e7);
  check_range("wheel", "rut", wheel.rut_m, 0.0, wheel.radius_m);
  check_soil(soil);
  const Contact contact(wheel, soil, normal_stress);
  WheelReaction reaction;
  double low = 0.0;
  double high = 0.99 * wheel.radius_m;
  if (const double most = contact.load(high, reaction); most < wheel.load_n) {
    if (at_axle == AtAxle::kTakeForces) {
      const double scale = wheel.load_n / std::max(most, 1e-3 * wheel.load_n);
      for (double* force :
           {&reaction.drawbar_pull_n, &reaction.side_force_n, &reaction.torque_nm}) {
        *force *= scale;
      }
      return reaction;
    }
    throw InputError("wheel: load = " + shortest(wheel.load_n) +
                     " N sinks it to its axle in this soil; allowed is less");
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (contact.load(middle, reaction) < wheel.load_n ? low : high) = middle;
  }
  contact.load(0.5 * (low + high), reaction);
  return reaction;
}

// ---- the testbed

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
