// POV-Ray scenes of the grid world.
#include "host_sim/grid/grid_scene.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/scene/povray.h"
#include "host_sim/render/scene/scene_camera.h"

namespace screed {
namespace {

constexpr double kGap = 0.12;         ///< of the width of all frames, between two
constexpr double kHeightScale = 0.8;  ///< a voxel is a little flatter than wide
constexpr double kFieldOfView_deg = 46.0;

/// Height of the picture to its width.
double aspect_of(const std::vector<GridFrame>& frames) {
  return frames.size() == 1 ? 0.75 : 0.42;
}

/// Stacks and agents of one frame, its west side at x = left. POV-Ray: x east, y up, z north.
class FrameText {
 public:
  FrameText(const GridFrame& frame, double left) : frame_(frame), left_(left) {}

  std::string text() {
    for (int y = 0; y < frame_.terrain.height; ++y) {
      for (int x = 0; x < frame_.terrain.width; ++x) stack(x, y);
    }
    for (const FrameAgent& agent : frame_.agents) place(agent);
    return out_;
  }

 private:
  int height(int x, int y) const {
    if (x < 0 || y < 0 || x >= frame_.terrain.width || y >= frame_.terrain.height) return 0;
    return frame_.terrain
        .heights[static_cast<size_t>(y) * static_cast<size_t>(frame_.terrain.width) +
                 static_cast<size_t>(x)];
  }

  /// The voxels that can be seen, one by one; a single box for those below.
  void stack(int x, int y) {
    const int top = height(x, y);
    const int hidden =
        std::min({top - 1, height(x - 1, y), height(x + 1, y), height(x, y - 1), height(x, y + 1)});
    if (hidden > 0) box(x, y, 0, hidden, 0.0);
    for (int level = std::max(0, hidden); level < top; ++level) box(x, y, level, level + 1, 0.03);
  }

  void box(int x, int y, int from, int to, double gap) {
    out_ += pov_line("box { <%.3f,%.3f,%.3f>, <%.3f,%.3f,%.3f> texture { T%d } }\n",
                     left_ + x + gap, kHeightScale * from, y + gap, left_ + x + 1 - gap,
                     kHeightScale * to - gap, y + 1 - gap, to);
  }

  void place(const FrameAgent& agent) {
    const double base = kHeightScale * height(agent.x, agent.y);
    out_ +=
        pov_line("object { %s translate <%.3f,%.3f,%.3f> }\n", agent.carries ? "Loaded" : "Empty",
                 left_ + agent.x + 0.5, base + 0.75, agent.y + 0.5);
  }

  const GridFrame& frame_;
  double left_;
  std::string out_;
};

/// Looking north and down, a little from the west, as far away as everything needs to be seen: the
/// grids from their floor to an agent on the tallest stack.
std::string camera_text(const std::vector<GridFrame>& frames, double width, double depth,
                        int tallest) {
  constexpr double kAgent = 1.6;
  constexpr double kMargin = 0.03;
  CameraOrbit orbit;
  orbit.azimuth_deg = -92.0;
  orbit.elevation_deg = 42.0;
  // scene_camera.h has z up, this scene y.
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {0.0, width}) {
    for (const double north : {0.0, depth}) {
      corners.emplace_back(x, north, 0.0);
      corners.emplace_back(x, north, kHeightScale * tallest + kAgent);
    }
  }
  const SceneCamera camera =
      camera_around(orbit, corners, {kFieldOfView_deg, 1.0 / aspect_of(frames)}, kMargin);
  const auto place = [](const Eigen::Vector3d& at) {
    return pov_line("<%.3f,%.3f,%.3f>", at.x(), at.z(), at.y());
  };
  return "camera { location " + place(camera.location) + " look_at " + place(camera.target) +
         pov_line(" angle %.1f right x*image_width/image_height }\n", kFieldOfView_deg);
}

/// An icosahedron of that radius around the origin, as a mesh.
std::string icosahedron(const char* name, const char* pigment, double radius) {
  const double golden = (1.0 + std::sqrt(5.0)) / 2.0;
  const double scale = radius / std::sqrt(1.0 + golden * golden);
  const double a = scale;
  const double b = scale * golden;
  const double corners[12][3] = {{-a, b, 0}, {a, b, 0}, {-a, -b, 0}, {a, -b, 0},
                                 {0, -a, b}, {0, a, b}, {0, -a, -b}, {0, a, -b},
                                 {b, 0, -a}, {b, 0, a}, {-b, 0, -a}, {-b, 0, a}};
  constexpr int kFaces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  std::string text = pov_line("#declare %s = mesh2 {\n  vertex_vectors { 12", name);
  for (const auto& corner : corners) {
    text += pov_line(", <%.4f,%.4f,%.4f>", corner[0], corner[1], corner[2]);
  }
  text += " }\n  face_indices { 20";
  for (const auto& face : kFaces) text += pov_line(", <%d,%d,%d>", face[0], face[1], face[2]);
  return text + pov_line(" }\n  texture { pigment { rgb %s } finish { Shine } }\n}\n", pigment);
}

}  // namespace

std::string scene_text(const std::vector<GridFrame>& frames) {
  if (frames.empty()) throw InputError("grid: nothing to render");
  int tallest = 1;
  double width = 0.0;
  double depth = 0.0;
  for (const GridFrame& frame : frames) {
    if (frame.terrain.width > kLargestSceneSide || frame.terrain.height > kLargestSceneSide) {
      throw InputError("grid: " + std::to_string(frame.terrain.width) + "x" +
                       std::to_string(frame.terrain.height) + " cells are too many to render; " +
                       "allowed is " + std::to_string(kLargestSceneSide) + " a side");
    }
    tallest = std::max<int>(
        tallest, *std::max_element(frame.terrain.heights.begin(), frame.terrain.heights.end()));
    width += frame.terrain.width;
    depth = std::max<double>(depth, frame.terrain.height);
  }
  const double gap = kGap * width;
  const double all = width + gap * static_cast<double>(frames.size() - 1);

  std::string text =
      "// Made by `screed grid --render`. Stacks of voxels, before and after.\n"
      "#version 3.7;\n"
      "global_settings { assumed_gamma 1.0 }\n"
      "#declare Shine = finish { ambient 0 diffuse 0.85 specular 0.25 roughness 0.03 }\n"
      "background { color srgb <0.97,0.975,0.98> }\n";
  text += camera_text(frames, all, depth, tallest);
  text += pov_line(
      "light_source { <%.2f,%.2f,%.2f> rgb 0.92 area_light <%.2f,0,0>, <0,0,%.2f>, 4, 4 "
      "adaptive 1 }\n",
      -all * 0.5, all * 1.3, -all * 0.35, all * 0.12, all * 0.12);
  text += pov_line("light_source { <%.2f,%.2f,%.2f> rgb 0.34 shadowless }\n", all * 1.2, all * 1.0,
                   -all * 1.2);
  text +=
      "plane { y, -0.02 texture { pigment { srgb <0.93,0.935,0.94> } finish { diffuse 0.9 } } }\n";
  for (int level = 1; level <= tallest; ++level) {
    const Color color = height_color((level - 0.5) / tallest);
    text += pov_line(
        "#declare T%d = texture { pigment { srgb <%.4f,%.4f,%.4f> } finish { ambient 0 "
        "diffuse 0.9 } }\n",
        level, color.red, color.green, color.blue);
  }
  text += icosahedron("Empty", "<0.95,0.95,0.97>", 0.85);
  text += icosahedron("Loaded", "<0.75,0.10,0.05>", 0.85);
  double left = 0.0;
  for (const GridFrame& frame : frames) {
    text += FrameText(frame, left).text();
    left += frame.terrain.width + gap;
  }
  return text;
}

bool render_scene(const std::filesystem::path& picture, const std::vector<GridFrame>& frames,
                  int width_px, const TaskProgress& progress) {
  const double aspect = aspect_of(frames);
  PovrayJob job(picture);
  job.write_scene(scene_text(frames));
  const bool rendered =
      job.render(width_px, static_cast<int>(std::lround(width_px * aspect)), progress);
  job.publish();
  return rendered;
}

}  // namespace screed
