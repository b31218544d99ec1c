// A plate pressed into level soil.
#include "host_sim/soil_validation/plate_press.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

constexpr double kPlateThickness_m = 0.02;

void check(const PlateTest& test) {
  check_range("plate", "length", test.length_m, 0.005, 1.0);
  check_range("plate", "width", test.width_m, 0.005, 1.0);
  check_range("plate", "cell", test.cell_m, 0.0005, 0.1);
  check_range("plate", "speed", test.speed_m_per_s, 1e-5, 10.0);
  check_range("plate", "step", test.step_s, 1e-5, 0.1);
  for (const double depth : test.depths_m) check_range("plate", "depth", depth, -0.1, 0.25);
}

}  // namespace

double bekker_pressure(const PlateTest& test, double depth_m) {
  if (depth_m <= 0.0) return 0.0;
  const double b = test.round ? 0.5 * test.length_m : std::min(test.length_m, test.width_m);
  const double bekker = test.soil.k_c / b + test.soil.k_phi;
  return std::min(bekker * portable::pow(depth_m, test.soil.exponent),
                  test.soil.elastic_pa_per_m * depth_m);
}

std::vector<PlatePoint> press_plate(const PlateTest& test) {
  check(test);
  const double reach = portable::hypot(test.length_m, test.width_m) +
                       2.0 * portable::hypot(test.offset_x_m, test.offset_y_m);
  const int nodes = 2 * static_cast<int>(std::ceil(0.5 * reach / test.cell_m)) + 9;
  SoilBed bed(HeightField(nodes, nodes, test.cell_m, false), test.soil, test.options);
  Footprint plate = test.round ? Footprint::disc(0.5 * test.length_m, kPlateThickness_m)
                               : Footprint::box({test.length_m, test.width_m, kPlateThickness_m});
  const double area = test.round ? 0.25 * std::numbers::pi * test.length_m * test.length_m
                                 : test.length_m * test.width_m;
  ContactMemory memory;
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_about(Eigen::Vector3d::UnitZ(), test.yaw_rad).toRotationMatrix();

  std::vector<PlatePoint> run;
  double begin = 0.0;
  for (const double end : test.depths_m) {
    const double travel = end - begin;
    const auto steps =
        static_cast<int>(std::ceil(std::abs(travel) / (test.speed_m_per_s * test.step_s) - 1e-9));
    motion.velocity.z() = std::copysign(test.speed_m_per_s, -travel);
    for (int i = 1; i <= steps; ++i) {
      const double depth = begin + travel * i / steps;
      pose.translation() << test.offset_x_m, test.offset_y_m, 0.5 * kPlateThickness_m - depth;
      plate.set_pose(pose);
      const TerrainReaction reaction = bed.press(plate, motion, test.step_s, memory);
      bed.end_step();
      run.push_back(
          {depth, reaction.force.z() / area, bekker_pressure(test, depth), memory.patch_b_m});
    }
    begin = end;
  }
  return run;
}

const PlatePoint& at_depth(const std::vector<PlatePoint>& run, double depth_m) {
  size_t best = 0;
  for (size_t i = 1; i < run.size() && run[i].depth_m > run[i - 1].depth_m; ++i) {
    if (std::abs(run[i].depth_m - depth_m) < std::abs(run[best].depth_m - depth_m)) best = i;
  }
  return run.at(best);
}

}  // namespace screed
