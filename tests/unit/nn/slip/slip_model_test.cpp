// The slip watch's model as a file and as a header, and the choice of its threshold.
#include "nn/slip/slip_model.h"
#include "nn/slip/slip_campaign.h"

#include <gtest/gtest.h>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed::nn {
namespace {

SlipModel some_model() {
  SlipModel model;
  model.training_data = "abc";
  model.seed = 7;
  model.shape = {3, 2, 2};
  for (int i = 0; i < model.shape.size(); ++i)
    model.parameters.push_back(static_cast<std::int8_t>(i * 37 - 128));
  model.thresholds = {1000, 2000, 500};
  return model;
}

TEST(SlipModel, TheFileHoldsAll) {
  const TempFolder folder;
  const auto file = folder.path() / "slip.json";
  const SlipModel model = some_model();
  write_slip_model(file, model);
  const SlipModel read = read_slip_model(file);
  EXPECT_EQ(read.training_data, model.training_data);
  EXPECT_EQ(read.seed, model.seed);
  EXPECT_EQ(read.shape.inputs, 3);
  EXPECT_EQ(read.shape.units, 2);
  EXPECT_EQ(read.shape.outputs, 2);
  EXPECT_EQ(read.parameters, model.parameters);
  EXPECT_EQ(read.thresholds.slip, 1000);
  EXPECT_EQ(read.thresholds.stuck, 2000);
  EXPECT_EQ(read.thresholds.free, 500);
}

TEST(SlipModel, AFileThatDoesNotFitIsRefused) {
  const TempFolder folder;
  const auto file = folder.path() / "slip.json";
  EXPECT_THROW(read_slip_model(file), InputError);
  SlipModel model = some_model();
  write_slip_model(file, model);
  // One weight fewer, in the last row.
  model.shape.units = 3;
  model.parameters.resize(model.shape.size());
  write_slip_model(folder.path() / "other.json", model);
  EXPECT_NO_THROW(read_slip_model(folder.path() / "other.json"));
  write_file(file, "{\"format\": \"screed-network-model\", \"format_version\": 1}");
  EXPECT_THROW(read_slip_model(file), InputError);
}

TEST(SlipModel, TheHeaderHasThresholdsAndParametersInTheirOrder) {
  const std::string header = slip_model_header(some_model());
  EXPECT_NE(header.find("kStuckEvidence = 2000;"), std::string::npos);
  EXPECT_NE(header.find("kFreeEvidence = 500;"), std::string::npos);
  EXPECT_NE(header.find("kSlipEvidence = 1000;"), std::string::npos);
  EXPECT_NE(header.find("{\n    -128, -91, -54, -17, 20,"), std::string::npos);
  EXPECT_NE(header.find("training data abc, seed 7"), std::string::npos);
}

ThresholdResult result(std::uint16_t stuck, int false_alarms, int detected) {
  ThresholdResult of;
  of.stuck = stuck;
  of.counts.false_alarms = false_alarms;
  of.counts.detected = detected;
  of.counts.driven_s = 2.0 * 3600.0;
  return of;
}

TEST(SlipChoice, DetectsMostOfThoseFromWhichOnAllHold) {
  const std::vector<ThresholdResult> results = {result(100, 9, 50), result(200, 2, 49),
                                                result(300, 3, 49), result(400, 2, 45),
                                                result(500, 0, 40)};
  EXPECT_EQ(choose_threshold(results, 1.0, 1.0), 400) << "300 has more than 2 in 2 h";
  EXPECT_EQ(choose_threshold(results, 1.5, 1.0), 300) << "as many as 200";
  EXPECT_EQ(choose_threshold(results, 9.0, 1.0), 100);
  EXPECT_EQ(choose_threshold({result(100, 9, 3), result(200, 8, 2)}, 1.0, 1.0), 200)
      << "none holds";
  std::vector<ThresholdResult> early = results;
  early[3].counts.trapped = 20;
  early[3].counts.early_alarms = 2;
  EXPECT_EQ(choose_threshold(early, 9.0, 0.09), 500);
  EXPECT_EQ(choose_threshold(early, 9.0, 0.1), 100);
}

}  // namespace
}  // namespace screed::nn
