// Integrals along the contact of a wheel.
#include "host_sim/soil_validation/wheel_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/terrain/shear_field.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {

namespace {

constexpr int kSlices = 1000;  // along the contact; doubling it moves no figure by 1e-5 of itself
// Of a locked wheel: its rim has slid over the soil for ever.
constexpr double kForEver = 1e6;

/// Forces of the soil on the wheel.
struct Forces {
  double vertical = 0.0;
  double pull = 0.0;
  double side = 0.0;
  double torque = 0.0;
};

double square(const ShearState& shear) {
  return shear.along * shear.along + shear.across * shear.across;
}

class Contact {
 public:
  Contact(const RollingWheel& wheel, const SoilParameters& soil, NormalStress normal_stress)
      : wheel_(wheel),
        soil_(soil),
        passive_(soil),
        radial_(normal_stress == NormalStress::kRadial),
        tan_friction_(portable::tan(soil.friction_deg * kDegree)) {}

  struct Shape {
    double entry;   // angles from the lowest point forward
    double middle;  // of the greatest stress
    double exit;
    bool shaped;
    double bekker;
  };

  Shape shape_at(double sinkage, double slip) const {
    const double r = wheel_.radius_m;
    Shape shape{angle(std::max(0.0, sinkage - wheel_.rut_m)), 0.0, 0.0, false, 0.0};
    const double share = soil_.front_angle + soil_.front_angle_braked * std::max(0.0, -slip);
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

  /// The angle ahead where a point bears as it does at `theta`.
  static double bears_as(const Shape& shape, double theta) {
    if (!shape.shaped || theta >= shape.middle) return theta;
    return shape.entry -
           (theta - shape.exit) * (shape.entry - shape.middle) / (shape.middle - shape.exit);
  }

  /// How much higher the rim is than its lowest point.
  double rise(double theta) const { return wheel_.radius_m * (1.0 - portable::cos(theta)); }

  /// Without slip. `rise_as`: the rise of the place that it bears as.
  double pressure_at(const Shape& shape, double sinkage, double theta, double rise_as) const {
    if (!shape.shaped && theta <= 0.0) {
      return std::max(0.0, going_down(shape.bekker, sinkage) - soil_.elastic_pa_per_m * rise_as);
    }
    return going_down(shape.bekker, sinkage - rise_as);
  }

  /// On the way down: Bekker's law, never stiffer than the soil's own elasticity, which is what
  /// begins at the floor of a rut.
  double going_down(double bekker, double depth) const {
    if (depth <= wheel_.rut_m) return 0.0;
    return std::min(bekker * portable::pow(depth, soil_.exponent),
                    soil_.elastic_pa_per_m * (depth - wheel_.rut_m));
  }

  /// Adds those of a slice of the rim of this angle. `shear`: of the rim; `beside`: of the soil
  /// beside it.
  void add(Forces& sums, double theta, double slice, double depth, double pressure,
           const ShearState& shear, const ShearState& beside) const {
    const double r = wheel_.radius_m;
    const auto [sin, cos] = portable::sine_cosine(theta);
    const double strength =
        std::min(soil_.cohesion_pa + pressure * tan_friction_,
                 pressure > 0.0 ? wheel_.adhesion_pa + pressure * wheel_.friction : 0.0);
    const double tau = -strength * shear.along;
    const double area = wheel_.width_m * r * cos * slice;  // horizontal; the rim's is area / cos
    sums.side -= area / (radial_ ? cos : 1.0) * strength * shear.across;
    if (radial_) {
      sums.vertical += area * (pressure + tau * sin / cos);
      sums.pull += area * (tau - pressure * sin / cos);
      sums.torque += area * tau * r / cos;
    } else {
      sums.vertical += area * pressure;
      sums.pull += area * tau;
      sums.torque += area * r * (tau * cos + pressure * sin);
    }
    if (!(pressure > 0.0)) return;
    const double facing = std::max(0.0, shear.along) * std::max(0.0, sin / cos);
    sums.pull -= area * std::max(0.0, passive_.pressure(depth)) * facing;
    sums.side -= area / wheel_.width_m * passive_.resistance(std::max(0.0, depth)) * beside.across;
  }

  const RollingWheel& wheel() const { return wheel_; }
  const SoilParameters& soil() const { return soil_; }
  bool radial() const { return radial_; }
  /// From the lowest point to where the rim is higher by `rise`.
  double angle(double rise) const {
    return portable::acos(std::max(-1.0, 1.0 - rise / wheel_.radius_m));
  }

 private:
  RollingWheel wheel_;
  SoilParameters soil_;
  PassivePressure passive_;
  bool radial_;
  double tan_friction_;
};

/// Vertical force of the soil on a wheel that rolls steadily at this sinkage, and what comes with
/// it.
double load(const Contact& contact, double sinkage, WheelReaction& reaction) {
  const RollingWheel& wheel = contact.wheel();
  const SoilParameters& soil = contact.soil();
  const double r = wheel.radius_m;
  const Contact::Shape shape = contact.shape_at(sinkage, wheel.slip);
  // Speeds ahead and to the left over that of the rim; a locked rim's is 1 / kForEver.
  const double ahead_over_rim =
      wheel.slip >= 0.0 ? 1.0 - wheel.slip : 1.0 / std::max(1.0 + wheel.slip, 1.0 / kForEver);
  const double left_over_rim = ahead_over_rim * portable::tan(wheel.slip_angle_rad);
  const double slice = (shape.entry - shape.exit) / kSlices;
  const double per_k = r * slice / soil.shear_modulus_m;
  Forces sums;
  ShearState shear;   // of the rim, from its entry on
  ShearState beside;  // of the soil beside it
  for (int i = 0; i < kSlices; ++i) {
    const double theta = shape.entry - (i + 0.5) * slice;
    const auto [sin, cos] = portable::sine_cosine(theta);
    // While the rim turns by a slice. Positive: it slides ahead over the soil, or to the left.
    const double ahead = contact.radial() ? ahead_over_rim * cos - 1.0 : ahead_over_rim - cos;
    const auto half = [&] {
      shear.slide(0.5 * ahead * per_k, 0.5 * left_over_rim * per_k);
      beside.slide(0.0, 0.5 * portable::tan(wheel.slip_angle_rad) * per_k);
    };
    half();
    const double share =
        bearing_under_slip(soil.slip_bearing, std::abs(ahead_over_rim * sin),
                           slip_flow(square(shear), portable::hypot(ahead, left_over_rim)));
    contact.add(sums, theta, slice, sinkage - r * (1.0 - cos),
                share * contact.pressure_at(shape, sinkage, theta,
                                            contact.rise(Contact::bears_as(shape, theta))),
                shear, beside);
    half();
  }
  reaction.sinkage_m = sinkage;
  reaction.drawbar_pull_n = sums.pull;
  reaction.side_force_n = sums.side;
  reaction.torque_nm = sums.torque;
  reaction.contact_front_m = r * portable::sin(shape.entry);
  reaction.contact_rear_m = r * portable::sin(-shape.exit);
  reaction.rut_m =
      shape.shaped
          ? wheel.rut_m + (sinkage - wheel.rut_m) * (1.0 - soil.exit_angle * soil.exit_angle)
          : std::max(wheel.rut_m,  // soil that only gives at E, rounded
                     sinkage - contact.going_down(shape.bekker, sinkage) / soil.elastic_pa_per_m);
  return sums.vertical;
}

void check_wheel(const RollingWheel& wheel) {
  check_range("wheel", "radius", wheel.radius_m, 1e-3, 10.0);
  check_range("wheel", "width", wheel.width_m, 1e-3, 10.0);
  check_range("wheel", "load", wheel.load_n, 1e-3, 1e6);
  check_range("wheel", "friction", wheel.friction, 0.0, std::numeric_limits<double>::infinity());
  check_range("wheel", "adhesion", wheel.adhesion_pa, 0.0, 1e7);
}

}  // namespace

WheelReaction wheel_limit(const RollingWheel& wheel, const SoilParameters& soil,
                          NormalStress normal_stress, AtAxle at_axle) {
  check_wheel(wheel);
  check_range("wheel", "slip", wheel.slip, -1.0, 0.99);
  check_range("wheel", "slip angle", wheel.slip_angle_rad, -1.4, 1.4);
  check_range("wheel", "rut", wheel.rut_m, 0.0, wheel.radius_m);
  check_soil(soil);
  const Contact contact(wheel, soil, normal_stress);
  WheelReaction reaction;
  double low = 0.0;
  double high = 0.99 * wheel.radius_m;
  if (const double most = load(contact, high, reaction); most < wheel.load_n) {
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
    (load(contact, middle, reaction) < wheel.load_n ? low : high) = middle;
  }
  load(contact, 0.5 * (low + high), reaction);
  return reaction;
}

}  // namespace screed
