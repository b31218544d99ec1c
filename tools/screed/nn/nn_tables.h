// Evaluations and models as text and as JSON.
#pragma once

#include <string>

#include "nn/model/model_file.h"
#include "nn/training/evaluation.h"

namespace screed {

/// Tables 6.1, 6.2 and 6.3 of the thesis with its figures beside ours.
std::string evaluation_text(const nn::Evaluation& evaluation,
                            const nn::TrainingConfiguration& configuration);
/// The same as a section of a page in Markdown.
std::string evaluation_markdown(const nn::Evaluation& evaluation,
                                const nn::TrainingConfiguration& configuration);
std::string evaluation_json(const nn::Evaluation& evaluation);

std::string model_description(const nn::Model& model);

}  // namespace screed
