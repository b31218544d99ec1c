// Reading a URDF file's XML and checking what urdfdom does not.
#include "host_sim/physics/vehicle/urdf/urdf_document.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/vehicle_state.h"

namespace screed::urdf_parts {
namespace {

// TinyXML recurses; URDF itself nests six deep.
constexpr int kDeepestNesting = 100;

// Names and values of a file end up in messages, whatever they contain.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

// "link 'fl_Wheel': " for anything inside it.
std::string owner(const TiXmlElement& element) {
  const TiXmlNode* node = &element;
  while (node != nullptr && node->ValueStr() != "link" && node->ValueStr() != "joint") {
    node = node->Parent();
  }
  if (node == nullptr) return "";
  return node->ValueStr() + " " + in_quotes(attribute(*node->ToElement(), "name")) + ": ";
}

}  // namespace

std::string to_text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, 6);
  return {buffer.data(), end.ptr};
}

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text) + "'";
}

std::string attribute(const TiXmlElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? std::string() : std::string(value);
}

void Diagnostic::fault(const TiXmlElement& element, const std::string& what) {
  fault_at_row(element.Row(), owner(element) + what);
}

void Diagnostic::fault_at_row(int row, const std::string& what) {
  const std::string line = row > 0 ? ":" + std::to_string(row) : "";  // 0: TinyXML knows none
  faults_.push_back({row, one_line(file_.string() + line + ": " + what)});
}

void Diagnostic::stop_at_faults() const {
  constexpr std::size_t kMaxShown = 20;
  if (faults_.empty()) return;
  std::vector<Fault> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Fault& a, const Fault& b) { return a.row < b.row; });
  std::string all;
  for (std::size_t i = 0; i < std::min(sorted.size(), kMaxShown); ++i) {
    all += all.empty() ? "" : "\n";
    all += sorted[i].text;
  }
  if (sorted.size() > kMaxShown) {
    all += "\n" + file_.string() + ": and " + std::to_string(sorted.size() - kMaxShown) + " more";
  }
  throw InputError(all);
}

void Diagnostic::about_file(const std::string& what) {
  at_row(0, what);
}

void Diagnostic::at_row(int row, const std::string& what) {
  fault_at_row(row, what);
  stop_at_faults();
  std::abort();  // not reached: there is a fault
}

void Diagnostic::at_element(const TiXmlElement& element, const std::string& what) {
  at_row(element.Row(), owner(element) + what);
}

namespace {

// Greatest number of elements open at once. Counts tags inside comments too: the limit leaves room
// for those.
int nesting_depth(std::string_view xml) {
  int depth = 0;
  int deepest = 0;
  for (std::size_t i = 0; i + 1 < xml.size(); ++i) {
    const std::string_view pair = xml.substr(i, 2);
    if (pair == "</" || pair == "/>") {
      --depth;
    } else if (pair[0] == '<' && pair != "<!" && pair != "<?") {
      deepest = std::max(deepest, ++depth);
    }
  }
  return deepest;
}

// Plain decimal numbers only, whatever the locale: "nan" and "inf" are no numbers here.
std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

// A macro file (xacro) is XML too, and its expressions would only be seen as wrong numbers.
const TiXmlElement* find_macro(const TiXmlElement& element) {
  if (element.ValueStr().starts_with("xacro:")) return &element;
  for (const TiXmlAttribute* one = element.FirstAttribute(); one != nullptr; one = one->Next()) {
    const std::string& value = one->ValueStr();
    if (value.find("${") != std::string::npos || value.find("$(") != std::string::npos) {
      return &element;
    }
  }
  for (const TiXmlElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (const TiXmlElement* macro = find_macro(*child)) return macro;
  }
  return nullptr;
}

}  // namespace

void parse_xml(const std::filesystem::path& file, Diagnostic& diagnostic, TiXmlDocument& xml) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    diagnostic.about_file("no such file, or not a file");
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) diagnostic.about_file("cannot be read");
  if (text.find('\0') != std::string::npos) diagnostic.about_file("is not an XML text file");
  if (nesting_depth(text) > kDeepestNesting) {
    diagnostic.about_file("elements are nested more than " + std::to_string(kDeepestNesting) +
                          " deep");
  }
  xml.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  if (xml.Error()) {
    diagnostic.at_row(xml.ErrorRow(), std::string("malformed XML: ") + xml.ErrorDesc());
  }
  const TiXmlElement* root = xml.RootElement();
  if (root == nullptr || root->ValueStr() != "robot") {
    diagnostic.about_file("not a URDF file: the outermost element must be <robot>");
  }
  if (const TiXmlElement* macro = find_macro(*root)) {
    diagnostic.at_row(
        macro->Row(),
        "<" + macro->ValueStr() + "> is xacro, which has to be expanded to URDF first: xacro " +
            file.filename().string() + " > expanded.urdf (ROS, or pip install xacro)");
  }
  if (root->NextSiblingElement() != nullptr) {
    diagnostic.at_row(root->NextSiblingElement()->Row(), "nothing may follow </robot>");
  }
}

// Numbers separated by spaces; empty when one of them is no number.
std::vector<double> parse_numbers(std::string_view text) {
  std::vector<double> values;
  while (true) {
    const std::size_t start = text.find_first_not_of(' ');
    if (start == std::string_view::npos) return values;
    text.remove_prefix(start);
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::optional<double> value = parse_number(text.substr(0, end));
    if (!value) return {};
    values.push_back(*value);
    text.remove_prefix(end);
  }
}

namespace {

enum class Sign { Any, Positive, NotNegative };

struct NumberRule {
  const char* element;
  const char* name;
  std::size_t count;
  Sign sign;
  bool required;
};

// Every number Screed or urdfdom reads from a link or a joint.
constexpr NumberRule kNumberRules[] = {
    {"origin", "xyz", 3, Sign::Any, false},
    {"origin", "rpy", 3, Sign::Any, false},
    {"axis", "xyz", 3, Sign::Any, true},
    {"box", "size", 3, Sign::Positive, true},
    {"sphere", "radius", 1, Sign::Positive, true},
    {"cylinder", "radius", 1, Sign::Positive, true},
    {"cylinder", "length", 1, Sign::Positive, true},
    {"mesh", "scale", 3, Sign::Positive, false},
    {"mass", "value", 1, Sign::NotNegative, true},
    {"inertia", "ixx", 1, Sign::Any, true},
    {"inertia", "ixy", 1, Sign::Any, true},
    {"inertia", "ixz", 1, Sign::Any, true},
    {"inertia", "iyy", 1, Sign::Any, true},
    {"inertia", "iyz", 1, Sign::Any, true},
    {"inertia", "izz", 1, Sign::Any, true},
    {"limit", "lower", 1, Sign::Any, false},
    {"limit", "upper", 1, Sign::Any, false},
    {"limit", "effort", 1, Sign::NotNegative, true},
    {"limit", "velocity", 1, Sign::NotNegative, true},
    {"dynamics", "damping", 1, Sign::NotNegative, false},
    {"dynamics", "friction", 1, Sign::NotNegative, false},
};

void check_number(const TiXmlElement& element, const NumberRule& rule, Diagnostic& diagnostic) {
  const std::string tag = "<" + element.ValueStr() + "> ";
  if (element.Attribute(rule.name) == nullptr) {
    if (rule.required) diagnostic.fault(element, tag + "needs " + in_quotes(rule.name));
    return;
  }
  const std::string text = attribute(element, rule.name);
  const std::vector<double> values = parse_numbers(text);
  // urdfdom reads no single number with a space around it.
  bool good =
      values.size() == rule.count && (rule.count > 1 || text.find(' ') == std::string::npos);
  for (const double value : values) {
    good = good && (rule.sign != Sign::Positive || value > 0.0) &&
           (rule.sign != Sign::NotNegative || value >= 0.0);
  }
  if (good) return;
  const std::string kind = rule.sign == Sign::Positive      ? "positive finite"
                           : rule.sign == Sign::NotNegative ? "finite, not negative"
                                                            : "finite";
  diagnostic.fault(element, tag + in_quotes(rule.name) + " is '" + text +
                                "'; allowed: " + (rule.count == 1 ? "one " : "three ") + kind +
                                " number" + (rule.count == 1 ? "" : "s separated by spaces"));
}

void check_shape(const TiXmlElement& element, Diagnostic& diagnostic) {
  const TiXmlElement* geometry = element.FirstChildElement("geometry");
  const TiXmlElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
  if (shape == nullptr) {
    return diagnostic.fault(
        element,
        "<" + element.ValueStr() + "> needs a <geometry> with a box, cylinder, sphere or mesh");
  }
  const std::string& kind = shape->ValueStr();
  if (kind != "box" && kind != "cylinder" && kind != "sphere" && kind != "mesh") {
    diagnostic.fault(
        *shape, "geometry <" + kind + "> is not supported; allowed: box, cylinder, sphere, mesh");
  }
  if (kind == "mesh" && attribute(*shape, "filename").empty()) {
    diagnostic.fault(*shape, "<mesh> needs 'filename'");
  }
}

}  // namespace

// Everything below a link or a joint.
void check_values(const TiXmlElement& parent, Diagnostic& diagnostic) {
  for (const TiXmlElement* element = parent.FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    const std::string& tag = element->ValueStr();
    if (tag == "visual" || tag == "collision") check_shape(*element, diagnostic);
    for (const char* part : {"mass", "inertia"}) {
      if (tag == "inertial" && element->FirstChildElement(part) == nullptr) {
        diagnostic.fault(*element, "<inertial> needs <" + std::string(part) + ">");
      }
    }
    for (const NumberRule& rule : kNumberRules) {
      if (tag == rule.element) check_number(*element, rule, diagnostic);
    }
    check_values(*element, diagnostic);
  }
}

namespace {

template <typename Item>
void read_items(const TiXmlElement& robot, const char* tag, Diagnostic& diagnostic,
                std::vector<Item>& items) {
  for (const TiXmlElement* element = robot.FirstChildElement(tag); element != nullptr;
       element = element->NextSiblingElement(tag)) {
    const std::string name = attribute(*element, "name");
    if (name.empty()) {
      diagnostic.fault_at_row(element->Row(), "<" + std::string(tag) + "> needs a 'name'");
      continue;
    }
    if (const int first = index_of(items, name); first >= 0) {
      diagnostic.fault_at_row(element->Row(), std::string(tag) + " " + in_quotes(name) +
                                                  " is there twice, first on line " +
                                                  std::to_string(items[at(first)].xml->Row()) +
                                                  "; names are unique");
      continue;
    }
    Item item;
    item.name = name;
    item.xml = element;
    items.push_back(item);
  }
}

int linked_body(const JointElement& joint, const char* role, const std::vector<LinkElement>& links,
                Diagnostic& diagnostic) {
  const TiXmlElement* element = joint.xml->FirstChildElement(role);
  const std::string name = element == nullptr ? std::string() : attribute(*element, "link");
  if (name.empty()) {
    diagnostic.fault(*joint.xml, "needs <" + std::string(role) + " link=\"...\"/>");
    return -1;
  }
  const int link = index_of(links, name);
  if (link < 0) {
    diagnostic.fault(*joint.xml,
                     std::string(role) + " link " + in_quotes(name) + " does not exist");
  }
  return link;
}

int parent_link(const Outline& outline, int link) {
  const int joint = outline.links[at(link)].parent_joint;
  return joint < 0 ? -1 : outline.joints[at(joint)].parent;
}

}  // namespace

Outline read_outline(const TiXmlElement& robot, Diagnostic& diagnostic) {
  Outline outline;
  read_items(robot, "link", diagnostic, outline.links);
  read_items(robot, "joint", diagnostic, outline.joints);
  diagnostic.stop_at_faults();  // a name left out would be missed again wherever it is used

  if (outline.links.empty()) diagnostic.about_file("there is no <link>: a robot has some");
  for (std::size_t j = 0; j < outline.joints.size(); ++j) {
    JointElement& joint = outline.joints[j];
    joint.type = attribute(*joint.xml, "type");
    if (joint.type != "fixed" && joint.type != "revolute" && joint.type != "continuous") {
      diagnostic.fault(*joint.xml, "type " + in_quotes(joint.type) +
                                       " is not supported; allowed: fixed, revolute, continuous");
    }
    if (joint.xml->FirstChildElement("mimic") != nullptr) {
      diagnostic.fault(*joint.xml, "<mimic> is not supported");
    }
    joint.parent = linked_body(joint, "parent", outline.links, diagnostic);
    joint.child = linked_body(joint, "child", outline.links, diagnostic);
    if (joint.child < 0) continue;
    LinkElement& child = outline.links[at(joint.child)];
    if (child.parent_joint >= 0) {
      diagnostic.fault(*joint.xml, "link " + in_quotes(child.name) + " has two parents, joint " +
                                       in_quotes(outline.joints[at(child.parent_joint)].name) +
                                       " and this one; a robot is a tree");
    }
    child.parent_joint = static_cast<int>(j);
  }
  return outline;
}

// Every link has at most one parent by now: it is a tree when nobody is its own ancestor and only
// one has no parent.
void check_tree(const Outline& outline, Diagnostic& diagnostic) {
  const LinkElement* root = nullptr;
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const LinkElement& link = outline.links[i];
    const int self = static_cast<int>(i);
    int ancestor = parent_link(outline, self);
    for (std::size_t step = 0; step < outline.links.size() && ancestor >= 0; ++step) {
      if (ancestor == self) {
        diagnostic.at_element(*link.xml, "its joints form a cycle; a robot is a tree");
      }
      ancestor = parent_link(outline, ancestor);
    }
    if (link.parent_joint >= 0) continue;
    if (root != nullptr) {
      diagnostic.fault(*link.xml, "neither this link nor link " + in_quotes(root->name) +
                                      " is the child of a joint; a robot is one tree");
    }
    root = &link;
  }
}

// urdfdom, with its log caught and without what it stumbles over.

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

urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, Diagnostic& diagnostic) {
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
  } catch (const std::bad_alloc&) {
    throw;  // says nothing about the file
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
