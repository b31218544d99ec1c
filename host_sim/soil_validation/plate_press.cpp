// A plate pressed into level soil.
#include "host_sim/soil_validation/plate_press.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"
#include "host_sim/physics/soil/soil_laws.h"
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
  return std::min(bekker_pressure_pa(test.soil, b, depth_m), test.soil.elastic_pa_per_m * depth_m);
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

// ---- plate and block on particles

namespace {

constexpr double kRay_m = 0.005;
constexpr double kBedMargin_m = 0.13;  // of the bed around the plate
constexpr std::array kPressures_pa = {1e3, 2e3, 3e3, 5e3, 8e3, 12e3, 16e3, 20e3};
constexpr double kDown_m_per_s = 0.01;
constexpr double kUp_m_per_s = 0.004;
constexpr double kAway_m_per_s = 0.02;
constexpr double kParticlePlateThickness_m = 0.02;
constexpr double kAverage = 0.02;  // share of a step in the mean force
constexpr int kRestSteps = 400;
constexpr double kDamping_per_s = 20.0;  // of the block's way up and down
constexpr double kWheel_m = 0.03;
constexpr double kBin_m = 0.0015;
constexpr size_t kBins = 14;

void check(const ParticlePlateTest& test) {
  check_range("match", "depth", test.depth_m, 0.02, 1.0);
  check_range("match", "length", test.length_m, 0.02, 0.3);
  check_range("match", "width", test.width_m, 0.02, 0.3);
  check_range("match", "load", test.load_pa, 100.0, 1e5);
  check_range("match", "speed", test.speed_m_per_s, 0.001, 1.0);
  check_range("match", "beds", test.beds, 1, 64);
}

ParticleBed bed_of(const ParticlePlateTest& test, int number, const TaskProgress& progress) {
  ParticleOptions options;
  options.material = test.particle;
  options.ray_spacing_m = kRay_m;
  options.seed = test.seed + static_cast<uint64_t>(number);
  const double size = std::max(test.length_m, test.width_m) + 2.0 * kBedMargin_m;
  const int nodes = 2 * static_cast<int>(std::ceil(0.5 * size / kRay_m)) + 1;
  return {HeightField::from_function(nodes, nodes, kRay_m, false,
                                     [&](double, double) { return test.depth_m; }),
          options, progress};
}

/// Whether a node lies below a plate in the middle.
bool below(const HeightField& field, int ix, int iy, const ParticlePlateTest& test) {
  return std::abs(field.node_x(ix)) <= 0.5 * test.length_m &&
         std::abs(field.node_y(iy)) <= 0.5 * test.width_m;
}

double highest_below(const HeightField& field, const ParticlePlateTest& test) {
  Height highest = INT32_MIN;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      if (below(field, ix, iy, test)) highest = std::max(highest, field.node(ix, iy));
    }
  }
  return highest * kHeightUnit_m;
}

/// Means over the nodes below the plate, and what rose around it.
void measure(const HeightField& before, const HeightField& after, const ParticlePlateTest& test,
             ParticlePlatePoint& sum) {
  double sunk = 0.0;
  int count = 0;
  for (int iy = 0; iy < after.ny(); ++iy) {
    for (int ix = 0; ix < after.nx(); ++ix) {
      const double rise =
          (static_cast<double>(after.node(ix, iy)) - before.node(ix, iy)) * kHeightUnit_m;
      if (below(after, ix, iy, test)) {
        sunk -= rise;
        ++count;
      } else {
        sum.raised_m3 += rise * kRay_m * kRay_m;
      }
    }
  }
  sum.rut_m += sunk / count;
}

}  // namespace

std::vector<ParticlePlatePoint> press_particles(const ParticlePlateTest& test,
                                                const TaskProgress& progress) {
  check(test);
  std::vector<ParticlePlatePoint> points;
  points.reserve(kPressures_pa.size());
  for (const double pressure : kPressures_pa) points.push_back({pressure, 0.0, 0.0, 0.0});
  const double per_area = 1.0 / (test.length_m * test.width_m);
  for (int number = 0; number < test.beds; ++number) {
    size_t pressed = points.size() * static_cast<size_t>(number);
    const auto report = [&] {
      report_progress(progress, "pressing a plate", pressed,
                      points.size() * static_cast<size_t>(test.beds));
    };
    ParticleBed bed =
        bed_of(test, number, [&](std::string_view /*laying*/, double /*share*/) { report(); });
    const HeightField before = bed.surface();
    const double top = highest_below(before, test) + 0.5 * test.particle.radius_m;
    const double dt = bed.longest_step_s();
    Footprint plate = Footprint::box({test.length_m, test.width_m, kParticlePlateThickness_m});
    double height = top;
    double pressure = 0.0;
    const auto step = [&](double speed) {
      height += speed * dt;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() << 0.0, 0.0, height + 0.5 * kParticlePlateThickness_m;
      plate.set_pose(pose);
      FootprintMotion motion;
      motion.velocity.z() = speed;
      const TerrainReaction reaction = bed.press(plate, motion, dt);
      bed.step(dt);
      report();
      pressure += kAverage * (reaction.force.z() * per_area - pressure);
    };
    for (ParticlePlatePoint& point : points) {
      while (pressure < point.pressure_pa && height > 0.0) step(-kDown_m_per_s);
      const double deepest = height;
      while (pressure > 0.5 * point.pressure_pa) step(kUp_m_per_s);
      point.stiffness_pa_per_m += 0.5 * point.pressure_pa / (height - deepest);
      while (height < top) step(kAway_m_per_s);
      for (int i = 0; i < kRestSteps; ++i) bed.step(dt);
      ++pressed;
      measure(before, bed.surface(), test, point);
    }
  }
  for (ParticlePlatePoint& point : points) {
    point.rut_m /= test.beds;
    point.raised_m3 /= test.beds;
    point.stiffness_pa_per_m /= test.beds;
  }
  return points;
}

ParticleDrag drag_over_particles(const ParticlePlateTest& test, const TaskProgress& progress) {
  check(test);
  std::array<double, kBins> along{};
  std::array<double, kBins> load{};
  const double mass = test.load_pa * test.length_m * test.width_m / kGravity_m_per_s2;
  for (int number = 0; number < test.beds; ++number) {
    double share = 0.0;  // of this bed
    const auto report = [&] {
      report_progress(progress, "dragging a block", (number + share) / test.beds);
    };
    ParticleBed bed =
        bed_of(test, number, [&](std::string_view /*laying*/, double /*share*/) { report(); });
    const double dt = bed.longest_step_s();
    Footprint block = Footprint::track(0.5 * test.length_m, kWheel_m, test.width_m);
    Eigen::Vector3d place(0.0, 0.0, highest_below(bed.surface(), test) + kWheel_m);
    FootprintMotion motion;
    const auto step = [&] {
      place += motion.velocity * dt;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = place;
      block.set_pose(pose);
      const TerrainReaction reaction = bed.press(block, motion, dt);
      bed.step(dt);
      report();
      motion.velocity.z() += dt * (reaction.force.z() / mass - kGravity_m_per_s2 -
                                   kDamping_per_s * motion.velocity.z());
      return reaction.force;
    };
    const auto settling = static_cast<int>(0.5 / dt);
    for (int i = 0; i < settling; ++i) step();
    motion.velocity.x() = test.speed_m_per_s;
    while (place.x() < kBins * kBin_m) {
      share = std::clamp(place.x() / (kBins * kBin_m), share, 1.0);
      const auto bin = std::min(kBins - 1, static_cast<size_t>(place.x() / kBin_m));
      const Eigen::Vector3d force = step();
      along.at(bin) -= force.x();
      load.at(bin) += force.z();
    }
  }
  ParticleDrag drag{0.0, 0.0};
  std::array<double, kBins> friction{};
  for (size_t i = 0; i < kBins; ++i) {
    friction.at(i) = along.at(i) / load.at(i);
    drag.friction = std::max(drag.friction, friction.at(i));
  }
  // Between the middles of the bins; before the first, from nothing.
  const double sought = (1.0 - portable::exp(-1.0)) * drag.friction;
  double last = 0.0;
  double last_distance = 0.0;
  for (size_t i = 0; i < kBins; ++i) {
    const double distance = (static_cast<double>(i) + 0.5) * kBin_m;
    if (friction.at(i) >= sought) {
      drag.shear_displacement_m =
          last_distance + (distance - last_distance) * (sought - last) / (friction.at(i) - last);
      break;
    }
    last = friction.at(i);
    last_distance = distance;
  }
  return drag;
}

}  // namespace screed
