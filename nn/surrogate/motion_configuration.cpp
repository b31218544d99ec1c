#include "nn/surrogate/motion_configuration.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json_reader.h"
#include "nn/data/feature_table.h"

namespace screed::nn {
namespace {

constexpr std::size_t kGoldenVectors = 32;
constexpr std::size_t kMotions = 3;

std::vector<std::string> names_of(const JsonValue& list) {
  std::vector<std::string> names;
  for (const JsonValue& value : list.list(1)) names.push_back(value.text());
  return names;
}

std::vector<ModelChannel> channels_of(const JsonValue& list, bool output) {
  std::vector<ModelChannel> channels;
  for (const JsonValue& value : list.list(1, 255)) {
    if (output) {
      value.only({"feature", "half_range", "baseline"});
    } else {
      value.only({"feature", "middle", "half_range"});
    }
    ModelChannel channel;
    channel.feature = value.at("feature").text();
    if (value.has("middle")) channel.middle = value.at("middle").number(-1e9, 1e9);
    channel.half_range = value.at("half_range").number(1e-12, 1e9);
    if (output) {
      channel.baseline =
          value.has("baseline") ? value.at("baseline").text() : channel.feature + "@1";
    }
    channels.push_back(channel);
  }
  return channels;
}

std::array<double, kMotions> as_array(const FrameMotion& motion) {
  return {motion.forward_m, motion.sideways_m, motion.turn_rad};
}

/// Of predicted against real motions, frame 2 being the first.
template <class Predict>
std::array<double, kMotions> r2_of(const MotionSeries& series, Predict predict) {
  std::array<double, kMotions> mean{};
  std::array<double, kMotions> wrong{};
  std::array<double, kMotions> spread{};
  const auto count = static_cast<double>(series.frames.size() - 2);
  for (std::size_t k = 2; k < series.frames.size(); ++k) {
    for (std::size_t m = 0; m < kMotions; ++m) {
      mean.at(m) += as_array(series.frames[k].motion).at(m) / count;
    }
  }
  for (std::size_t k = 2; k < series.frames.size(); ++k) {
    const std::array<double, kMotions> real = as_array(series.frames[k].motion);
    const std::array<double, kMotions> predicted = as_array(predict(k));
    for (std::size_t m = 0; m < kMotions; ++m) {
      wrong.at(m) += (predicted.at(m) - real.at(m)) * (predicted.at(m) - real.at(m));
      spread.at(m) += (real.at(m) - mean.at(m)) * (real.at(m) - mean.at(m));
    }
  }
  std::array<double, kMotions> r2{};
  for (std::size_t m = 0; m < kMotions; ++m) r2.at(m) = 1.0 - wrong.at(m) / spread.at(m);
  return r2;
}

}  // namespace

MotionConfiguration read_motion_configuration(const std::filesystem::path& file) {
  const nlohmann::json json = read_json_file(file);
  const JsonValue root(json, file.string());
  root.only({"name", "about", "seed", "train", "test", "inputs", "outputs", "hidden", "window",
             "batch", "steps", "learning_rate", "frame_weight", "mean_weight", "mean_knee",
             "mirror"});
  MotionConfiguration result;
  result.name = root.at("name").text();
  result.about = root.at("about").text();
  result.train = names_of(root.at("train"));
  result.test = names_of(root.at("test"));
  MotionTraining& training = result.training;
  training.seed = root.at("seed").unsigned_integer();
  training.inputs = channels_of(root.at("inputs"), false);
  training.outputs = channels_of(root.at("outputs"), true);
  training.hidden.clear();
  for (const JsonValue& value : root.at("hidden").list(1, 8)) {
    training.hidden.push_back(static_cast<std::size_t>(value.integer(1, 255)));
  }
  training.window = static_cast<std::size_t>(root.at("window").integer(1, 10000));
  training.batch = static_cast<std::size_t>(root.at("batch").integer(1, 10000));
  training.steps = static_cast<std::size_t>(root.at("steps").integer(1, 10000000));
  training.learning_rate = root.at("learning_rate").number(1e-9, 1.0);
  if (root.has("frame_weight")) training.frame_weight = root.at("frame_weight").number(0.0, 1e6);
  training.mean_weight = root.at("mean_weight").number(0.0, 1e6);
  if (root.has("mean_knee")) training.mean_knee = root.at("mean_knee").number(1e-9, 1e6);
  if (root.has("mirror")) training.mirror = root.at("mirror").flag();
  return result;
}

std::vector<MotionSeries> read_motion_sessions(const std::filesystem::path& folder,
                                               const std::vector<std::string>& names) {
  std::vector<MotionSeries> series;
  series.reserve(names.size());
  for (const std::string& name : names) {
    series.push_back(read_motion_series(find_session(folder, name).parent_path()));
  }
  return series;
}

Model motion_model(const MotionConfiguration& configuration, const MotionTrainer& trainer,
                   const std::vector<MotionSeries>& series) {
  ContentHash hash;
  for (const MotionSeries& one : series) hash.add(one.content_hash);
  Model model;
  model.name = configuration.name;
  model.description = configuration.about;
  model.seed = configuration.training.seed;
  model.training_data = hash.hex();
  const std::vector<FloatLayer> layers = trainer.layers();
  const IntegerNetwork network = quantise(layers);
  model.networks.push_back({configuration.training.inputs, configuration.training.outputs, network,
                            layers,
                            golden_vectors(network, kGoldenVectors, configuration.training.seed)});
  return model;
}

std::array<double, 3> one_frame_r2(const Model& model, const MotionSeries& series) {
  // Every frame is a robot of its own, on ground of the frame's inclination.
  Surrogate robot(model, SupportGeometry{}, 1);
  robot.set_soil(0, series.soil);
  return r2_of(series, [&](std::size_t k) {
    const MotionFrame& now = series.frames[k];
    const MotionFrame& before = series.frames[k - 1];
    robot.set_pose(0, {}, before.motion, series.frames[k - 2].motion);
    robot.set_tracks(0, before.track_left_m_per_s, before.track_right_m_per_s);
    robot.step_on_slope(now.pitch, now.roll, {&now.track_left_m_per_s, 1},
                        {&now.track_right_m_per_s, 1});
    return robot.motion(0);
  });
}

std::array<double, 3> unchanged_r2(const MotionSeries& series) {
  return r2_of(series, [&](std::size_t k) { return series.frames[k - 1].motion; });
}

}  // namespace screed::nn
