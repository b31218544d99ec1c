// Bodies, wheels and tracks.
#include "host_sim/render/scene/robot_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/render/scene/povray.h"

namespace screed {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// The tread of a track or a tyre, within the radius that the physics rolls on.
constexpr double kLugPitch_m = 0.0115;
constexpr double kLugHeight_m = 0.0035;
constexpr double kLugLength_m = 0.0055;
constexpr double kBelt_m = 0.0025;

/// Textures and the shapes that every robot is made of. Boxes have round edges: sharp ones show no
/// highlights.
constexpr const char* kMacros = R"(
#declare Paint = texture { pigment { srgb <0.93,0.47,0.08> } finish { ambient 0 diffuse 0.8 specular 0.35 roughness 0.02 } }
#declare Dark = texture { pigment { srgb <0.22,0.23,0.25> } finish { ambient 0 diffuse 0.8 specular 0.25 roughness 0.04 } }
#declare Rubber = texture { pigment { srgb <0.16,0.155,0.15> } finish { ambient 0 diffuse 0.75 specular 0.10 roughness 0.10 } }
#declare Hub = texture { pigment { srgb <0.74,0.75,0.77> } finish { ambient 0 diffuse 0.75 specular 0.45 roughness 0.03 } }
#declare Circuit = texture { pigment { srgb <0.05,0.33,0.18> } finish { ambient 0 diffuse 0.8 specular 0.40 roughness 0.02 } }
#declare Chip = texture { pigment { srgb <0.10,0.16,0.42> } finish { ambient 0 diffuse 0.8 specular 0.40 roughness 0.02 } }
#declare Plain = texture { pigment { srgb <0.60,0.61,0.63> } finish { ambient 0 diffuse 0.8 specular 0.25 roughness 0.04 } }
// A box of half sides S round the origin, its edges rounded with R.
#macro Rounded(S, R)
  #local H = S - <R,R,R>;
  union {
    box { -<S.x,H.y,H.z>, <S.x,H.y,H.z> } box { -<H.x,S.y,H.z>, <H.x,S.y,H.z> } box { -<H.x,H.y,S.z>, <H.x,H.y,S.z> }
    #for (A, -1, 1, 2) #for (B, -1, 1, 2)
      cylinder { <-H.x,A*H.y,B*H.z>, <H.x,A*H.y,B*H.z>, R }
      cylinder { <A*H.x,-H.y,B*H.z>, <A*H.x,H.y,B*H.z>, R }
      cylinder { <A*H.x,B*H.y,-H.z>, <A*H.x,B*H.y,H.z>, R }
      sphere { <H.x,A*H.y,B*H.z>, R } sphere { <-H.x,A*H.y,B*H.z>, R }
    #end #end
  }
#end
// A wheel about y: rim, hub, spokes.
#macro Wheel(R, W)
  union {
    difference { cylinder { -y*W/2, y*W/2, R } cylinder { -y*W, y*W, 0.76*R } }
    cylinder { -y*W*0.36, y*W*0.36, 0.80*R texture { Dark } }
    #for (I, 0, 4) object { Rounded(<0.41*R, 0.44*W, 0.085*R>, 0.02*R) translate x*0.42*R rotate y*72*I } #end
    cylinder { -y*W*0.50, y*W*0.50, 0.24*R }
    cylinder { -y*W*0.54, y*W*0.54, 0.09*R texture { Dark } }
    texture { Hub }
  }
#end
// What lies within R of the line between two axles L apart, about y.
#macro Stadium(L, R, W)
  union {
    cylinder { <L/2,-W/2,0>, <L/2,W/2,0>, R } cylinder { <-L/2,-W/2,0>, <-L/2,W/2,0>, R }
    box { <-L/2-1e-6,-W/2,-R>, <L/2+1e-6,W/2,R> }
  }
#end
)";

const char* texture_of(const std::string& body, bool is_chassis) {
  const auto contains = [&](const char* part) { return body.find(part) != std::string::npos; };
  if (is_chassis) return "Paint";
  if (contains("Leg")) return "Dark";
  if (contains("Board")) return "Circuit";
  if (contains("Imu")) return "Chip";
  return "Plain";
}

std::string shape_text(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    const double edge = 0.12 * box->size.minCoeff();
    return pov_line("Rounded(<%.5f,%.5f,%.5f>, %.5f)", box->size.x() / 2, box->size.y() / 2,
                    box->size.z() / 2, edge);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    return pov_line("cylinder { <0,0,%.5f>, <0,0,%.5f>, %.5f }", -cylinder->length / 2,
                    cylinder->length / 2, cylinder->radius);
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    return pov_line("sphere { <0,0,0>, %.5f }", sphere->radius);
  }
  const auto& mesh = std::get<TriangleMesh>(shape.geometry);
  std::string text = pov_line("mesh2 { vertex_vectors { %zu", mesh.vertices.size());
  for (const Eigen::Vector3d& vertex : mesh.vertices) text += ", " + pov_vector(vertex);
  text += pov_line(" } face_indices { %zu", mesh.triangles.size());
  for (const auto& t : mesh.triangles) text += pov_line(", <%d,%d,%d>", t[0], t[1], t[2]);
  return text + " } }";
}

std::string body_text(const AssemblyBody& body, const char* texture) {
  std::string text;
  for (const Shape& shape : body.visual) {
    text += "  object { " + shape_text(shape) + " texture { " + texture + " }" +
            pov_matrix(body.pose * shape.pose) + " }\n";
  }
  return text;
}

/// A place on the contour round two axles: x forward, z up from between them; the angle of the
/// outward normal from the top, forwards.
struct ContourPoint {
  double x;
  double z;
  double angle_rad;
};

/// `s` metres along the contour from the rear end of its upper run, in the direction the material
/// takes when driving forward.
ContourPoint on_contour(double s, double length, double radius) {
  const double half_turn = std::numbers::pi * radius;
  if (s < length) return {s - length / 2, radius, 0.0};
  s -= length;
  if (s < half_turn) {
    const double angle = s / radius;
    return {length / 2 + radius * std::sin(angle), radius * std::cos(angle), angle};
  }
  s -= half_turn;
  if (s < length) return {length / 2 - s, -radius, std::numbers::pi};
  s -= length;
  const double angle = std::numbers::pi + s / radius;
  return {-length / 2 + radius * std::sin(angle), radius * std::cos(angle), angle};
}

/// Belt or tyre: a band with lugs, moved on by `travel_m`.
std::string tread_text(double length, double radius, double width, double travel_m) {
  const double band = radius - kLugHeight_m;
  const double inside = band - kBelt_m;
  std::string text =
      pov_line("    difference { Stadium(%.5f, %.5f, %.5f) Stadium(%.5f, %.5f, %.5f) }\n", length,
               band, width, length, inside, 1.1 * width);
  const double contour = 2.0 * length + kTwoPi * radius;
  const int lugs = std::max(8, static_cast<int>(std::lround(contour / kLugPitch_m)));
  for (int i = 0; i < lugs; ++i) {
    double s = std::fmod(travel_m + contour * i / lugs, contour);
    if (s < 0.0) s += contour;
    const ContourPoint at = on_contour(s, length, band);
    text += pov_line(
        "    object { Rounded(<%.5f,%.5f,%.5f>, 0.0006) translate z*%.5f rotate y*%.3f translate "
        "<%.5f,0,%.5f> }\n",
        kLugLength_m / 2, width / 2, kLugHeight_m / 2 + 0.0005, kLugHeight_m / 2 - 0.0005,
        at.angle_rad * 360.0 / kTwoPi, at.x, at.z);
  }
  return text;
}

/// The wheels at both ends and the tread round them, in a frame between the axles.
std::string gear_text(const AssemblyWheel& front, const AssemblyWheel& rear, double travel_m) {
  const Eigen::Vector3d run = front.centre - rear.centre;
  const double length = run.norm();
  const double radius = front.radius_m;
  const double width = front.width_m;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  if (length > 0.0) {
    const Eigen::Vector3d forward = run / length;
    place.linear().col(0) = forward;
    place.linear().col(2) = forward.cross(Eigen::Vector3d::UnitY()).normalized();
    place.linear().col(1) = place.linear().col(2).cross(forward);
  }
  place.translation() = 0.5 * (front.centre + rear.centre);
  const double wheel_radius = radius - kLugHeight_m - kBelt_m;
  const double turned_deg = std::fmod(travel_m / radius, kTwoPi) * 360.0 / kTwoPi;
  std::string text = "  union {\n    union {\n" + tread_text(length, radius, width, travel_m) +
                     "    texture { Rubber } }\n";
  const auto wheel_at = [&](double x) {
    text += pov_line("    object { Wheel(%.5f, %.5f) rotate y*%.3f translate x*%.5f }\n",
                     wheel_radius, 0.96 * width, turned_deg, x);
  };
  wheel_at(0.5 * length);
  if (length > 0.0) wheel_at(-0.5 * length);
  return text + "   " + pov_matrix(place) + "\n  }\n";
}

}  // namespace

std::string robot_text(const Assembly& assembly, bool tracks, const RobotPose& pose) {
  std::string text = std::string(kMacros) + "union {\n";
  for (size_t i = 0; i < assembly.bodies.size(); ++i) {
    const AssemblyBody& body = assembly.bodies[i];
    const int index = static_cast<int>(i);
    if (assembly.is_wheel(index)) continue;
    text += body_text(body, texture_of(body.name, index == assembly.chassis));
  }
  for (size_t side = 0; side < 2; ++side) {
    const auto& [front, rear] = assembly.wheels.at(side);
    const double travel = pose.travel_m.at(side);
    if (tracks) {
      text += gear_text(front, rear, travel);
    } else {
      text += gear_text(front, front, travel) + gear_text(rear, rear, travel);
    }
  }
  return text + " " + pov_matrix(pose.body) + "\n}\n";
}

}  // namespace screed
