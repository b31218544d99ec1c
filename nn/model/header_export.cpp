// Text of a header.
#include "nn/model/header_export.h"

#include <cctype>
#include <cstdio>

namespace screed::nn {
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
