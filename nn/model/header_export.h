// A model as a C++ header for the robot: parameters in program memory, and a function a network
// that runs it through nn/infer.
#pragma once

#include <string>

#include "nn/model/model_file.h"

namespace screed::nn {

/// The text of the header; it includes nn/infer alone. Namespace screed::nn::model_<name>; for each
/// network the parameters, `run_<outputs>`, how inputs and outputs are scaled (in comments), and
/// the golden vectors.
std::string model_header(const Model& model);

}  // namespace screed::nn
