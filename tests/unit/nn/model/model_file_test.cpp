// A model's file: what is written is read, and whatever does not fit is refused with its place.
#include "nn/model/model_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

Model small_model() {
  WorldRandom random(5, "model file test");
  std::vector<FloatLayer> layers = {{2, 3, false, {}, {}}, {3, 1, true, {}, {}}};
  for (FloatLayer& layer : layers) {
    for (std::size_t i = 0; i < layer.inputs * layer.outputs; ++i) {
      layer.weights.push_back(random.uniform(-0.6, 0.6));
    }
    for (std::size_t i = 0; i < layer.outputs; ++i) layer.bias.push_back(random.uniform(-0.1, 0.1));
  }
  Model model;
  model.name = "small";
  model.description = "two layers for a test";
  model.seed = 18446744073709551615U;
  model.training_data = "00112233445566778899aabbccddeeff";
  model.stages = {{"remove_beyond", "pitch", -1.22, 1.22, 0.0, false},
                  {"mean", "", 0.0, 0.0, 250.0, true}};
  const IntegerNetwork network = quantise(layers);
  model.networks.push_back({{{"v_left", 0.5, 8.0, ""}, {"pitch", 0.0, 0.7, ""}},
                            {{"v", 0.1, 0.15, "kinematic_v"}},
                            network,
                            layers,
                            golden_vectors(network, 3, 1)});
  return model;
}

/// The line with which the changed text of the small model is refused.
std::string refusal(const std::string& what, const std::string& by) {
  std::string text = model_text(small_model());
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  text.replace(at, what.size(), by);
  try {
    parse_model(text, "m.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ModelFile, WhatIsWrittenIsRead) {
  const Model model = small_model();
  const std::filesystem::path file =
      std::filesystem::path(::testing::TempDir()) / "screed_model_file_test.json";
  write_model(file, model);
  const Model again = read_model(file);
  std::filesystem::remove(file);
  EXPECT_EQ(model_text(again), model_text(model));
  EXPECT_EQ(again.seed, model.seed);
  ASSERT_EQ(again.networks.size(), 1U);
  EXPECT_EQ(again.networks[0].network.layers()[0].weights,
            model.networks[0].network.layers()[0].weights);
  EXPECT_EQ(again.networks[0].network.layers()[1].linear, true);
  EXPECT_EQ(again.networks[0].trained[0].weights, model.networks[0].trained[0].weights);
  EXPECT_EQ(again.networks[0].outputs[0].baseline, "kinematic_v");
  ASSERT_EQ(again.stages.size(), 2U);
  EXPECT_EQ(again.stages[0].high, 1.22);
  EXPECT_EQ(again.stages[1].value, 250.0);
  EXPECT_TRUE(again.stages[1].run_time);
  ASSERT_EQ(again.networks[0].inputs.size(), model.networks[0].inputs.size());
  EXPECT_EQ(again.networks[0].inputs[1].feature, "pitch");
  EXPECT_EQ(again.networks[0].outputs[0].feature, "v");
}

TEST(ModelFile, ScalesGoBothWays) {
  const ModelChannel channel{"v", 0.1, 0.2, ""};
  EXPECT_EQ(channel.activation(0.1), 0);
  EXPECT_EQ(channel.activation(0.2), 16384);
  EXPECT_EQ(channel.activation(9.0), INT16_MAX);
  EXPECT_EQ(channel.activation(-9.0), INT16_MIN);
  EXPECT_NEAR(channel.value(channel.activation(0.17)), 0.17, 0.2 / 32768);
}

TEST(ModelFile, RefusesWithFilePlaceAndWhatIsAllowed) {
  EXPECT_EQ(refusal("screed-network-model", "something-else"),
            "m.json: is no network model; allowed is a file with \"format\": "
            "\"screed-network-model\"");
  EXPECT_EQ(refusal("\"format_version\": 1", "\"format_version\": 2"),
            "m.json: format_version: 2; allowed is an integer 1 to 1");
  EXPECT_EQ(refusal("\"name\": \"small\"", "\"name\": 3"), "m.json: name: 3; allowed is a text");
  EXPECT_EQ(refusal("\"gain_shift\": 0", "\"gain_shift\": 15"),
            "m.json: networks[0].layers[0].gain_shift: 15; allowed is an integer 0 to 14");
  EXPECT_EQ(refusal("\"activation\": \"tanh\"", "\"activation\": \"relu\""),
            "m.json: networks[0].layers[0].activation: 'relu'; allowed is tanh, linear");
  EXPECT_EQ(refusal("\"outputs\": 1,", "\"outputs\": 2,"),
            "m.json: networks[0].layers[1].weights: 1 values; allowed is 2");
  EXPECT_EQ(refusal("\"half_range\":8.0", "\"half_range\":0.0"),
            "m.json: networks[0].inputs[0].half_range: 0.0; allowed is a number 2.22507e-308 to "
            "1.79769e+308");
  EXPECT_EQ(refusal("\"seed\"", "\"sead\"").substr(0, 36), "m.json: 'sead' is not known; allowed");
  EXPECT_EQ(refusal("]\n}", "]"), "m.json:64: is no JSON");
  EXPECT_EQ(refusal("\"half_range\":8.0", "\"half_range\":1e999"),
            "m.json:11: 1e999 is too large for a number");
}

TEST(ModelFile, AWeightThatWasChangedShowsInTheGoldenVectors) {
  const std::string text = model_text(small_model());
  const std::size_t at = text.find("\"weights\": [") + 12;
  const std::size_t digit = text.find_first_of("123456789", at);
  std::string changed = text;
  changed[digit] = text[digit] == '1' ? '2' : '1';
  try {
    parse_model(changed, "m.json");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("m.json: networks[0].golden["), std::string::npos)
        << error.what();
  }
}

TEST(ModelFile, AMissingFileIsNamed) {
  EXPECT_THROW(read_model("no_such_model.json"), InputError);
}

// ---- The header of a model: parameters as the robot's flash holds them, and a function that names
// every layer

TEST(HeaderExport, NamesLayersAndHoldsTheParameters) {
  const IntegerNetwork network(
      {{2, 3, 1, false, {1, 2, 3, 4, 5, 6}, {7, 8, 9}}, {3, 1, 2, true, {-1, -2, -3}, {10}}});
  Model model;
  model.name = "v-1";
  model.description = "a test";
  model.networks.push_back({{{"v_left@2", 0.0, 8.0, ""}, {"pitch", 0.1, 0.5, ""}},
                            {{"v", 0.0, 0.2, "linear"}},
                            network,
                            {},
                            golden_vectors(network, 1, 1)});
  const std::string text = model_header(model);
  const auto has = [&](const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  };
  has("namespace model_v_1 {");
  has("const uint8_t v_parameters[] SCREED_PROGRAM_MEMORY = {");
  has("/// in:  v_left@2 = 0 + 8 (q + 1/2) / 2^15\n");
  has("/// out: v = 0 + 0.2 (q + 1/2) / 2^15 + linear\n");
  has("  dense<2, 3, 1>(v_parameters + 0, in, a);\n");
  // Three rows of 4 + 2 x 2 bytes lie before the second layer; linear is 0x40.
  has("  dense<3, 1, 66>(v_parameters + 24, a, out);\n");
  has("constexpr uint8_t k_v_golden_vectors = 5;");
  // The first row's weights with their offset of 2^15, little endian, behind its constant.
  const std::vector<std::uint8_t>& row = network.parameters(0);
  EXPECT_EQ(std::vector<int>(row.begin() + 4, row.begin() + 8), (std::vector<int>{1, 128, 2, 128}));
  has(", 1, 128, 2, 128,");
}

}  // namespace
}  // namespace screed::nn
