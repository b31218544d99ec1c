// `screed terrain-net`: trains networks that predict what the robot does to the terrain, and
// compares them with recorded runs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"
#include "nn/terrain/drive_strides.h"
#include "nn/terrain/terrain_network.h"
#include "nn/terrain/terrain_trainer.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/viewer/ground_view.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct TrainOptions {
  std::vector<std::string> runs;
  std::string kind = "flux";
  std::string out = "terrain.json";
  std::size_t hidden = 32;
  std::size_t every = 3;
  std::size_t epochs = 10;
  std::uint64_t seed = 1;
};

struct CompareOptions {
  std::string network;
  std::vector<std::string> beside;
  std::vector<std::string> runs;
  double from = 0.0;
  double seconds = 40.0;
  std::string pictures;
};

void print_epoch(std::size_t epoch, double mse_mm2) {
  std::cerr << "epoch " << epoch << ": " << mse_mm2 << " mm^2\n";
}

/// The thesis' network, reduced, on every stride.
int train_window(const TrainOptions& options) {
  std::vector<std::unique_ptr<nn::DriveStrides>> drives;
  std::vector<const nn::DriveStrides*> pointers;
  for (const std::string& run : options.runs) {
    drives.push_back(std::make_unique<nn::DriveStrides>(run));
    pointers.push_back(drives.back().get());
  }
  nn::train_window(pointers, options.epochs, options.seed, print_epoch).write(options.out);
  std::cout << options.out << "\n";
  return 0;
}

int run_train(const TrainOptions& options) {
  if (options.kind == "window") return train_window(options);
  nn::FluxExamples examples;
  for (const std::string& run : options.runs) {
    add_examples(nn::DriveStrides(run), options.every, examples);
  }
  nn::FluxNetwork network(options.hidden, options.seed);
  double squares = 0.0;
  for (const float change : examples.changes)
    squares += static_cast<double>(change) * static_cast<double>(change);
  constexpr double kOutput_mm = nn::FluxNetwork::kOutput_m * 1e3;
  std::cerr << examples.rows() << " examples, " << network.weights()
            << " weights; without a network: "
            << squares / static_cast<double>(examples.changes.size()) * kOutput_mm * kOutput_mm
            << " mm^2\n";
  train(network, examples, options.epochs, options.seed, print_epoch);
  network.write(options.out);
  std::cout << options.out << "\n";
  return 0;
}

void print_row(const std::string& who, const HeightField& before, const HeightField& real,
               const HeightField& ground, const std::vector<nn::Stride>& path) {
  const nn::TerrainComparison c = nn::compare(before, real, ground);
  const nn::RutCount ruts = nn::count_ruts(before, ground, path);
  std::printf("  %-11s %12.3f %12.3f %12.1f %12.4f %14lld %8.2f\n", who.c_str(), c.error_mm,
              c.outside_mm, c.moved_cm3, c.volume_cm3, static_cast<long long>(c.volume_units),
              ruts.mean);
}

std::vector<HeightChange> changes_between(const HeightField& from, const HeightField& to) {
  std::vector<HeightChange> changes;
  const auto nodes = static_cast<std::size_t>(from.nx()) * static_cast<std::size_t>(from.ny());
  for (std::size_t i = 0; i < nodes; ++i) {
    if (to.node(i) != from.node(i)) {
      changes.push_back({static_cast<uint32_t>(i), to.node(i) - from.node(i)});
    }
  }
  return changes;
}

/// What was changed along the path, a panel each, all in the colours of the first.
void draw_changes(const fs::path& file, const HeightField& before,
                  const std::vector<std::pair<std::string, const HeightField*>>& grounds,
                  const std::vector<nn::Stride>& path) {
  constexpr double kRobot_m = 0.2;
  constexpr double kWidth_px = 1000.0;
  constexpr double kTitle_px = 30.0;
  MapRectangle area{1e9, -1e9, 1e9, -1e9};
  for (const nn::Stride& stride : path) {
    area.x_min = std::min(area.x_min, stride.x_m - kRobot_m);
    area.x_max = std::max(area.x_max, stride.x_m + kRobot_m);
    area.y_min = std::min(area.y_min, stride.y_m - kRobot_m);
    area.y_max = std::max(area.y_max, stride.y_m + kRobot_m);
  }
  const double scale = kWidth_px / (area.x_max - area.x_min);
  const double height = std::floor(scale * (area.y_max - area.y_min));
  Canvas canvas(static_cast<int>(kWidth_px),
                static_cast<int>(grounds.size()) * static_cast<int>(height + kTitle_px),
                {1.0, 1.0, 1.0});
  viewer::TerrainImage image(before, before);
  const HeightField* shown = &before;
  double top = 0.0;
  for (const auto& [name, ground] : grounds) {
    image.update(*ground, changes_between(*shown, *ground));
    shown = ground;
    image.paint(*ground, viewer::Shading::kChange);
    viewer::Camera camera;
    camera.set_box({0.0, top + kTitle_px, kWidth_px, height});
    camera.zoom(scale / camera.scale(), camera.middle());
    camera.look_at(0.5 * (area.x_min + area.x_max), 0.5 * (area.y_min + area.y_max));
    viewer::draw_terrain({canvas.pixels(), canvas.width()}, camera, image,
                         {before.x_min(), before.y_min(), before.spacing_m(), before.wrap()},
                         0x00FFFFFFU);
    canvas.release_pixels();
    const double end_mm = image.scale(viewer::Shading::kChange).high;
    canvas.text({8.0, top + 21.0}, name, {.size_px = 16.0, .bold = true});
    canvas.text({kWidth_px - 8.0, top + 21.0},
                "blue: lowered, red: raised, by up to " + number_text(end_mm, 0) + " mm;  " +
                    number_text(area.x_max - area.x_min, 2) + " m wide",
                {.size_px = 13.0, .align = TextAlign::kRight});
    top += height + kTitle_px;
  }
  canvas.write_png(file);
}

/// A terrain that a network changes along a drive.
struct Prediction {
  std::string name;
  nn::GroundChange change;
  HeightField ground;
};

void compare_on(const std::string& run, const CompareOptions& options,
                const std::vector<nn::TerrainNetwork>& networks, TaskBar& bar) {
  const TaskProgress progress = bar.progress();
  const nn::DriveStrides drive(run);
  if (drive.tracks()) throw InputError(run + ": was driven on tracks; allowed are runs on wheels");
  const auto begin =
      std::min(drive.size(), static_cast<std::size_t>(options.from * nn::kStrideRate_hz));
  const std::size_t end = std::min(
      drive.size(), begin + static_cast<std::size_t>(options.seconds * nn::kStrideRate_hz));
  if (begin == end) {
    throw InputError("--from " + plain_text(options.from) + ": " + run + " has only " +
                     plain_text(static_cast<double>(drive.size()) / nn::kStrideRate_hz) + " s");
  }
  const HeightField before = drive.terrain_after(begin);
  const HeightField real = drive.terrain_after(end);

  std::vector<Prediction> all;
  all.reserve(networks.size());
  for (const nn::TerrainNetwork& network : networks) {
    all.push_back({network.kind, network.change(drive.robot()), before});
  }
  std::vector<nn::Stride> path;
  for (std::size_t i = begin; i < end; ++i) {
    report_progress(progress, "predicting", i - begin, end - begin);
    path.push_back(drive[i]);
    for (Prediction& one : all) one.change(one.ground, drive[i]);
  }
  bar.clear();
  const nn::TerrainComparison c = nn::compare(before, real, real);
  std::printf("%s: %zu strides, touched %.3f m^2, changed there by %.3f mm RMS\n", run.c_str(),
              path.size(), c.touched_m2, c.true_change_mm);
  std::printf("  %-11s %12s %12s %12s %12s %14s %8s\n", "", "RMSE mm", "outside mm", "moved cm3",
              "volume cm3", "volume units", "ruts");
  print_row("recorded", before, real, real, path);
  print_row("no change", before, real, before, path);
  for (const Prediction& one : all) print_row(one.name, before, real, one.ground, path);
  if (options.pictures.empty()) return;
  fs::create_directories(options.pictures);
  std::vector<std::pair<std::string, const HeightField*>> grounds = {{"recorded", &real}};
  for (const Prediction& one : all) grounds.emplace_back(one.name, &one.ground);
  draw_changes(fs::path(options.pictures) / (fs::path(run).filename().string() + ".png"), before,
               grounds, path);
}

int run_compare(const CompareOptions& options) {
  std::vector<nn::TerrainNetwork> networks = {nn::read_terrain_network(options.network)};
  for (const std::string& file : options.beside) {
    networks.push_back(nn::read_terrain_network(file));
  }
  const CatchInterrupts signals;
  for (const std::string& run : options.runs) {
    TaskBar bar(false, fs::path(run).filename().string() + ": ");
    compare_on(run, options, networks, bar);
  }
  return 0;
}

}  // namespace

void register_terrain_net_command(Command& root, Program& program) {
  Command* command = root.add_subcommand("terrain-net",
                                         "Train and compare networks that predict how wheels "
                                         "deform the terrain (thesis 6.3.1)");

  const auto train = std::make_shared<TrainOptions>();
  Command* train_command =
      command->add_subcommand("train", "Train a network on recorded runs with wheels");
  train_command->add_option("RUN", train->runs, "Runs with recorded heights")->required();
  train_command
      ->add_option("--kind", train->kind,
                   "flux: soil that moves between cells below each wheel; window: the thesis' "
                   "network, reduced")
      ->show_default()
      ->one_of({"flux", "window"});
  train_command->add_option("--out", train->out, "Network file to write")
      ->type_name("FILE")
      ->show_default();
  add_number(*train_command, "--hidden", train->hidden, "flux: number of nodes of the hidden layer",
             {1, 512});
  add_number(*train_command, "--every", train->every, "flux: use every n-th stride as an example",
             {1, 1000});
  add_number(*train_command, "--epochs", train->epochs, "Number of epochs", {1, 1e6});
  add_number(*train_command, "--seed", train->seed, "Seed of the training", kSeedRange);
  train_command->callback(
      [train, &program] { program.action = [train] { return run_train(*train); }; });

  const auto compared = std::make_shared<CompareOptions>();
  Command* compare_command = command->add_subcommand(
      "compare", "Compare terrain deformed by networks with recorded drives");
  compare_command->add_option("NETWORK", compared->network, "Network file of train")->required();
  compare_command->add_option("RUN", compared->runs, "Runs to compare with")->required();
  compare_command->add_option("--beside", compared->beside, "Another network file to compare")
      ->type_name("FILE")
      ->one_value_each();
  add_number(*compare_command, "--from", compared->from,
             "Time to skip at the start of each run [s]", {0.0, 1e6});
  add_number(*compare_command, "--seconds", compared->seconds,
             "Duration to compare of each run [s]", {0.1, 1e6});
  compare_command
      ->add_option("--pictures", compared->pictures,
                   "Output folder for pictures of the height change")
      ->type_name("FOLDER");
  compare_command->callback(
      [compared, &program] { program.action = [compared] { return run_compare(*compared); }; });
}

}  // namespace screed
