// Words for who drives where.
#include "tools/screed/viewer/subtitle.h"

namespace screed::viewer {
namespace {

std::string name_of(const Driver& driver) {
  switch (driver.kind) {
    case Driver::Kind::kAlgorithm:
      break;
    case Driver::Kind::kKeyboard:
      return "the keyboard";
    case Driver::Kind::kGamepad:
      return "the gamepad";
    case Driver::Kind::kSimulatedStation:
      return "the simulated ground station";
    case Driver::Kind::kExternalStation:
      return "an external ground station";
    case Driver::Kind::kUnknownStation:
      return "a ground station";
  }
  return driver.algorithm + (driver.external_link ? " (external ground station)" : "");
}

}  // namespace

std::string terrain_name(const std::string& model, const std::string& soil) {
  if (model == "rigid") return "rigid ground";
  if (model == "scm") return "soft soil" + (soil.empty() ? "" : " (" + soil + ")");
  if (model == "static_particles") return "fixed particles";
  return model;
}

std::string subtitle_of(const Driver& driver, const std::string& terrain, uint64_t seed) {
  std::string words = driver.replay ? "replay: " : "";
  words += name_of(driver);
  words += " drives on ";
  words += terrain;
  words += ", seed ";
  words += std::to_string(seed);
  return words;
}

}  // namespace screed::viewer
