// Networks over whole tables, and how good their predictions are.
#pragma once

#include <span>
#include <vector>

#include "nn/model/quantiser.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {

/// Outputs of a network in floating point, a row an example; inputs and outputs are cut at -1 and 1
/// as the integers have it.
std::vector<double> predict(const std::vector<FloatLayer>& network, const Examples& examples);
/// The same in the integers of the robot.
std::vector<double> predict(const IntegerNetwork& network, const Examples& examples);

/// Mean of (a - b)^2.
double mean_squared_error(std::span<const double> a, std::span<const double> b);
/// Squared correlation after Pearson, the thesis' R^2; 0 where one of them never changes.
double squared_correlation(std::span<const double> a, std::span<const double> b);
/// 1 - sum (real - predicted)^2 / sum (real - mean)^2, which sees offset and scale as well.
double explained_variance(std::span<const double> real, std::span<const double> predicted);
/// Correlation of the ranks; equal values share the mean of theirs.
double spearman(std::span<const double> a, std::span<const double> b);

}  // namespace screed::nn
