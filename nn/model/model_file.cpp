// A list of numbers is written on one line, so that a model's difference to another can be read.
#include "nn/model/model_file.h"

#include <algorithm>
#include <cctype>
#include <cfloat>
#include <cstdio>
#include <limits>
#include <optional>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/json_reader.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

constexpr const char* kModelFormat = "screed-network-model";
constexpr std::size_t kMaxNetworks = 64;
constexpr std::size_t kMaxLayers = 255;

template <class T>
std::vector<T> integers(const JsonValue& list, std::size_t count) {
  std::vector<T> result;
  result.reserve(count);
  for (const JsonValue& value : list.list(count, count)) {
    result.push_back(static_cast<T>(
        value.integer(std::numeric_limits<T>::min(), std::numeric_limits<T>::max())));
  }
  return result;
}

std::vector<double> doubles(const JsonValue& list, std::size_t count) {
  std::vector<double> result;
  result.reserve(count);
  for (const JsonValue& value : list.list(count, count)) {
    result.push_back(value.number(-DBL_MAX, DBL_MAX));
  }
  return result;
}

std::string not_empty(const JsonValue& value) {
  std::string text = value.text();
  if (text.empty()) value.refuse("an empty text; allowed is a name");
  return text;
}

std::vector<ModelChannel> channels(const JsonValue& list, std::size_t count, bool output) {
  std::vector<ModelChannel> result;
  for (const JsonValue& value : list.list(count, count)) {
    if (output) {
      value.only({"feature", "middle", "half_range", "baseline"});
    } else {
      value.only({"feature", "middle", "half_range"});
    }
    ModelChannel channel;
    channel.feature = not_empty(value.at("feature"));
    channel.middle = value.at("middle").number(-DBL_MAX, DBL_MAX);
    channel.half_range = value.at("half_range").number(DBL_MIN, DBL_MAX);
    if (value.has("baseline")) channel.baseline = not_empty(value.at("baseline"));
    result.push_back(channel);
  }
  return result;
}

IntegerNetwork integer_network(const JsonValue& list) {
  std::vector<IntegerLayer> layers;
  for (const JsonValue& value : list.list(1, kMaxLayers)) {
    value.only({"inputs", "outputs", "activation", "gain_shift", "weights", "bias"});
    IntegerLayer layer;
    layer.inputs = static_cast<std::uint8_t>(value.at("inputs").integer(1, kMaxInputs));
    layer.outputs = static_cast<std::uint8_t>(value.at("outputs").integer(1, kMaxInputs));
    layer.linear = value.at("activation").one_of({"tanh", "linear"}) == "linear";
    layer.gain_shift = static_cast<std::uint8_t>(value.at("gain_shift").integer(0, kMaxGainShift));
    for (const JsonValue& row : value.at("weights").list(layer.outputs, layer.outputs)) {
      const auto weights = integers<std::int16_t>(row, layer.inputs);
      layer.weights.insert(layer.weights.end(), weights.begin(), weights.end());
    }
    layer.bias = integers<std::int32_t>(value.at("bias"), layer.outputs);
    layers.push_back(std::move(layer));
  }
  try {
    return IntegerNetwork(std::move(layers));
  } catch (const InputError& error) {
    list.refuse(error.what());
  }
}

std::vector<FloatLayer> trained_layers(const JsonValue& list, const IntegerNetwork& network) {
  std::vector<FloatLayer> layers;
  for (const JsonValue& value : list.list(network.layers().size(), network.layers().size())) {
    value.only({"weights", "bias"});
    const IntegerLayer& integer = network.layers()[layers.size()];
    FloatLayer layer{integer.inputs, integer.outputs, integer.linear, {}, {}};
    for (const JsonValue& row : value.at("weights").list(layer.outputs, layer.outputs)) {
      const std::vector<double> weights = doubles(row, layer.inputs);
      layer.weights.insert(layer.weights.end(), weights.begin(), weights.end());
    }
    layer.bias = doubles(value.at("bias"), layer.outputs);
    layers.push_back(std::move(layer));
  }
  return layers;
}

std::vector<GoldenVector> checked_golden(const JsonValue& list, const IntegerNetwork& network) {
  std::vector<GoldenVector> vectors;
  std::vector<std::int16_t> out(network.outputs());
  for (const JsonValue& value : list.list(1)) {
    value.only({"in", "out"});
    GoldenVector vector{integers<std::int16_t>(value.at("in"), network.inputs()),
                        integers<std::int16_t>(value.at("out"), network.outputs())};
    network.run(vector.in, out);
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (out[i] != vector.out[i]) {
        value.at("out").refuse("the network gives " + std::to_string(out[i]) + " as output " +
                               std::to_string(i + 1) + " where the file says " +
                               std::to_string(vector.out[i]) +
                               "; they must be equal (the file was changed or damaged)");
      }
    }
    vectors.push_back(std::move(vector));
  }
  return vectors;
}

ModelNetwork model_network(const JsonValue& value) {
  value.only({"inputs", "outputs", "layers", "trained", "golden"});
  IntegerNetwork network = integer_network(value.at("layers"));
  ModelNetwork result{channels(value.at("inputs"), network.inputs(), false),
                      channels(value.at("outputs"), network.outputs(), true),
                      network,
                      {},
                      checked_golden(value.at("golden"), network)};
  if (value.has("trained")) result.trained = trained_layers(value.at("trained"), network);
  return result;
}

std::vector<PreprocessingStage> stages_of(const JsonValue& list) {
  std::vector<PreprocessingStage> stages;
  for (const JsonValue& value : list.list()) {
    value.only({"stage", "feature", "low", "high", "value", "run_time"});
    PreprocessingStage stage;
    stage.stage = not_empty(value.at("stage"));
    if (value.has("feature")) {
      stage.feature = not_empty(value.at("feature"));
      stage.low = value.at("low").number(-DBL_MAX, DBL_MAX);
      stage.high = value.at("high").number(stage.low, DBL_MAX);
    }
    if (value.has("value")) stage.value = value.at("value").number(-DBL_MAX, DBL_MAX);
    stage.run_time = value.at("run_time").flag();
    stages.push_back(stage);
  }
  return stages;
}

Model model_of(const JsonValue& root) {
  if (!root.has("format") || root.at("format").text() != kModelFormat) {
    root.refuse(std::string("is no network model; allowed is a file with \"format\": \"") +
                kModelFormat + "\"");
  }
  root.at("format_version").integer(1, kModelFormatVersion);
  root.only({"format", "format_version", "name", "description", "seed", "training_data", "stages",
             "networks"});
  Model model;
  model.name = not_empty(root.at("name"));
  model.description = root.at("description").text();
  model.seed = root.at("seed").unsigned_integer();
  model.training_data = root.at("training_data").text();
  model.stages = stages_of(root.at("stages"));
  for (const JsonValue& value : root.at("networks").list(1, kMaxNetworks)) {
    model.networks.push_back(model_network(value));
  }
  return model;
}

// ---- writing

Json stage_json(const PreprocessingStage& stage) {
  Json json = {{"stage", stage.stage}};
  if (!stage.feature.empty()) {
    json["feature"] = stage.feature;
    json["low"] = stage.low;
    json["high"] = stage.high;
  } else if (stage.value != 0.0) {
    json["value"] = stage.value;
  }
  json["run_time"] = stage.run_time;
  return json;
}

template <class T>
Json rows(const std::vector<T>& weights, std::size_t inputs) {
  Json result = Json::array();
  for (std::size_t first = 0; first < weights.size(); first += inputs) {
    const auto begin = weights.begin() + static_cast<std::ptrdiff_t>(first);
    result.push_back(std::vector<T>(begin, begin + static_cast<std::ptrdiff_t>(inputs)));
  }
  return result;
}

Json channels_json(const std::vector<ModelChannel>& channels) {
  Json result = Json::array();
  for (const ModelChannel& channel : channels) {
    Json one = {{"feature", channel.feature},
                {"middle", channel.middle},
                {"half_range", channel.half_range}};
    if (!channel.baseline.empty()) one["baseline"] = channel.baseline;
    result.push_back(one);
  }
  return result;
}

Json network_json(const ModelNetwork& network) {
  Json layers = Json::array();
  for (const IntegerLayer& layer : network.network.layers()) {
    layers.push_back({{"inputs", layer.inputs},
                      {"outputs", layer.outputs},
                      {"activation", layer.linear ? "linear" : "tanh"},
                      {"gain_shift", layer.gain_shift},
                      {"weights", rows(layer.weights, layer.inputs)},
                      {"bias", layer.bias}});
  }
  Json result = {{"inputs", channels_json(network.inputs)},
                 {"outputs", channels_json(network.outputs)},
                 {"layers", layers}};
  if (!network.trained.empty()) {
    Json trained = Json::array();
    for (const FloatLayer& layer : network.trained) {
      trained.push_back({{"weights", rows(layer.weights, layer.inputs)}, {"bias", layer.bias}});
    }
    result["trained"] = trained;
  }
  Json golden = Json::array();
  for (const GoldenVector& vector : network.golden) {
    golden.push_back({{"in", vector.in}, {"out", vector.out}});
  }
  result["golden"] = golden;
  return result;
}

/// Holds no list, on no level.
bool is_flat(const Json& value) {
  const auto fits = [](const Json& inner) { return !inner.is_array() && is_flat(inner); };
  if (value.is_array()) return std::all_of(value.begin(), value.end(), fits);
  if (!value.is_object()) return true;
  return std::all_of(value.items().begin(), value.items().end(),
                     [&](const Json::Member& member) { return fits(member.value); });
}

/// Like dump(2), but with innermost lists and objects, and golden vectors, on one line.
void put(std::string& text, const Json& value, const std::string& indent) {
  const bool golden = value.is_object() && value.size() == 2 && value.contains("in");
  if (!value.is_structured() || is_flat(value) || golden) {
    text += value.dump();
    return;
  }
  const std::string inner = indent + " ";
  text += value.is_array() ? "[" : "{";
  bool first = true;
  const auto begin_line = [&] {
    text += (first ? "\n" : ",\n") + inner;
    first = false;
  };
  if (value.is_array()) {
    for (const Json& element : value) {
      begin_line();
      put(text, element, inner);
    }
  } else {
    for (const auto& [name, element] : value.items()) {
      begin_line();
      text += Json(name).dump() + ": ";
      put(text, element, inner);
    }
  }
  text += "\n" + indent + (value.is_array() ? "]" : "}");
}

}  // namespace

std::vector<GoldenVector> golden_vectors(const IntegerNetwork& network, std::size_t count,
                                         std::uint64_t seed) {
  WorldRandom random(seed, "golden vectors");
  std::vector<GoldenVector> vectors;
  const auto add = [&](auto&& value) {
    GoldenVector vector;
    for (std::size_t i = 0; i < network.inputs(); ++i) vector.in.push_back(value());
    vector.out.resize(network.outputs());
    network.run(vector.in, vector.out);
    vectors.push_back(std::move(vector));
  };
  for (const int edge : {INT16_MIN, -1, 0, INT16_MAX}) {
    add([&] { return static_cast<std::int16_t>(edge); });
  }
  for (std::size_t i = 0; i < count; ++i) {
    add([&] { return static_cast<std::int16_t>(random.next() >> 16U); });
  }
  return vectors;
}

Model parse_model(const std::string& text, const std::string& name) {
  const Json json = read_json_text(text, name);
  return model_of(JsonValue(json, name));
}

Model read_model(const std::filesystem::path& file) {
  const Json json = read_json_file(file);
  return model_of(JsonValue(json, file.string()));
}

std::string model_text(const Model& model) {
  Json stages = Json::array();
  for (const PreprocessingStage& stage : model.stages) stages.push_back(stage_json(stage));
  Json networks = Json::array();
  for (const ModelNetwork& network : model.networks) networks.push_back(network_json(network));
  const Json root = {{"format", kModelFormat}, {"format_version", kModelFormatVersion},
                     {"name", model.name},     {"description", model.description},
                     {"seed", model.seed},     {"training_data", model.training_data},
                     {"stages", stages},       {"networks", networks}};
  std::string text;
  put(text, root, "");
  return text + "\n";
}

void write_model(const std::filesystem::path& file, const Model& model) {
  write_file(file, model_text(model));
}

// ---- the text of a header for the robot

namespace {

/// A name that C++ allows.
std::string identifier(const std::string& name) {
  std::string result;
  for (const char c : name) {
    result += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return result.empty() || std::isdigit(static_cast<unsigned char>(result[0])) != 0 ? "m" + result
                                                                                    : result;
}

template <class T>
void put_array(std::string& text, const char* type, const std::string& name,
               const std::vector<T>& values) {
  text += std::string("const ") + type + " " + name + "[] SCREED_PROGRAM_MEMORY = {";
  constexpr std::size_t kInALine = 16;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += i % kInALine == 0 ? "\n    " : " ";
    text += std::to_string(values[i]) + ",";
  }
  text += "\n};\n";
}

std::string scale(const ModelChannel& channel) {
  char numbers[80];
  std::snprintf(numbers, sizeof numbers, " = %.9g + %.9g (q + 1/2) / 2^15", channel.middle,
                channel.half_range);
  std::string text = channel.feature + numbers;
  if (!channel.baseline.empty()) text += " + " + channel.baseline;
  return text;
}

void put_network(std::string& text, const ModelNetwork& network) {
  std::string name;
  for (const ModelChannel& output : network.outputs) {
    name += (name.empty() ? "" : "_") + identifier(output.feature);
  }
  const IntegerNetwork& integers = network.network;
  std::vector<std::uint8_t> parameters;
  std::vector<std::size_t> begins;
  std::size_t widest = 0;
  for (std::size_t i = 0; i < integers.layers().size(); ++i) {
    begins.push_back(parameters.size());
    const std::vector<std::uint8_t>& layer = integers.parameters(i);
    parameters.insert(parameters.end(), layer.begin(), layer.end());
    widest = std::max<std::size_t>(widest, integers.layers()[i].outputs);
  }
  put_array(text, "uint8_t", name + "_parameters", parameters);
  text += "\n";
  for (const ModelChannel& input : network.inputs) text += "/// in:  " + scale(input) + "\n";
  for (const ModelChannel& output : network.outputs) text += "/// out: " + scale(output) + "\n";
  text += "inline void run_" + name + "(const int16_t* in, int16_t* out) {\n";
  const bool deep = integers.layers().size() > 1;
  const std::string width = std::to_string(widest);
  if (deep) text += "  int16_t a[" + width + "];\n";
  if (integers.layers().size() > 2) text += "  int16_t b[" + width + "];\n";
  std::string from = "in";
  for (std::size_t i = 0; i < integers.layers().size(); ++i) {
    const DenseShape shape = integers.layers()[i].shape();
    const std::string to = i + 1 == integers.layers().size() ? "out" : from == "a" ? "b" : "a";
    char call[80];
    std::snprintf(call, sizeof call, "  dense<%d, %d, %d>(", shape.inputs, shape.outputs,
                  shape.mode);
    text.append(call).append(name).append("_parameters + ").append(std::to_string(begins[i]));
    text.append(", ").append(from).append(", ").append(to).append(");\n");
    from = to;
  }
  text += "}\n\n";

  const auto number = [&](const std::string& what, std::size_t value) {
    text += "constexpr uint8_t k_" + name + "_" + what + " = " + std::to_string(value) + ";\n";
  };
  number("inputs", integers.inputs());
  number("outputs", integers.outputs());
  number("golden_vectors", network.golden.size());
  std::vector<std::int16_t> in;
  std::vector<std::int16_t> out;
  for (const GoldenVector& vector : network.golden) {
    in.insert(in.end(), vector.in.begin(), vector.in.end());
    out.insert(out.end(), vector.out.begin(), vector.out.end());
  }
  put_array(text, "int16_t", name + "_golden_in", in);
  put_array(text, "int16_t", name + "_golden_out", out);
  text += "\n";
}

}  // namespace

std::string model_header(const Model& model) {
  std::string text = "// Model " + model.name + ": " + model.description +
                     "\n// Written by `screed nn export`; training data " + model.training_data +
                     ", seed " + std::to_string(model.seed) +
                     ".\n#pragma once\n\n// clang-format off\n#include \"nn/infer/dense.h\"\n"
                     "#include \"hal/program_memory.h\"\n\n"
                     "namespace screed {\nnamespace nn {\nnamespace model_" +
                     identifier(model.name) + " {\n\n";
  for (const ModelNetwork& network : model.networks) put_network(text, network);
  return text + "}  // namespace model_" + identifier(model.name) +
         "\n}  // namespace nn\n}  // namespace screed\n";
}

}  // namespace screed::nn
