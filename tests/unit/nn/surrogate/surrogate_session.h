// Sessions in which a surrogate stands in for the physics: what a rollout of the same surrogate has
// to follow.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/world/world_setup.h"
#include "nn/surrogate/surrogate_plant.h"
#include "tests/unit/nn/surrogate/made_up_drive.h"

namespace screed::nn {

/// What `screed sim` records of a surrogate: Algorithm 5 on a level bed whose edges nothing stops
/// at, five seconds until it begins included. `more` are further lines of the experiment.
inline void record_surrogate(const fs::path& folder, const Surrogate& driven, std::size_t rows,
                             const std::string& more = "",
                             const std::string& board = kDefaultBoard) {
  fs::create_directories(folder);
  write_text(folder / "experiment.ini",
             "[map]\nmodel = scm\nsize = 2\nedges = open\n[soil]\npreset = soft\ncell = 0.02\n"
             "[experiment]\nname = made_up\nalgorithm = training_drive\nframes = 3200\n" +
                 more);
  const Experiment experiment = read_experiment(folder / "experiment.ini");
  const auto environment = [&](HeightField terrain, const Assembly& model,
                               const PlantOptions& options) {
    return std::make_unique<SurrogatePlant>(std::move(terrain), model, options, driven);
  };
  const auto world = make_world(experiment, {.board = board, .environment = environment});
  SessionInfo info;
  info.experiment_name = experiment.experiment.name;
  info.experiment_text = experiment.text();
  info.seed = experiment.experiment.seed;
  info.board_name = board;
  info.board = board_constants_of(board);
  info.parameters = experiment.parameters;
  info.credentials = credentials_of(experiment);
  SessionWriter writer(folder / "session.h5", info);
  writer.record_heights(map_of(world->terrain()).view());
  HeightWatch watch(world->terrain());
  FrameRecorder frames;
  for (std::size_t row = 0; row < rows; ++row) {
    world->advance();
    const SimFrame frame =
        frames.record(world->plant().time_s(), world->plant().robot(0), world->firmware());
    writer.append(frame, world->sample(), world->output(), watch.changes(world->terrain()));
  }
  writer.finish();
}

}  // namespace screed::nn
