// The header of a model: parameters as the robot's flash holds them, and a function that names
// every layer.
#include "nn/model/header_export.h"

#include <gtest/gtest.h>

namespace screed::nn {
namespace {

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
