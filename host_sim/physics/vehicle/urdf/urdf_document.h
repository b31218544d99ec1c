// A URDF file as XML whose rules have been checked: elements with their lines, links and joints by
// name. Part of urdf_importer; knows no urdfdom, no meshes and no bodies.
#pragma once

#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>
#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace screed::urdf_parts {

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

template <typename Item>
int index_of(const std::vector<Item>& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

std::string to_text(double value);
std::string in_quotes(std::string_view text);
std::string attribute(const TiXmlElement& element, const char* name);
/// Numbers separated by spaces; empty when one of them is no plain decimal number.
std::vector<double> parse_numbers(std::string_view text);

// Every error of the file is reported here: one line each with the file, the line in it and the
// link or joint. Reading goes on after a fault where it can, so that all of them are seen at once.
class Diagnostic {
 public:
  explicit Diagnostic(std::filesystem::path file) : file_(std::move(file)) {}

  void fault(const TiXmlElement& element, const std::string& what);
  void fault_at_row(int row, const std::string& what);
  /// Throws InputError with all faults so far, in the order of their lines; nothing without any.
  void stop_at_faults() const;

  // Faults that nothing can be read behind; these throw at once, with those before.
  [[noreturn]] void about_file(const std::string& what);
  [[noreturn]] void at_row(int row, const std::string& what);
  [[noreturn]] void at_element(const TiXmlElement& element, const std::string& what);

 private:
  struct Fault {
    int row;
    std::string text;
  };

  std::filesystem::path file_;
  std::vector<Fault> faults_;
};

/// Reads the file and refuses what is no URDF text, and xacro.
void parse_xml(const std::filesystem::path& file, Diagnostic& diagnostic, TiXmlDocument& xml);
/// Checks every number and shape below a link or a joint.
void check_values(const TiXmlElement& parent, Diagnostic& diagnostic);
/// Links and joints of the robot, at least one link.
Outline read_outline(const TiXmlElement& robot, Diagnostic& diagnostic);
/// Refuses cycles and a second root.
void check_tree(const Outline& outline, Diagnostic& diagnostic);

// urdfdom behind a fence: it accepts a good deal that is wrong, prints, and keeps one log a
// process. Part of urdf_importer.

/// What urdfdom makes of a checked document; any error it logs is a refusal.
::urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, Diagnostic& diagnostic);

Eigen::Vector3d to_eigen(const ::urdf::Vector3& v);
/// The pose of an element's <origin>, by its own numbers: urdfdom turns angles into a quaternion
/// whose bits depend on how it was compiled.
Eigen::Isometry3d origin_of(const TiXmlElement& element);

}  // namespace screed::urdf_parts
