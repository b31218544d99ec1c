// `screed render`: one frame of a recorded run as a ray-traced picture.
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "host_sim/run/scene/run_scene.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

struct RenderOptions {
  std::string run;
  std::string camera = "front";
  std::string out;
  std::string model;
  bool no_path = false;
  bool no_tint = false;
  bool quiet = false;
  RunSceneOptions scene;
};

/// In the run's own folder, under the number of the frame.
std::filesystem::path default_picture(const RenderOptions& options) {
  std::error_code error;
  const std::filesystem::path run = options.run;
  const std::filesystem::path folder =
      std::filesystem::is_directory(run, error) ? run : run.parent_path();
  const std::string frame =
      options.scene.frame ? std::to_string(*options.scene.frame) : std::string("last");
  return folder / ("frame_" + frame + ".png");
}

int run_render(RenderOptions options) {
  options.scene.camera = camera_orbit(options.camera);
  options.scene.path = !options.no_path;
  options.scene.tint = !options.no_tint;
  if (!options.model.empty()) options.scene.model = options.model;
  const std::filesystem::path picture =
      options.out.empty() ? default_picture(options) : std::filesystem::path(options.out);
  TaskBar bar(options.quiet);
  options.scene.progress = bar.progress();
  const RunSceneResult result = render_run(options.run, picture, options.scene);
  bar.clear();
  if (result.terrain_is_later) {
    std::cerr << "note: the session holds no terrain of frame " << result.frame
              << "; the ground is drawn as the run left it\n";
  }
  if (result.rendered) {
    std::cout << "frame " << result.frame << ": " << picture.string() << "\n";
  } else if (options.scene.pov_only) {
    std::cout << "frame " << result.frame << ": " << result.scene.string() << "\n";
  } else {
    std::cout << "frame " << result.frame << ": " << result.scene.string()
              << " (no picture: povray is not installed)\n";
  }
  return 0;
}

}  // namespace

void register_render_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<RenderOptions>(
      root, program, "render",
      "Render one frame of a recorded run as a ray-traced picture (needs povray)", run_render);
  command.add_option("RUN", options.run, "Run folder or session.h5")->required();
  add_number(command, "--frame", options.scene.frame,
             "Frame to render, from 0; negative counts from the end (default: the last)",
             {-1e9, 1e9});
  command
      .add_option("--out", options.out,
                  "Output picture, .png or .jpg (default: RUN/frame_N.png); the scene, .pov, "
                  "and its images are written beside it")
      ->type_name("FILE");
  add_number(command, "--width", options.scene.width_px, "Width of the picture [px]", {16, 8000});
  add_number(command, "--height", options.scene.height_px, "Height of the picture [px]",
             {16, 8000});
  command
      .add_option("--camera", options.camera,
                  "Camera: front, back, side, above, bed, or AZIMUTH,ELEVATION,DISTANCE round the "
                  "robot [degrees from its nose, degrees above the horizon, m]")
      ->type_name("VIEW")
      ->show_default();
  command.add_option("--model", options.model, "URDF of the robot (default: the experiment's)")
      ->type_name("FILE");
  command.add_flag("--no-path", options.no_path, "Do not draw the driven path");
  command.add_flag("--no-tint", options.no_tint,
                   "Leave the terrain in its own colours, without heights and colour bar");
  command.add_flag("--pov-only", options.scene.pov_only, "Write the scene without rendering it");
  command.add_flag("--quiet", options.quiet, "Show no progress");
}

}  // namespace screed
