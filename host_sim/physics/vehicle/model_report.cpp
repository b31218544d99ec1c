// Figures of a model, and the checks of it.
#include "host_sim/physics/vehicle/model_report.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <string_view>
#include <variant>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/vehicle_parts.h"

namespace screed {
namespace {

constexpr double kSame_m = 1e-3;  // lengths that should be equal
// Of the robot's mass: a body on a hinge that beds of particles carry (measured with a robot of 1.4
// kg on particles of 6 to 30 mm).
constexpr double kLightest = 0.005;
constexpr double kMaxGyrationShare = 2.0;  // of the largest extent; a solid body has at most 0.5

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

/// Of a shape about its own frame, turned into another.
Eigen::AlignedBox3d bounds_of(const Shape& shape, const Eigen::Isometry3d& pose) {
  const Eigen::Isometry3d at = pose * shape.pose;
  Eigen::AlignedBox3d bounds;
  const auto extend = [&](const Eigen::Vector3d& half) {
    const Eigen::Vector3d reach = at.linear().cwiseAbs() * half;
    bounds.extend(at.translation() - reach);
    bounds.extend(at.translation() + reach);
  };
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    extend(0.5 * box->size);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(sphere->radius);
    bounds.extend(at.translation() - reach);
    bounds.extend(at.translation() + reach);
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    // Along each axis: half the length and the radius, as much of them as lies along it.
    const Eigen::Array3d along = at.linear().col(2).array();
    const Eigen::Array3d across = (1.0 - along.square()).max(0.0).sqrt();
    const Eigen::Vector3d reach =
        (0.5 * cylinder->length * along.abs() + cylinder->radius * across).matrix();
    bounds.extend(at.translation() - reach);
    bounds.extend(at.translation() + reach);
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
    for (const Eigen::Vector3d& vertex : mesh->vertices) bounds.extend(at * vertex);
  }
  return bounds;
}

double bottom(const AssemblyWheel& wheel) {
  return wheel.centre.z() - wheel.radius_m;
}

const std::string& name_of(const Assembly& assembly, const AssemblyWheel& wheel) {
  return assembly.bodies[static_cast<size_t>(wheel.body)].name;
}

class Checks {
 public:
  Checks(const Assembly& assembly, ModelReport& report) : assembly_(assembly), report_(report) {}

  void run() {
    wheels();
    names();
    sides();
    hull();
    balance();
    for (const AssemblyBody& body : assembly_.bodies) inertia(body);
    joints();
  }

 private:
  void warn(std::string line) { report_.warnings.push_back(std::move(line)); }

  void wheels() {
    const AssemblyWheel& first = assembly_.wheels[0][0];
    for (const auto& side : assembly_.wheels) {
      for (const AssemblyWheel& wheel : side) {
        const char* name = name_of(assembly_, wheel).c_str();
        if (std::string_view(wheel.source).starts_with("visual")) {
          warn(text("wheel '%s' has no collision shape: it rolls on its %s", name, wheel.source));
        }
        if (std::abs(bottom(wheel) - bottom(first)) > kSame_m) {
          warn(text("the wheels' bottoms are not at one height: '%s' %.1f mm, '%s' %.1f mm", name,
                    1e3 * bottom(wheel), name_of(assembly_, first).c_str(), 1e3 * bottom(first)));
        }
        if (std::abs(wheel.radius_m - first.radius_m) > kSame_m) {
          warn(text("the wheels' radii differ: '%s' %.1f mm, '%s' %.1f mm", name,
                    1e3 * wheel.radius_m, name_of(assembly_, first).c_str(), 1e3 * first.radius_m));
        }
        if (2.0 * wheel.radius_m < wheel.width_m) {
          warn(text("wheel '%s' is wider (%.1f mm) than its diameter (%.1f mm)", name,
                    1e3 * wheel.width_m, 2e3 * wheel.radius_m));
        }
      }
    }
  }

  /// Names that say another side or end than where the wheel is.
  void names() {
    constexpr const char* kSides[] = {"left", "right"};
    constexpr const char* kEnds[] = {"front", "rear"};
    for (size_t side = 0; side < 2; ++side) {
      for (size_t end = 0; end < 2; ++end) {
        const std::string& given = name_of(assembly_, assembly_.wheels[side][end]);
        std::string name = given;
        for (char& letter : name) letter = static_cast<char>(std::tolower(letter));
        const auto says = [&](const char* word) { return name.find(word) != std::string::npos; };
        const bool other_side = says(kSides[1 - side]) && !says(kSides[side]);
        const bool other_end = says(kEnds[1 - end]) && !says(kEnds[end]);
        if (!other_side && !other_end) continue;
        warn(text("wheel '%s' is the %s %s one by its place, not by its name", given.c_str(),
                  kEnds[end], kSides[side]));
      }
    }
  }

  void sides() {
    const auto& [left, right] = assembly_.wheels;
    const double rear_tread = left[1].centre.y() - right[1].centre.y();
    if (std::abs(rear_tread - report_.tread_m) > kSame_m) {
      warn(text("the tread is %.1f mm in front and %.1f mm behind", 1e3 * report_.tread_m,
                1e3 * rear_tread));
    }
    const double right_base = right[0].centre.x() - right[1].centre.x();
    if (std::abs(right_base - report_.wheelbase_m) > kSame_m) {
      warn(text("the wheelbase is %.1f mm on the left and %.1f mm on the right",
                1e3 * report_.wheelbase_m, 1e3 * right_base));
    }
    const double aside = 0.5 * (left[0].centre.y() + right[0].centre.y());
    if (std::abs(aside) > kSame_m) {
      warn(text("the origin of the chassis is %.1f mm beside the middle of the wheels",
                1e3 * std::abs(aside)));
    }
  }

  void hull() {
    if (!std::isfinite(report_.clearance_m)) {
      warn("nothing but the wheels has a collision shape: the rest passes through the terrain");
    } else if (report_.clearance_m <= 0.0) {
      warn(
          text("a collision shape reaches %.1f mm below the wheels: the robot does not stand on "
               "them",
               -1e3 * report_.clearance_m));
    }
  }

  void balance() {
    double rear = std::numeric_limits<double>::infinity();
    double front = -rear;
    double right = rear;
    double left = -rear;
    for (const auto& side : assembly_.wheels) {
      for (const AssemblyWheel& wheel : side) {
        rear = std::min(rear, wheel.centre.x());
        front = std::max(front, wheel.centre.x());
        right = std::min(right, wheel.centre.y());
        left = std::max(left, wheel.centre.y());
      }
    }
    const Eigen::Vector3d& c = report_.centre;
    if (c.x() > rear && c.x() < front && c.y() > right && c.y() < left) return;
    warn(
        text("the centre of mass (x %.1f mm, y %.1f mm) is not over the wheels: the robot tips "
             "over",
             1e3 * c.x(), 1e3 * c.y()));
  }

  // Inertia that no body of this size can have: numbers left from a template, or in other units.
  void inertia(const AssemblyBody& body) {
    if (body.inertia.mass <= 0.0) return;
    Eigen::AlignedBox3d bounds;
    for (const auto& shapes : {body.collision, body.visual}) {
      for (const Shape& shape : shapes) {
        bounds.extend(bounds_of(shape, Eigen::Isometry3d::Identity()));
      }
    }
    if (bounds.isEmpty()) return;
    const double gyration =
        std::sqrt(body.inertia.tensor.diagonal().maxCoeff() / body.inertia.mass);
    const double extent = bounds.sizes().maxCoeff();
    if (gyration <= kMaxGyrationShare * extent) return;
    warn(
        text("link '%s' has the inertia of a body far larger than it is: radius of gyration %.0f "
             "mm, extent %.0f mm",
             body.name.c_str(), 1e3 * gyration, 1e3 * extent));
  }

  void joints() {
    for (const AssemblyJoint& joint : assembly_.joints) {
      if (assembly_.is_wheel(joint.child)) {
        if (joint.kind == AssemblyJoint::Kind::Fixed) {
          warn(text("wheel joint '%s' is fixed: the wheel has no motor", joint.name.c_str()));
        }
        continue;
      }
      if (joint.kind == AssemblyJoint::Kind::Revolute) {
        warn(text("joint '%s' swings freely%s: nothing holds or drives it; type=\"fixed\" does",
                  joint.name.c_str(), joint.limited ? " between its stops" : ""));
        const double mass_kg =
            composed_inertia(assembly_, rigid_group(assembly_, joint.child)).mass;
        if (mass_kg < kLightest * report_.mass_kg) {
          warn(
              text("what hangs on joint '%s' has %.2g %% of the robot's mass: particles throw up "
                   "what has less than %.1g %%; fix it, or make it heavier",
                   joint.name.c_str(), 100.0 * mass_kg / report_.mass_kg, 100.0 * kLightest));
        }
      }
    }
  }

  const Assembly& assembly_;
  ModelReport& report_;
};

/// Of the lowest collision shape, wheels aside.
double lowest(const Assembly& assembly) {
  double z = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < assembly.bodies.size(); ++i) {
    if (assembly.is_wheel(static_cast<int>(i))) continue;
    for (const Shape& shape : assembly.bodies[i].collision) {
      z = std::min(z, bounds_of(shape, assembly.bodies[i].pose).min().z());
    }
  }
  return z;
}

}  // namespace

ModelReport report_model(const Assembly& assembly, const VehicleOptions& options,
                         bool either_drive) {
  ModelReport report;
  std::vector<int> all;
  all.reserve(assembly.bodies.size());
  for (size_t i = 0; i < assembly.bodies.size(); ++i) all.push_back(static_cast<int>(i));
  const Inertia whole = composed_inertia(assembly, all);
  report.mass_kg = whole.mass;
  report.centre = whole.pose.translation();
  report.inertia = whole.tensor;
  if (assembly.imu >= 0) {
    report.imu = assembly.bodies[static_cast<size_t>(assembly.imu)].pose.translation();
  }
  const auto& [left, right] = assembly.wheels;
  report.tread_m = left[0].centre.y() - right[0].centre.y();
  report.wheelbase_m = left[0].centre.x() - left[1].centre.x();
  double ground = std::numeric_limits<double>::infinity();
  for (const auto& side : assembly.wheels) {
    for (const AssemblyWheel& wheel : side) ground = std::min(ground, bottom(wheel));
  }
  report.clearance_m = lowest(assembly) - ground;
  Checks(assembly, report).run();
  try {
    const VehicleParts parts(assembly, options);
  } catch (const InputError& error) {
    if (!either_drive) throw;
    VehicleOptions other = options;
    other.tracks = !other.tracks;
    const VehicleParts parts(assembly, other);
    report.warnings.push_back(text("with [vehicle] tracks = %s it is refused: %s",
                                   options.tracks ? "true" : "false", error.what()));
  }
  return report;
}

}  // namespace screed
