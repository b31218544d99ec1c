// `screed report`: a recorded run, or a campaign, as one HTML page; `screed render`: one frame of a
// recorded run as a ray-traced picture.
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_page.h"
#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_folder.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/report/run_page.h"
#include "host_sim/run/scene/log_session.h"
#include "host_sim/run/scene/run_scene.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/session/session_reader.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// ---- report ----

struct ReportOptions {
  std::string of;  ///< run or campaign
  std::string out;
  std::optional<std::string> metric;
  std::optional<std::uint64_t> baseline;
  bool incomplete = false;
  std::string board = kDefaultBoard;
  bool quiet = false;
};

fs::path built_page() {
  return data_folders().report / "page.html";
}

/// The page's own path, or the one that is meant when none is named. Throws InputError.
fs::path page_path(const ReportOptions& options, const fs::path& usual) {
  fs::path out = options.out.empty() ? usual : fs::path(options.out);
  if (out.extension() != ".html")
    throw InputError("--out " + options.out + ": the name ends in .html");
  return out;
}

int write_page(const fs::path& out, const std::string& text) {
  write_file(out, text);
  print("{}: {*1e-6:.2f} MB\n", out, text.size());
  return 0;
}

std::optional<Assembly> robot_of(const SessionReader& session, const fs::path& folder) {
  try {
    return robot_model(setup_of(session.info(), folder), session.info().board_name);
  } catch (const InputError& error) {
    std::cerr << "note: a marker stands for the robot: " << error.what() << "\n";
    return std::nullopt;
  }
}

int report_run(const ReportOptions& options) {
  if (options.metric || options.baseline || options.incomplete)
    throw InputError("--metric, --baseline, --incomplete: of campaigns, and " + options.of +
                     " is none");
  const ShownRun run(options.of, options.board);
  const fs::path file = run.is_log() ? fs::path(options.of) : session_file(options.of);
  const fs::path folder = fs::absolute(file).parent_path();
  const fs::path out = page_path(
      options, run.is_log() ? fs::path(file).replace_extension(".html") : folder / "report.html");
  const std::vector<SessionReader> sessions = open_robots(run.path());
  const SessionReader& session = sessions.front();
  if (!session.complete()) {
    std::cerr << (session.running() ? "note: the run goes on; this is what is saved so far\n"
                                    : "note: the recorded run did not end\n");
  }
  TaskBar bar(options.quiet);
  RunPageOptions page;
  page.built_page = built_page();
  page.name = file.filename() == "session.h5" ? folder.filename().string() : file.stem().string();
  page.robot = robot_of(session, folder);
  page.progress = bar.progress();
  const std::string text = run_page(sessions, page);
  bar.clear();
  return write_page(out, text);
}

int report_campaign(const ReportOptions& options, const TaskFolder& folder) {
  const fs::path out = page_path(options, folder.path / "report.html");
  const CampaignPlan plan = read_plan(folder.plan());
  const ResultIndex results(folder.results());
  const CampaignCount count = count_results(plan, results);
  if (count.missing() > 0 && !options.incomplete) {
    throw InputError(options.of + ": " + count.text() +
                     "; statistics of an incomplete campaign mislead: run the rest, or say "
                     "--incomplete");
  }
  CampaignPageOptions page;
  page.built_page = built_page();
  page.baseline = options.baseline.value_or(0);
  page.metric = options.metric;
  page.link_base = out.parent_path();
  return write_page(out, campaign_page(plan, count, run_table(plan, results),
                                       curve_table(plan, results), folder, page));
}

int run_report(const ReportOptions& options) {
  const TaskFolder campaign{options.of};
  return fs::exists(campaign.plan()) ? report_campaign(options, campaign) : report_run(options);
}

// ---- render ----

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
  const std::string frame = options.scene.frame  ? std::to_string(*options.scene.frame)
                            : options.scene.at_s ? filled("{:g}s", *options.scene.at_s)
                                                 : std::string("last");
  return folder / ("frame_" + frame + ".png");
}

int run_render(RenderOptions options) {
  if (options.scene.frame.has_value() && options.scene.at_s.has_value())
    throw InputError("--at and --frame: one of them says which frame");
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

void register_report_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<ReportOptions>(
      root, program, "report",
      "Write a recorded run, a robot's telemetry log or a campaign as one HTML page: terrain over "
      "time, path, curves, figures; means, differences, ranks",
      run_report);
  command
      .add_option("RUN", options.of,
                  "Run folder, session.h5, log as written by candump -L, or folder of a campaign")
      ->required();
  command
      .add_option(
          "--out", options.out,
          "Output page, .html; replaced where it exists (default: report.html in the folder, of a "
          "log the page beside it")
      ->type_name("FILE");
  command
      .add_option("--metric", options.metric,
                  "Column of runs.csv that the page of a campaign shows first")
      ->type_name("NAME");
  add_number(command, "--baseline", options.baseline,
             "Cell that the others of a campaign are compared with (default: 0)", {0, 1e6});
  command.add_flag("--incomplete", options.incomplete,
                   "Report a campaign although runs are missing; the page says so");
  command.add_option("--board", options.board, "Board of the robots of a log")
      ->type_name("NAME")
      ->show_default();
  command.add_flag("--quiet", options.quiet, "Show no progress");
}

void register_render_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<RenderOptions>(
      root, program, "render",
      "Render one frame of a recorded run as a ray-traced picture (needs povray)", run_render);
  command.add_option("RUN", options.run, "Run folder or session.h5")->required();
  add_number(command, "--frame", options.scene.frame,
             "Frame to render, from 0; negative counts from the end (default: the last)",
             {-1e9, 1e9});
  add_number(command, "--at", options.scene.at_s,
             "Time of the frame [simulated s], in place of --frame", {0.0, 1e6});
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
