// `screed terrain-net`: trains networks that predict what the robot does to the terrain, and
// compares them with recorded runs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"
#include "nn/terrain/bearing_capacity_trainer.h"
#include "nn/terrain/flux_network.h"
#include "nn/terrain/flux_trainer.h"
#include "nn/terrain/sinkage_replay.h"
#include "nn/terrain/terrain_comparison.h"
#include "nn/terrain/window_network.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/task_bar.h"
#include "tools/screed/viewer/camera.h"
#include "tools/screed/viewer/pixel_drawing.h"
#include "tools/screed/viewer/terrain_image.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct TrainOptions {
  std::vector<std::string> runs;
  std::string out = "flux.json";
  std::size_t hidden = 32;
  std::size_t every = 3;
  std::size_t epochs = 10;
  std::uint64_t seed = 1;
};

struct TrainTracksOptions {
  std::vector<std::string> runs;
  std::vector<std::string> test;
  std::string out = "tracks.json";
  std::size_t hidden = 4;
  std::size_t segments = 4;
  double seconds = 10.0;
  std::size_t generations = 75;
  std::uint64_t seed = 1;
};

struct CompareOptions {
  std::string network;
  std::vector<std::string> runs;
  std::vector<std::string> window;
  std::size_t epochs = 10;
  double from = 0.0;
  double seconds = 40.0;
  std::string pictures;
};

void print_epoch(std::size_t epoch, double mse_mm2) {
  std::cerr << "epoch " << epoch + 1 << ": " << mse_mm2 << " mm^2\n";
}

int run_train(const TrainOptions& options) {
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

using Segments = std::vector<std::vector<nn::DriveSegment>>;

Segments segments_of(const std::vector<std::string>& runs, const TrainTracksOptions& options) {
  Segments drives;
  for (const std::string& run : runs) {
    drives.push_back(nn::segments_of(nn::DriveStrides(run), options.segments, options.seconds));
  }
  return drives;
}

/// The middle one of each drive's errors: in some segments a robot rocks, and nobody can tell.
void print_errors(const std::vector<std::string>& runs, const Segments& drives,
                  const nn::BearingCapacityNetwork& network) {
  const auto middle = [](const std::vector<nn::DriveSegment>& segments,
                         const nn::BearingCapacityNetwork* by) {
    std::vector<double> shares;
    shares.reserve(segments.size());
    for (const nn::DriveSegment& segment : segments) shares.push_back(relative_error(segment, by));
    std::sort(shares.begin(), shares.end());
    return 0.5 * (shares[(shares.size() - 1) / 2] + shares[shares.size() / 2]);
  };
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (drives[i].empty()) continue;
    std::printf("  %-40s %8.3f %8.3f\n", fs::path(runs[i]).filename().c_str(),
                middle(drives[i], nullptr), middle(drives[i], &network));
  }
}

int run_train_tracks(const TrainTracksOptions& options) {
  const Segments drives = segments_of(options.runs, options);
  const Segments tests = segments_of(options.test, options);
  nn::BearingCapacityNetwork network(options.hidden, options.seed);
  std::cerr << network.weights().size() << " weights\n";
  train(network, drives, options.generations, options.seed,
        [](std::size_t generation, double error) {
          std::cerr << "generation " << generation + 1 << ": " << error << "\n";
        });
  network.write(options.out);
  std::printf("%s\nsquared error over that of no change at all, median of the segments\n",
              options.out.c_str());
  std::printf("  %-40s %8s %8s\n", "", "closed", "network");
  print_errors(options.runs, drives, network);
  print_errors(options.test, tests, network);
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

/// One of the two that `compare` takes.
struct AnyNetwork {
  std::string file;
  std::shared_ptr<const nn::FluxNetwork> wheels;
  std::shared_ptr<const nn::BearingCapacityNetwork> tracks;
};

AnyNetwork read_network(const std::string& file) {
  AnyNetwork network{file, nullptr, nullptr};
  try {
    network.wheels = std::make_shared<const nn::FluxNetwork>(nn::FluxNetwork::read(file));
    return network;
  } catch (const InputError&) {  // then it may be the other kind
  }
  try {
    network.tracks =
        std::make_shared<const nn::BearingCapacityNetwork>(nn::BearingCapacityNetwork::read(file));
    return network;
  } catch (const InputError&) {
    throw InputError(file + ": is neither a network of `train` (wheels) nor one of `train-tracks`");
  }
}

/// A terrain that a network changes along a drive.
struct Prediction {
  std::string name;
  std::function<void(std::size_t stride)> step;
  std::function<const HeightField&()> ground;
};

void compare_on(const std::string& run, const CompareOptions& options, const AnyNetwork& any,
                const nn::WindowNetwork* window, TaskBar& bar) {
  const TaskProgress progress = bar.progress();
  const nn::DriveStrides drive(run);
  if (drive.tracks() ? any.tracks == nullptr : any.wheels == nullptr) {
    throw InputError(any.file + ": is a network of " + (drive.tracks() ? "wheels; " : "tracks; ") +
                     run + (drive.tracks() ? " was driven on tracks" : " was driven on wheels"));
  }
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
  const auto add_tracks = [&](const std::string& name,
                              const std::shared_ptr<nn::TrackSoilModel>& on,
                              const std::function<void(nn::TrackSoilModel&, std::size_t)>& step) {
    all.push_back({name, [on, step](std::size_t i) { step(*on, i); },
                   [on]() -> const HeightField& { return on->surface(); }});
  };
  if (drive.tracks()) {
    const auto& network = any.tracks;
    nn::SinkageReplay pressed(drive);
    const nn::TrackSoilModel& as_it_was = pressed.after(begin, progress);
    const auto fresh = [&] { return std::make_shared<nn::TrackSoilModel>(as_it_was); };
    add_tracks("even depth", fresh(),
               [&](nn::TrackSoilModel& on, std::size_t i) { on.step_evenly(drive[i]); });
    add_tracks("closed", fresh(),
               [&](nn::TrackSoilModel& on, std::size_t i) { on.step(drive[i], nullptr); });
    add_tracks("network", fresh(), [&, network](nn::TrackSoilModel& on, std::size_t i) {
      on.step(drive[i], network.get());
    });
    const TrackGeometry tracks = track_geometry(drive.robot());
    add_tracks("true stance", fresh(), [&, tracks](nn::TrackSoilModel& on, std::size_t i) {
      on.step_at(drive[i], track_plane_of(tracks, drive[i]));
    });
  } else {
    const auto& network = any.wheels;
    const auto ground = std::make_shared<HeightField>(before);
    all.push_back({"fluxes",
                   [&drive, network, ground](std::size_t i) {
                     network->apply(*ground, drive.wheels(), drive[i]);
                   },
                   [ground]() -> const HeightField& { return *ground; }});
  }
  if (window != nullptr) {
    const auto ground = std::make_shared<HeightField>(before);
    const auto last = std::make_shared<std::vector<float>>(nn::WindowNetwork::kCells);
    all.push_back(
        {"window",
         [&drive, window, ground, last](std::size_t i) { window->apply(*ground, drive[i], *last); },
         [ground]() -> const HeightField& { return *ground; }});
  }

  std::vector<nn::Stride> path;
  for (std::size_t i = begin; i < end; ++i) {
    report_progress(progress, "predicting", i - begin, end - begin);
    path.push_back(drive[i]);
    for (const Prediction& one : all) one.step(i);
  }
  bar.clear();
  const nn::TerrainComparison c = nn::compare(before, real, real);
  std::printf("%s: %zu strides, touched %.3f m^2, changed there by %.3f mm RMS\n", run.c_str(),
              path.size(), c.touched_m2, c.true_change_mm);
  std::printf("  %-11s %12s %12s %12s %12s %14s %8s\n", "", "RMSE mm", "outside mm", "moved cm3",
              "volume cm3", "volume units", "ruts");
  print_row("recorded", before, real, real, path);
  print_row("no change", before, real, before, path);
  for (const Prediction& one : all) print_row(one.name, before, real, one.ground(), path);
  if (options.pictures.empty()) return;
  fs::create_directories(options.pictures);
  std::vector<std::pair<std::string, const HeightField*>> grounds = {{"recorded", &real}};
  for (const Prediction& one : all) {
    if (one.name != "true stance") grounds.emplace_back(one.name, &one.ground());
  }
  draw_changes(fs::path(options.pictures) / (fs::path(run).filename().string() + ".png"), before,
               grounds, path);
}

int run_compare(const CompareOptions& options) {
  const AnyNetwork network = read_network(options.network);
  std::unique_ptr<nn::WindowNetwork> window;
  if (!options.window.empty()) {
    std::vector<std::unique_ptr<nn::DriveStrides>> drives;
    std::vector<const nn::DriveStrides*> pointers;
    for (const std::string& run : options.window) {
      drives.push_back(std::make_unique<nn::DriveStrides>(run));
      pointers.push_back(drives.back().get());
    }
    constexpr std::uint64_t kSeed = 1;
    window = std::make_unique<nn::WindowNetwork>(pointers, options.epochs, kSeed, print_epoch);
  }
  const CatchInterrupts signals;
  for (const std::string& run : options.runs) {
    TaskBar bar(false, fs::path(run).filename().string() + ": ");
    compare_on(run, options, network, window.get(), bar);
  }
  return 0;
}

}  // namespace

void register_terrain_net_command(CLI::App& root, Program& program) {
  CLI::App* command = root.add_subcommand("terrain-net",
                                          "Train and compare networks that predict how wheels and "
                                          "tracks deform the terrain (thesis 6.3.1)");
  command->require_subcommand(1);

  const auto train = std::make_shared<TrainOptions>();
  CLI::App* train_command =
      command->add_subcommand("train", "Train a flux network on recorded runs with wheels");
  train_command->add_option("RUN", train->runs, "Runs with recorded heights")->required();
  train_command->add_option("--out", train->out, "Network file to write")
      ->type_name("FILE")
      ->capture_default_str();
  add_number(*train_command, "--hidden", train->hidden, "Number of nodes of the hidden layer",
             {1, 512});
  add_number(*train_command, "--every", train->every, "Use every n-th stride as an example",
             {1, 1000});
  add_number(*train_command, "--epochs", train->epochs, "Number of epochs", {1, 1e6});
  add_number(*train_command, "--seed", train->seed, "Seed of the training", kSeedRange);
  train_command->callback(
      [train, &program] { program.action = [train] { return run_train(*train); }; });

  const auto tracks = std::make_shared<TrainTracksOptions>();
  CLI::App* tracks_command = command->add_subcommand(
      "train-tracks", "Train a bearing-capacity network for tracks on recorded runs on soil");
  tracks_command->add_option("RUN", tracks->runs, "Runs with recorded heights")->required();
  tracks_command->add_option("--test", tracks->test, "Run to test the network on")
      ->type_name("FOLDER")
      ->type_size(1)
      ->allow_extra_args(false);
  tracks_command->add_option("--out", tracks->out, "Network file to write")
      ->type_name("FILE")
      ->capture_default_str();
  add_number(*tracks_command, "--hidden", tracks->hidden, "Number of nodes of the hidden layer",
             {1, 256});
  add_number(*tracks_command, "--segments", tracks->segments, "Number of segments of each run",
             {1, 1000});
  add_number(*tracks_command, "--seconds", tracks->seconds, "Duration of each segment [s]",
             {0.5, 1000.0});
  add_number(*tracks_command, "--generations", tracks->generations, "Number of generations",
             {1, 1e6});
  add_number(*tracks_command, "--seed", tracks->seed, "Seed of the training", kSeedRange);
  tracks_command->callback(
      [tracks, &program] { program.action = [tracks] { return run_train_tracks(*tracks); }; });

  const auto compared = std::make_shared<CompareOptions>();
  CLI::App* compare_command = command->add_subcommand(
      "compare", "Compare terrain deformed by networks with recorded drives");
  compare_command
      ->add_option(
          "NETWORK", compared->network,
          "Network file: of train for runs with wheels, of train-tracks for runs with tracks")
      ->required();
  compare_command->add_option("RUN", compared->runs, "Runs to compare with")->required();
  compare_command
      ->add_option("--window", compared->window,
                   "Also train the thesis' network on this run and compare it")
      ->type_name("FOLDER")
      ->type_size(1)
      ->allow_extra_args(false);
  add_number(*compare_command, "--epochs", compared->epochs, "Number of epochs of that training",
             {1, 1e6});
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
