// A JSON file with a row of integers on a line.
#include "nn/slip/slip_model.h"

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/json_reader.h"

namespace screed::nn {
namespace {

constexpr const char* kSlipFormat = "screed-slip-model";
constexpr int kSlipVersion = 1;

struct Rows {
  const char* name;
  std::size_t begin;
  std::size_t count;
  std::size_t size;
};

std::vector<Rows> rows_of(const GatedShape& shape) {
  return {{"candidates", 0, shape.units, shape.row_size()},
          {"gates", shape.gates_begin(), shape.units, shape.row_size()},
          {"outputs", shape.outputs_begin(), shape.outputs, 1U + shape.units}};
}

std::string text_of(const SlipModel& model, std::size_t begin, std::size_t count,
                    const char* separator) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += (i == 0 ? "" : separator) + std::to_string(model.parameters[begin + i]);
  }
  return text;
}

}  // namespace

SlipModel read_slip_model(const std::filesystem::path& file) {
  const Json json = read_json_file(file);
  const JsonValue root(json, file.string());
  root.at("format").one_of({kSlipFormat});
  root.at("format_version").integer(kSlipVersion, kSlipVersion);
  root.only({"format", "format_version", "training_data", "seed", "inputs", "units", "slip",
             "stuck", "free", "candidates", "gates", "outputs"});
  SlipModel model;
  model.training_data = root.at("training_data").text();
  model.seed = root.at("seed").unsigned_integer();
  model.shape.inputs = static_cast<std::uint8_t>(root.at("inputs").integer(1, 100));
  model.shape.units = static_cast<std::uint8_t>(root.at("units").integer(1, 100));
  model.shape.outputs = static_cast<std::uint8_t>(root.at("outputs").list(1, 100).size());
  const auto threshold = [&](const char* name) {
    return static_cast<std::uint16_t>(root.at(name).integer(0, UINT16_MAX));
  };
  model.thresholds = {threshold("slip"), threshold("stuck"), threshold("free")};
  for (const Rows& rows : rows_of(model.shape)) {
    for (const JsonValue& row : root.at(rows.name).list(rows.count, rows.count)) {
      for (const JsonValue& weight : row.list(rows.size, rows.size)) {
        model.parameters.push_back(static_cast<std::int8_t>(weight.integer(INT8_MIN, INT8_MAX)));
      }
    }
  }
  return model;
}

void write_slip_model(const std::filesystem::path& file, const SlipModel& model) {
  const auto number = [](const char* name, auto value) {
    return "  \"" + std::string(name) + "\": " + std::to_string(value) + ",\n";
  };
  std::string text = "{\n  \"format\": \"" + std::string(kSlipFormat) + "\",\n";
  text += number("format_version", kSlipVersion);
  text += "  \"training_data\": \"" + model.training_data + "\",\n";
  text += number("seed", model.seed) + number("inputs", int{model.shape.inputs}) +
          number("units", int{model.shape.units}) + number("slip", model.thresholds.slip) +
          number("stuck", model.thresholds.stuck) + number("free", model.thresholds.free);
  bool first = true;
  for (const Rows& rows : rows_of(model.shape)) {
    text += std::string(first ? "" : ",\n") + "  \"" + rows.name + "\": [";
    for (std::size_t row = 0; row < rows.count; ++row) {
      text += std::string(row == 0 ? "\n" : ",\n") + "    [" +
              text_of(model, rows.begin + row * rows.size, rows.size, ", ") + "]";
    }
    text += "\n  ]";
    first = false;
  }
  write_file(file, text + "\n}\n");
}

std::string slip_model_header(const SlipModel& model) {
  constexpr std::size_t kInALine = 16;
  std::string text =
      "// The slip watch's network and its thresholds.\n// Written by `screed nn slip export`; "
      "training data " +
      model.training_data + ", seed " + std::to_string(model.seed) +
      ".\n#pragma once\n\n// clang-format off\n#include <stdint.h>\n\n"
      "#include \"hal/program_memory.h\"\n\nnamespace screed {\nnamespace nn {\n"
      "namespace model_slip {\n\n";
  const auto threshold = [&](const char* name, std::uint16_t value) {
    text += "constexpr uint16_t " + std::string(name) + " = " + std::to_string(value) + ";\n";
  };
  threshold("kSlipEvidence", model.thresholds.slip);
  threshold("kStuckEvidence", model.thresholds.stuck);
  threshold("kFreeEvidence", model.thresholds.free);
  text += "\nconst int8_t parameters[] SCREED_PROGRAM_MEMORY = {";
  for (std::size_t i = 0; i < model.parameters.size(); i += kInALine) {
    text +=
        "\n    " + text_of(model, i, std::min(kInALine, model.parameters.size() - i), ", ") + ",";
  }
  return text + "\n};\n\n}  // namespace model_slip\n}  // namespace nn\n}  // namespace screed\n";
}

}  // namespace screed::nn
