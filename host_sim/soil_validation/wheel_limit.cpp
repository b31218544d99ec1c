// Integrals along the contact of a wheel.
#include "host_sim/soil_validation/wheel_limit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

constexpr int kSlices = 4000;  // along the contact; halving it moves no figure by 1e-6 of itself
constexpr double kDegree = std::numbers::pi / 180.0;

class Contact {
 public:
  Contact(const RollingWheel& wheel, const SoilParameters& soil, NormalStress normal_stress)
      : wheel_(wheel),
        soil_(soil),
        radial_(normal_stress == NormalStress::kRadial),
        exponent_(soil.exponent + soil.slip_sinkage * std::max(0.0, wheel.slip)),
        tan_friction_(std::tan(soil.friction_deg * kDegree)),
        rim_over_hub_(1.0 / (1.0 - wheel.slip)) {}

  /// Vertical force of the soil at this sinkage, and what comes with it.
  double load(double sinkage, WheelReaction& reaction) const {
    const double r = wheel_.radius_m;
    const double front = angle(std::max(0.0, sinkage - wheel_.rut_m));
    // The touched rectangle's shorter side is Bekker's b, and its length ends where the elastic
    // part is used up: a fixed point, reached in a few turns.
    double rear = 0.0;
    double bekker = 0.0;
    for (int i = 0; i < 30; ++i) {
      const double b = std::min(wheel_.width_m, r * (std::sin(front) + std::sin(rear)));
      bekker = soil_.k_phi + soil_.k_c / std::max(b, 1e-3);
      const double rise = going_down(bekker, sinkage) / soil_.elastic_pa_per_m;
      rear = angle(std::min(rise, sinkage));
    }
    reaction = {};
    reaction.sinkage_m = sinkage;
    reaction.contact_front_m = r * std::sin(front);
    reaction.contact_rear_m = r * std::sin(rear);
    const double deepest = going_down(bekker, sinkage);
    reaction.rut_m = sinkage - deepest / soil_.elastic_pa_per_m;
    const double slice = (front + rear) / kSlices;
    double vertical = 0.0;
    double mobilised = 0.0;  // of the shear strength, with the direction of shear
    for (int i = 0; i < kSlices; ++i) {
      const double theta = front - (i + 0.5) * slice;
      const double sin = std::sin(theta);
      const double cos = std::cos(theta);
      const double dx = r * cos * slice;  // the hub's way while the soil passes this slice
      const double rate = radial_ ? rim_over_hub_ - cos : rim_over_hub_ * cos - 1.0;
      const double slip_distance = rate * dx;  // of the rim against the soil below it
      const double direction = slip_distance < 0.0 ? -1.0 : 1.0;
      const double half = std::exp(-0.5 * std::abs(slip_distance) / soil_.shear_modulus_m);
      const double here = direction + (mobilised - direction) * half;
      mobilised = direction + (here - direction) * half;
      const double depth = sinkage - r * (1.0 - cos);
      const double pressure =
          theta > 0.0 ? going_down(bekker, depth)
                      : std::max(0.0, deepest - soil_.elastic_pa_per_m * (sinkage - depth));
      const double strength = soil_.cohesion_pa + pressure * tan_friction_;
      const double tau = strength * here;
      const double area = wheel_.width_m * dx;  // horizontal; the rim's own is area / cos
      if (radial_) {
        vertical += area * (pressure + tau * sin / cos);
        reaction.drawbar_pull_n += area * (tau - pressure * sin / cos);
        reaction.torque_nm += area * tau * r / cos;
      } else {
        vertical += area * pressure;
        reaction.drawbar_pull_n += area * tau;
        reaction.torque_nm += area * r * (tau * cos + pressure * sin);
      }
    }
    return vertical;
  }

 private:
  /// From the lowest point to where the rim is higher by `rise`.
  double angle(double rise) const { return std::acos(1.0 - rise / wheel_.radius_m); }
  /// On the way down: Bekker's law, never stiffer than the soil's own elasticity, which is what
  /// begins at the floor of a rut.
  double going_down(double bekker, double depth) const {
    if (depth <= wheel_.rut_m) return 0.0;
    return std::min(bekker * std::pow(depth, exponent_),
                    soil_.elastic_pa_per_m * (depth - wheel_.rut_m));
  }

  RollingWheel wheel_;
  SoilParameters soil_;
  bool radial_;
  double exponent_;
  double tan_friction_;
  double rim_over_hub_;
};

}  // namespace

WheelReaction wheel_limit(const RollingWheel& wheel, const SoilParameters& soil,
                          NormalStress normal_stress) {
  check_range("wheel", "radius", wheel.radius_m, 1e-3, 10.0);
  check_range("wheel", "width", wheel.width_m, 1e-3, 10.0);
  check_range("wheel", "load", wheel.load_n, 1e-3, 1e6);
  check_range("wheel", "slip", wheel.slip, -1.0, 0.99);
  check_range("wheel", "rut", wheel.rut_m, 0.0, wheel.radius_m);
  check_soil(soil);
  const Contact contact(wheel, soil, normal_stress);
  WheelReaction reaction;
  double low = 0.0;
  double high = 0.99 * wheel.radius_m;
  if (contact.load(high, reaction) < wheel.load_n) {
    throw InputError("wheel: load = " + std::to_string(wheel.load_n) +
                     " N sinks it to its axle in this soil; allowed is less");
  }
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (contact.load(middle, reaction) < wheel.load_n ? low : high) = middle;
  }
  contact.load(0.5 * (low + high), reaction);
  return reaction;
}

}  // namespace screed
