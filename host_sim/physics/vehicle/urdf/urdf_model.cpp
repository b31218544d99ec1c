// urdfdom, with its log caught and without what it stumbles over.
#include "host_sim/physics/vehicle/urdf/urdf_model.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <mutex>
#include <string>
#include <vector>

#include "host_sim/physics/vehicle/vehicle_state.h"

namespace screed::urdf_parts {
namespace {

// Takes what urdfdom would print. Its first error is kept: urdfdom may log one and return a
// half-read model all the same.
class LogCapture : public console_bridge::OutputHandler {
 public:
  LogCapture()
      : handler_(console_bridge::getOutputHandler()), level_(console_bridge::getLogLevel()) {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
  }
  ~LogCapture() override {
    console_bridge::setLogLevel(level_);
    console_bridge::useOutputHandler(handler_);
  }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  void log(const std::string& text, console_bridge::LogLevel /*level*/, const char* /*file*/,
           int /*line*/) override {
    if (first_error.empty()) first_error = text;
  }

  std::string first_error;

 private:
  console_bridge::OutputHandler* handler_;
  console_bridge::LogLevel level_;
};

// Colours and other tools' extensions are no concern of ours, and urdfdom 3.0 uses a bad material's
// name as a format string.
void remove_unused(TiXmlElement& parent, bool is_robot) {
  TiXmlElement* next = nullptr;
  for (TiXmlElement* element = parent.FirstChildElement(); element != nullptr; element = next) {
    next = element->NextSiblingElement();
    const std::string& tag = element->ValueStr();
    if (tag == "material" || (is_robot && tag != "link" && tag != "joint")) {
      parent.RemoveChild(element);
    } else {
      remove_unused(*element, false);
    }
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, const Diagnostic& diagnostic) {
  TiXmlDocument reduced(xml);
  remove_unused(*reduced.RootElement(), true);
  TiXmlPrinter printer;
  reduced.Accept(&printer);

  // console_bridge has one output handler per process.
  static std::mutex console_bridge_in_use;
  const std::lock_guard<std::mutex> lock(console_bridge_in_use);
  LogCapture log;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(printer.Str());
  } catch (const std::exception& error) {
    diagnostic.about_file(std::string("not a valid URDF model: ") + error.what());
  }
  if (!model || !log.first_error.empty()) {
    diagnostic.about_file("not a valid URDF model: " + log.first_error);
  }
  return model;
}

Eigen::Vector3d to_eigen(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d origin_of(const TiXmlElement& element) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const TiXmlElement* const origin = element.FirstChildElement("origin");
  if (origin == nullptr) return pose;
  const std::vector<double> place = parse_numbers(attribute(*origin, "xyz"));
  const std::vector<double> angles = parse_numbers(attribute(*origin, "rpy"));
  if (!place.empty()) pose.translation() = Eigen::Vector3d(place[0], place[1], place[2]);
  // A turn about y, which points left, lowers the nose.
  if (!angles.empty()) pose.linear() = rotation_from({angles[0], -angles[1], angles[2]});
  return pose;
}

}  // namespace screed::urdf_parts
