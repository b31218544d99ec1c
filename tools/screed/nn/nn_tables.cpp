// Columns of fixed width, and the same as JSON.
#include "tools/screed/nn/nn_tables.h"

#include <cstdio>

#include "host_sim/core/json.h"

namespace screed {
namespace {

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[240];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

const nn::ThesisFigure* figure_for(const nn::TrainingConfiguration& configuration,
                                   const nn::Score& score) {
  for (const nn::ThesisFigure& figure : configuration.thesis) {
    if (figure.output == score.output && figure.test == score.test) return &figure;
  }
  return nullptr;
}

}  // namespace

std::string evaluation_text(const nn::Evaluation& evaluation,
                            const nn::TrainingConfiguration& configuration) {
  std::string text = line("%-24s %-5s %-11s %8s %8s %8s %10s %10s %12s\n", "output", "test", "data",
                          "frames", "MSE", "R^2", "thesis MSE", "thesis R^2", "integers off");
  for (const nn::Score& score : evaluation.scores) {
    const nn::ThesisFigure* thesis = figure_for(configuration, score);
    text += line("%-24s %-5s %-11s %8zu %8.4f %8.4f ", score.output.c_str(), score.test.c_str(),
                 score.form.c_str(), score.frames, score.mse, score.r2);
    text += thesis != nullptr ? line("%10.4f %10.4f", thesis->mse, thesis->r2)
                              : line("%10s %10s", "", "");
    text += line(" %12.6f\n", score.quantisation);
  }
  if (evaluation.ranks.empty()) return text;
  text += line("\n%-30s %-5s %-11s %9s %9s\n", "rank correlation (Spearman)", "test", "data",
               "recorded", "network");
  for (const nn::RankScore& rank : evaluation.ranks) {
    text += line("%-30s %-5s %-11s %9.4f %9.4f\n", rank.pair.c_str(), rank.test.c_str(),
                 rank.form.c_str(), rank.recorded, rank.predicted);
  }
  return text;
}

std::string evaluation_markdown(const nn::Evaluation& evaluation,
                                const nn::TrainingConfiguration& configuration) {
  std::string text =
      line("## %s\n\n%s\n\n", configuration.name.c_str(), configuration.about.c_str()) +
      "| output | test | data | frames | MSE | R² | thesis: MSE | R² | integers off |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const nn::Score& score : evaluation.scores) {
    const nn::ThesisFigure* thesis = figure_for(configuration, score);
    text += line("| `%s` | %s | %s | %zu | %.4f | %.4f |", score.output.c_str(), score.test.c_str(),
                 score.form.c_str(), score.frames, score.mse, score.r2);
    text += thesis != nullptr && score.form == "as trained"
                ? line(" %.4f | %.4f |", thesis->mse, thesis->r2)
                : std::string(" | |");
    text += line(" %.5f |\n", score.quantisation);
  }
  if (evaluation.ranks.empty()) return text;
  text +=
      "\n| rank correlation (Spearman) | test | data | recorded | network |\n"
      "| --- | --- | --- | --- | --- |\n";
  for (const nn::RankScore& rank : evaluation.ranks) {
    text += line("| %s | %s | %s | %.4f | %.4f |\n", rank.pair.c_str(), rank.test.c_str(),
                 rank.form.c_str(), rank.recorded, rank.predicted);
  }
  return text;
}

std::string evaluation_json(const nn::Evaluation& evaluation) {
  Json scores = Json::array();
  for (const nn::Score& score : evaluation.scores) {
    scores.push_back({{"output", score.output},
                      {"test", score.test},
                      {"data", score.form},
                      {"frames", score.frames},
                      {"mse", score.mse},
                      {"r2", score.r2},
                      {"explained", score.explained},
                      {"integers_off", score.quantisation}});
  }
  Json ranks = Json::array();
  for (const nn::RankScore& rank : evaluation.ranks) {
    ranks.push_back({{"pair", rank.pair},
                     {"test", rank.test},
                     {"data", rank.form},
                     {"recorded", rank.recorded},
                     {"predicted", rank.predicted}});
  }
  const Json root = {{"scores", scores}, {"spearman", ranks}};
  return root.dump(2) + "\n";
}

std::string model_description(const nn::Model& model) {
  std::string text =
      line("%s: %s\nseed %llu, training data %s\n", model.name.c_str(), model.description.c_str(),
           static_cast<unsigned long long>(model.seed), model.training_data.c_str());
  for (const nn::PreprocessingStage& stage : model.stages) {
    text += "stage " + stage.stage;
    if (!stage.feature.empty()) {
      text += line(" %s %.6g to %.6g", stage.feature.c_str(), stage.low, stage.high);
    } else if (stage.value != 0.0) {
      text += line(" %g", stage.value);
    }
    text += stage.run_time ? ", at run time too\n" : "\n";
  }
  for (const nn::ModelNetwork& network : model.networks) {
    text += "network";
    std::size_t parameters = 0;
    std::size_t bytes = 0;
    text += line(" %zu", network.network.inputs());
    for (std::size_t i = 0; i < network.network.layers().size(); ++i) {
      const nn::IntegerLayer& layer = network.network.layers()[i];
      text += line("-%d", layer.outputs);
      parameters += layer.weights.size() + layer.bias.size();
      bytes += network.network.parameters(i).size();
    }
    text += line(": %zu parameters, %zu bytes of flash, %zu golden vectors agree\n", parameters,
                 bytes, network.golden.size());
    const auto channels = [&](const char* direction, const std::vector<nn::ModelChannel>& all) {
      for (const nn::ModelChannel& channel : all) {
        text += line("  %-4s %-24s %.6g +- %.6g%s%s\n", direction, channel.feature.c_str(),
                     channel.middle, channel.half_range, channel.baseline.empty() ? "" : ", to ",
                     channel.baseline.c_str());
      }
    };
    channels("in", network.inputs);
    channels("out", network.outputs);
  }
  return text;
}

}  // namespace screed
