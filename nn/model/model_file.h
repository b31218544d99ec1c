// A trained model: networks in integers with the names and scales of their inputs and outputs, as a
// JSON file (docs/networks.md). Knows features and stages by their names only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nn/model/quantiser.h"

namespace screed::nn {

constexpr int kModelFormatVersion = 1;

/// An input or output: which feature it is, and value = middle + half_range * activation.
struct ModelChannel {
  std::string feature;  ///< a name of nn/data/features.h, of any spelling as far as the file goes
  double middle = 0.0;
  double half_range = 1.0;  ///< > 0
  /// Of an output: the feature that the network's result is added to; empty: none.
  std::string baseline;

  /// Values beyond the range become its ends.
  std::int16_t activation(double value) const {
    return to_activation((value - middle) / half_range);
  }
  double value(std::int16_t activation) const { return middle + half_range * to_value(activation); }
  /// Without rounding: for the network in floating point.
  double normalised(double value) const { return (value - middle) / half_range; }
};

/// Activations and what exactly the network makes of them.
struct GoldenVector {
  std::vector<std::int16_t> in;
  std::vector<std::int16_t> out;
};

struct ModelNetwork {
  std::vector<ModelChannel> inputs;
  std::vector<ModelChannel> outputs;
  IntegerNetwork network;
  std::vector<FloatLayer> trained;  ///< what it was quantised from; empty: not in the file
  std::vector<GoldenVector> golden;
};

/// A stage of the pre-processing (nn/data/preprocessing.h).
struct PreprocessingStage {
  std::string stage;
  std::string feature;  ///< of a stage that drops frames, else empty
  double low = 0.0;     ///< outside of which they are dropped: configured, or learned
  double high = 0.0;
  double value = 0.0;     ///< sigmas (not in a model's file), width, alpha or step
  bool run_time = false;  ///< a running world applies it to the inputs, in their order
};

struct Model {
  std::string name;
  std::string description;    ///< how it was made, one line
  std::uint64_t seed = 0;     ///< of the training
  std::string training_data;  ///< hash over what it was trained on
  /// In their order; "normalise" is the channels' scale.
  std::vector<PreprocessingStage> stages;
  std::vector<ModelNetwork> networks;
};

/// Makes the golden vectors of a network: the corners and `count` random vectors.
std::vector<GoldenVector> golden_vectors(const IntegerNetwork& network, std::size_t count,
                                         std::uint64_t seed);

/// Throws InputError, one line with file, place and what is allowed, when the file is no model, is
/// of a newer format, its numbers do not fit together, or a golden vector does not come out.
Model read_model(const std::filesystem::path& file);
/// The same from a text; messages call it `name`.
Model parse_model(const std::string& text, const std::string& name);

std::string model_text(const Model& model);
/// The file appears complete or not at all. Throws RunError when it cannot be written.
void write_model(const std::filesystem::path& file, const Model& model);

/// The text of a C++ header for the robot: parameters in program memory, and a function a network
/// that runs it through nn/infer, which is all it includes. Namespace screed::nn::model_<name>; for
/// each network the parameters, `run_<outputs>`, how inputs and outputs are scaled (in comments),
/// and the golden vectors.
std::string model_header(const Model& model);

}  // namespace screed::nn
