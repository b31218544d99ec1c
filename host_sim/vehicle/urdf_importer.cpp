// URDF to Assembly. urdfdom reads the model, but it accepts a good deal that is wrong (a link whose
// inertia it could not read, a cycle beside the tree, a link with two parents), drops the axis of
// fixed joints and names no line: so the XML is checked first, and urdfdom gets what is right.
#include "host_sim/vehicle/urdf_importer.h"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <mutex>
#include <string_view>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/vehicle/mesh_loader.h"

namespace screed {
namespace {

constexpr std::array<const char*, 5> kRequiredLinks = {"Body", "fl_Wheel", "fr_Wheel", "bl_Wheel",
                                                       "br_Wheel"};

// The thesis' mark of a powered joint, section 5.2.
constexpr double kMotorVelocity = 1.0;
// A limit written with six decimals still includes its own value; a thin plate has I1 + I2 = I3
// but for the last digits.
constexpr double kAngleTolerance_rad = 1e-6;
constexpr double kRelativeInertiaTolerance = 1e-6;
// TinyXML recurses; URDF itself nests six deep.
constexpr int kDeepestNesting = 100;

// What the XML says about links and joints, in the order of the file.
struct LinkElement {
  std::string name;
  const TiXmlElement* xml = nullptr;
  int parent_joint = -1;
};

struct JointElement {
  std::string name;
  std::string type;
  const TiXmlElement* xml = nullptr;
  int parent = -1;
  int child = -1;
};

struct Outline {
  std::vector<LinkElement> links;
  std::vector<JointElement> joints;
};

template <typename Index>
std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

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

// Names and values of a file end up in messages, whatever they contain.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  return text;
}

// Every complaint about the file goes through here: one line with the file, the line in it and the
// link or joint.
class Complaint {
 public:
  explicit Complaint(std::filesystem::path file) : file_(std::move(file)) {}

  [[noreturn]] void about_file(const std::string& what) const {
    throw InputError(one_line(file_.string() + ": " + what));
  }
  [[noreturn]] void at_row(int row, const std::string& what) const {
    const std::string line = row > 0 ? ":" + std::to_string(row) : "";  // 0: TinyXML knows none
    throw InputError(one_line(file_.string() + line + ": " + what));
  }
  [[noreturn]] void at_element(const TiXmlElement& element, const std::string& what) const {
    at_row(element.Row(), owner(element) + what);
  }

 private:
  // "link 'fl_Wheel': " for anything inside it.
  static std::string owner(const TiXmlElement& element) {
    const TiXmlNode* node = &element;
    while (node != nullptr && node->ValueStr() != "link" && node->ValueStr() != "joint") {
      node = node->Parent();
    }
    if (node == nullptr) return "";
    return node->ValueStr() + " " + in_quotes(attribute(*node->ToElement(), "name")) + ": ";
  }

  std::filesystem::path file_;
};

// ---- XML ---------------------------------------------------------------------------------

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

void parse_xml(const std::filesystem::path& file, const Complaint& complain, TiXmlDocument& xml) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) {
    complain.about_file("no such file, or not a file");
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) complain.about_file("cannot be read");
  if (text.find('\0') != std::string::npos) complain.about_file("is not an XML text file");
  if (nesting_depth(text) > kDeepestNesting) {
    complain.about_file("elements are nested more than " + std::to_string(kDeepestNesting) +
                        " deep");
  }
  xml.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  if (xml.Error()) {
    complain.at_row(xml.ErrorRow(), std::string("malformed XML: ") + xml.ErrorDesc());
  }
  const TiXmlElement* root = xml.RootElement();
  if (root == nullptr || root->ValueStr() != "robot") {
    complain.about_file("not a URDF file: the outermost element must be <robot>");
  }
  if (root->NextSiblingElement() != nullptr) {
    complain.at_row(root->NextSiblingElement()->Row(), "nothing may follow </robot>");
  }
}

// Plain decimal numbers only, whatever the locale: "nan" and "inf" are no numbers here.
std::optional<double> parse_number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
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
    {"cylinder", "radius", 1, Sign::Positive, true},
    {"cylinder", "length", 1, Sign::Positive, true},
    {"mesh", "scale", 3, Sign::Positive, false},
    {"mass", "value", 1, Sign::Positive, true},
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

void check_number(const TiXmlElement& element, const NumberRule& rule, const Complaint& complain) {
  const std::string tag = "<" + element.ValueStr() + "> ";
  if (element.Attribute(rule.name) == nullptr) {
    if (rule.required) complain.at_element(element, tag + "needs " + in_quotes(rule.name));
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
  complain.at_element(element, tag + in_quotes(rule.name) + " is '" + text +
                                   "'; allowed: " + (rule.count == 1 ? "one " : "three ") + kind +
                                   " number" + (rule.count == 1 ? "" : "s separated by spaces"));
}

void check_shape(const TiXmlElement& element, const Complaint& complain) {
  const TiXmlElement* geometry = element.FirstChildElement("geometry");
  const TiXmlElement* shape = geometry == nullptr ? nullptr : geometry->FirstChildElement();
  if (shape == nullptr) {
    complain.at_element(
        element, "<" + element.ValueStr() + "> needs a <geometry> with a box, cylinder or mesh");
  }
  const std::string& kind = shape->ValueStr();
  if (kind != "box" && kind != "cylinder" && kind != "mesh") {
    complain.at_element(*shape,
                        "geometry <" + kind + "> is not supported; allowed: box, cylinder, mesh");
  }
  if (kind == "mesh" && attribute(*shape, "filename").empty()) {
    complain.at_element(*shape, "<mesh> needs 'filename'");
  }
}

// Everything below a link or a joint.
void check_values(const TiXmlElement& parent, const Complaint& complain) {
  for (const TiXmlElement* element = parent.FirstChildElement(); element != nullptr;
       element = element->NextSiblingElement()) {
    const std::string& tag = element->ValueStr();
    if (tag == "visual" || tag == "collision") check_shape(*element, complain);
    for (const char* part : {"mass", "inertia"}) {
      if (tag == "inertial" && element->FirstChildElement(part) == nullptr) {
        complain.at_element(*element, "<inertial> needs <" + std::string(part) + ">");
      }
    }
    for (const NumberRule& rule : kNumberRules) {
      if (tag == rule.element) check_number(*element, rule, complain);
    }
    check_values(*element, complain);
  }
}

// ---- Structure ---------------------------------------------------------------------------

template <typename Item>
int index_of(const std::vector<Item>& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

template <typename Item>
void read_items(const TiXmlElement& robot, const char* tag, const Complaint& complain,
                std::vector<Item>& items) {
  for (const TiXmlElement* element = robot.FirstChildElement(tag); element != nullptr;
       element = element->NextSiblingElement(tag)) {
    const std::string name = attribute(*element, "name");
    if (name.empty()) complain.at_row(element->Row(), "<" + std::string(tag) + "> needs a 'name'");
    if (const int first = index_of(items, name); first >= 0) {
      complain.at_row(element->Row(),
                      std::string(tag) + " " + in_quotes(name) + " is there twice, first on line " +
                          std::to_string(items[at(first)].xml->Row()) + "; names are unique");
    }
    Item item;
    item.name = name;
    item.xml = element;
    items.push_back(item);
  }
}

int linked_body(const JointElement& joint, const char* role, const std::vector<LinkElement>& links,
                const Complaint& complain) {
  const TiXmlElement* element = joint.xml->FirstChildElement(role);
  const std::string name = element == nullptr ? std::string() : attribute(*element, "link");
  if (name.empty()) {
    complain.at_element(*joint.xml, "needs <" + std::string(role) + " link=\"...\"/>");
  }
  const int link = index_of(links, name);
  if (link < 0) {
    complain.at_element(*joint.xml,
                        std::string(role) + " link " + in_quotes(name) + " does not exist");
  }
  return link;
}

Outline read_outline(const TiXmlElement& robot, const Complaint& complain) {
  Outline outline;
  read_items(robot, "link", complain, outline.links);
  read_items(robot, "joint", complain, outline.joints);

  for (const char* name : kRequiredLinks) {
    if (index_of(outline.links, name) >= 0) continue;
    std::string all;
    for (const char* required : kRequiredLinks) {
      all += (all.empty() ? "" : ", ") + std::string(required);
    }
    complain.about_file("there is no link named " + in_quotes(name) +
                        "; a robot needs exactly one link each named " + all);
  }
  for (std::size_t j = 0; j < outline.joints.size(); ++j) {
    JointElement& joint = outline.joints[j];
    joint.type = attribute(*joint.xml, "type");
    if (joint.type != "fixed" && joint.type != "revolute" && joint.type != "continuous") {
      complain.at_element(*joint.xml,
                          "type " + in_quotes(joint.type) +
                              " is not supported; allowed: fixed, revolute, continuous");
    }
    if (joint.xml->FirstChildElement("mimic") != nullptr) {
      complain.at_element(*joint.xml, "<mimic> is not supported");
    }
    joint.parent = linked_body(joint, "parent", outline.links, complain);
    joint.child = linked_body(joint, "child", outline.links, complain);
    LinkElement& child = outline.links[at(joint.child)];
    if (child.parent_joint >= 0) {
      complain.at_element(*joint.xml, "link " + in_quotes(child.name) + " has two parents, joint " +
                                          in_quotes(outline.joints[at(child.parent_joint)].name) +
                                          " and this one; a robot is a tree");
    }
    child.parent_joint = static_cast<int>(j);
  }
  return outline;
}

int parent_link(const Outline& outline, int link) {
  const int joint = outline.links[at(link)].parent_joint;
  return joint < 0 ? -1 : outline.joints[at(joint)].parent;
}

// Every link has at most one parent by now: it is a tree when nobody is its own ancestor and only
// one has no parent.
void check_tree(const Outline& outline, const Complaint& complain) {
  const LinkElement* root = nullptr;
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const LinkElement& link = outline.links[i];
    const int self = static_cast<int>(i);
    int ancestor = parent_link(outline, self);
    for (std::size_t step = 0; step < outline.links.size() && ancestor >= 0; ++step) {
      if (ancestor == self) {
        complain.at_element(*link.xml, "its joints form a cycle; a robot is a tree");
      }
      ancestor = parent_link(outline, ancestor);
    }
    if (link.parent_joint >= 0) continue;
    if (root != nullptr) {
      complain.at_element(*link.xml, "neither this link nor link " + in_quotes(root->name) +
                                         " is the child of a joint; a robot is one tree");
    }
    root = &link;
  }
}

// ---- urdfdom -----------------------------------------------------------------------------

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

urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, const Complaint& complain) {
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
    complain.about_file(std::string("not a valid URDF model: ") + error.what());
  }
  if (!model || !log.first_error.empty()) {
    complain.about_file("not a valid URDF model: " + log.first_error);
  }
  return model;
}

Eigen::Vector3d to_eigen(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d to_eigen(const urdf::Pose& pose) {
  const urdf::Rotation& q = pose.rotation;
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
  result.translation() = to_eigen(pose.position);
  return result;
}

// ---- Bodies ------------------------------------------------------------------------------

// "package://robot/meshes/a.obj" means meshes/a.obj beside the URDF file, like a plain
// "meshes/a.obj".
std::filesystem::path mesh_path(const std::filesystem::path& urdf_file, std::string name) {
  constexpr std::string_view kPackage = "package://";
  if (name.starts_with(kPackage)) {
    const std::size_t slash = name.find('/', kPackage.size());
    name.erase(0, slash == std::string::npos ? kPackage.size() : slash + 1);
  }
  return urdf_file.parent_path() / name;
}

Shape to_shape(const urdf::Pose& origin, const urdf::Geometry& geometry,
               const std::filesystem::path& urdf_file, const LinkElement& link,
               const Complaint& complain) {
  Shape shape;
  shape.pose = to_eigen(origin);
  if (geometry.type == urdf::Geometry::BOX) {
    shape.geometry = Box{to_eigen(dynamic_cast<const urdf::Box&>(geometry).dim)};
  } else if (geometry.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = dynamic_cast<const urdf::Cylinder&>(geometry);
    shape.geometry = Cylinder{cylinder.radius, cylinder.length};
  } else {
    const auto& mesh = dynamic_cast<const urdf::Mesh&>(geometry);
    try {
      shape.geometry = load_mesh(mesh_path(urdf_file, mesh.filename), to_eigen(mesh.scale));
    } catch (const InputError& error) {
      complain.at_element(*link.xml, error.what());
    }
  }
  return shape;
}

Inertia to_inertia(const urdf::Inertial& inertial, const LinkElement& link,
                   const Complaint& complain) {
  Inertia inertia;
  inertia.mass = inertial.mass;
  inertia.pose = to_eigen(inertial.origin);
  inertia.tensor << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,                //
      inertial.ixz, inertial.iyz, inertial.izz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia.tensor,
                                                              Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& moments = solver.eigenvalues();  // ascending
  const TiXmlElement& element =
      *link.xml->FirstChildElement("inertial")->FirstChildElement("inertia");
  const std::string values = "principal moments " + to_text(moments[0]) + ", " +
                             to_text(moments[1]) + ", " + to_text(moments[2]) + " kg m^2";
  if (!(moments[0] > 0.0)) {
    complain.at_element(element, "<inertia> is not positive definite (" + values + ")");
  }
  if (moments[2] > (moments[0] + moments[1]) * (1.0 + kRelativeInertiaTolerance)) {
    complain.at_element(
        element,
        "<inertia> breaks the triangle inequality, the greatest moment exceeds the sum "
        "of the others (" +
            values + ")");
  }
  return inertia;
}

AssemblyBody to_body(const LinkElement& element, const urdf::Link& link,
                     const std::filesystem::path& urdf_file, const Complaint& complain) {
  AssemblyBody body;
  body.name = element.name;
  if (link.inertial) body.inertia = to_inertia(*link.inertial, element, complain);
  for (const urdf::CollisionSharedPtr& item : link.collision_array) {
    body.collision.push_back(to_shape(item->origin, *item->geometry, urdf_file, element, complain));
  }
  for (const urdf::VisualSharedPtr& item : link.visual_array) {
    body.visual.push_back(to_shape(item->origin, *item->geometry, urdf_file, element, complain));
  }
  return body;
}

// ---- Joints ------------------------------------------------------------------------------

// A joint as the file gives it, before anything is placed.
struct JointData {
  AssemblyJoint::Kind kind = AssemblyJoint::Kind::Fixed;
  // Joint frame at angle 0, in the parent.
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  std::optional<Eigen::Vector3d> axis;  // unit, in the joint frame
  bool has_range = false;               // lower or upper was given, and counts
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double effort_n_m = 0.0;
  std::optional<double> held_at_rad;
};

// A fixed joint's axis is of use too (it can be held at another angle), but urdfdom drops it: read
// from the XML.
std::optional<Eigen::Vector3d> joint_axis(const JointElement& joint, const Complaint& complain) {
  const TiXmlElement* element = joint.xml->FirstChildElement("axis");
  if (element == nullptr) {
    if (joint.type == "fixed") return {};
    return Eigen::Vector3d::UnitX();  // the default of URDF
  }
  const std::vector<double> xyz = parse_numbers(attribute(*element, "xyz"));
  const Eigen::Vector3d axis(xyz[0], xyz[1], xyz[2]);
  // stableNorm: neither overflow nor underflow makes an odd axis look like zero.
  if (axis.stableNorm() == 0.0) {
    complain.at_element(*element, "<axis> is zero; it needs a direction");
  }
  return axis.stableNormalized();
}

JointData to_joint(const JointElement& element, const urdf::Joint& joint,
                   const Complaint& complain) {
  JointData data;
  data.origin = to_eigen(joint.parent_to_joint_origin_transform);
  data.axis = joint_axis(element, complain);
  if (element.type != "fixed") data.kind = AssemblyJoint::Kind::Revolute;
  if (!joint.limits) return data;
  data.effort_n_m = joint.limits->effort;
  if (element.type != "fixed" && joint.limits->velocity == kMotorVelocity) {
    data.kind = AssemblyJoint::Kind::Motor;
  }
  const TiXmlElement& limit = *element.xml->FirstChildElement("limit");
  data.has_range = element.type != "continuous" &&
                   (limit.Attribute("lower") != nullptr || limit.Attribute("upper") != nullptr);
  if (!data.has_range) return data;
  data.lower_rad = joint.limits->lower;
  data.upper_rad = joint.limits->upper;
  if (data.lower_rad > data.upper_rad) {
    complain.at_element(limit, "<limit> lower " + to_text(data.lower_rad) + " is above upper " +
                                   to_text(data.upper_rad));
  }
  return data;
}

bool in_range(const JointData& joint, double angle_rad) {
  return !joint.has_range || (angle_rad >= joint.lower_rad - kAngleTolerance_rad &&
                              angle_rad <= joint.upper_rad + kAngleTolerance_rad);
}

void hold(JointData& joint, const JointElement& element, double angle_rad,
          const Complaint& complain) {
  if (!joint.axis) complain.at_element(*element.xml, "has no <axis> to turn it about");
  if (!std::isfinite(angle_rad)) {
    complain.at_element(*element.xml, "the angle to hold it at is not finite");
  }
  if (!in_range(joint, angle_rad)) {
    complain.at_element(*element.xml, "cannot be held at " + to_text(angle_rad) +
                                          " rad; allowed: " + to_text(joint.lower_rad) + " to " +
                                          to_text(joint.upper_rad));
  }
  joint.held_at_rad = angle_rad;
}

// Poses of all links in the frame of `Body`.
std::vector<Eigen::Isometry3d> link_poses(const Outline& outline,
                                          const std::vector<JointData>& joints) {
  const auto pose_in_urdf_root = [&](int link) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int j = outline.links[at(link)].parent_joint; j >= 0;
         j = outline.links[at(outline.joints[at(j)].parent)].parent_joint) {
      const JointData& joint = joints[at(j)];
      Eigen::Isometry3d step = joint.origin;
      if (joint.held_at_rad) step.rotate(Eigen::AngleAxisd(*joint.held_at_rad, *joint.axis));
      pose = step * pose;
    }
    return pose;
  };
  const Eigen::Isometry3d to_body = pose_in_urdf_root(index_of(outline.links, "Body")).inverse();
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    poses.push_back(to_body * pose_in_urdf_root(static_cast<int>(i)));
  }
  return poses;
}

void set_leg_angle(double angle_rad, const Outline& outline, std::vector<JointData>& joints,
                   const Complaint& complain) {
  if (!std::isfinite(angle_rad)) complain.about_file("the leg angle is not finite");
  const std::vector<Eigen::Isometry3d> poses = link_poses(outline, joints);
  for (const std::string_view corner : {"fl_", "fr_", "bl_", "br_"}) {
    const std::string name = std::string(corner) + "Leg_joint";
    const int index = index_of(outline.joints, name);
    if (index < 0) {
      complain.about_file("the leg angle cannot be set: there is no joint named " +
                          in_quotes(name));
    }
    const JointElement& element = outline.joints[at(index)];
    JointData& joint = joints[at(index)];
    const Eigen::Isometry3d& leg = poses[at(element.child)];
    const double axis_y = joint.axis ? (leg.linear() * *joint.axis).y() : 0.0;
    if (element.type != "fixed" || std::abs(axis_y) < 1.0 - 1e-9) {
      complain.at_element(*element.xml,
                          "the leg angle needs a fixed joint with an <axis> along y of 'Body'");
    }
    if (joint.held_at_rad) {
      complain.at_element(*element.xml, "is set both by the leg angle and by its own angle");
    }
    const int wheel = index_of(outline.links, std::string(corner) + "Wheel");
    const Eigen::Vector3d reach = poses[at(wheel)].translation() - leg.translation();
    // A turn about +y moves +x towards -z: it lowers the end of a leg that points forward and lifts
    // one that points back.
    const double now_rad = std::atan2(-reach.z(), std::abs(reach.x()));
    const double sense = (reach.x() < 0.0 ? -1.0 : 1.0) * (axis_y < 0.0 ? -1.0 : 1.0);
    const double turn_rad = sense * (angle_rad - now_rad);
    if (!in_range(joint, turn_rad)) {
      const auto [lowest, highest] =
          std::minmax({now_rad + sense * joint.lower_rad, now_rad + sense * joint.upper_rad});
      complain.at_element(*element.xml, "a leg angle of " + to_text(angle_rad) +
                                            " rad is out of range; allowed: " + to_text(lowest) +
                                            " to " + to_text(highest));
    }
    joint.held_at_rad = turn_rad;
  }
}

// ---- All together ------------------------------------------------------------------------

// What moves on its own needs mass.
void check_masses(const Assembly& assembly, const Outline& outline, const Complaint& complain) {
  for (std::size_t i = 0; i < assembly.bodies.size(); ++i) {
    const int link = static_cast<int>(i);
    const int joint = outline.links[i].parent_joint;
    if (joint >= 0 && assembly.joints[at(joint)].kind == AssemblyJoint::Kind::Fixed) continue;
    if (composed_inertia(assembly, rigid_group(assembly, link)).mass > 0.0) continue;
    complain.at_element(
        *outline.links[i].xml,
        "needs an <inertial> with a mass, here or on a link fixed to it: it moves on its own");
  }
}

}  // namespace

Assembly import_urdf(const std::filesystem::path& file, const UrdfOptions& options) {
  const Complaint complain(file);
  TiXmlDocument xml;
  parse_xml(file, complain, xml);
  const TiXmlElement& robot = *xml.RootElement();
  const Outline outline = read_outline(robot, complain);
  check_tree(outline, complain);
  for (const LinkElement& link : outline.links) check_values(*link.xml, complain);
  for (const JointElement& joint : outline.joints) check_values(*joint.xml, complain);
  const urdf::ModelInterfaceSharedPtr model = parse_model(xml, complain);

  std::vector<JointData> joints;
  for (const JointElement& element : outline.joints) {
    joints.push_back(to_joint(element, *model->getJoint(element.name), complain));
  }
  for (const auto& [name, angle_rad] : options.joint_angles_rad) {
    const int index = index_of(outline.joints, name);
    if (index < 0) complain.about_file("there is no joint named " + in_quotes(name) + " to hold");
    hold(joints[at(index)], outline.joints[at(index)], angle_rad, complain);
  }
  if (options.leg_angle_rad) set_leg_angle(*options.leg_angle_rad, outline, joints, complain);

  Assembly assembly;
  assembly.name = model->getName();
  const std::vector<Eigen::Isometry3d> poses = link_poses(outline, joints);
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    const LinkElement& element = outline.links[i];
    assembly.bodies.push_back(to_body(element, *model->getLink(element.name), file, complain));
    assembly.bodies.back().pose = poses[i];
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointElement& element = outline.joints[j];
    const JointData& data = joints[j];
    AssemblyJoint joint;
    joint.name = element.name;
    joint.kind = data.held_at_rad ? AssemblyJoint::Kind::Fixed : data.kind;
    joint.parent = element.parent;
    joint.child = element.child;
    joint.pose = poses[at(element.child)];
    if (data.axis) joint.axis = joint.pose.linear() * *data.axis;
    joint.limited = joint.kind == AssemblyJoint::Kind::Revolute && data.has_range;
    joint.lower_rad = data.lower_rad;
    joint.upper_rad = data.upper_rad;
    joint.effort_n_m = data.effort_n_m;
    assembly.joints.push_back(joint);
  }
  check_masses(assembly, outline, complain);
  return assembly;
}

}  // namespace screed
