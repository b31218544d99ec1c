// What the law of contacts between equal spheres is made of: its constants and the state of a
// contact. The law itself is contact_law.inc. Plain data: the kernels include this file.
#pragma once

namespace screed {

/// Constants of the law, with the accuracy of `Scalar`.
template <class Scalar>
struct LawConstants {
  Scalar stiffness;        ///< of the normal spring, N/m
  Scalar damping;          ///< of the normal damper, N s/m
  Scalar shear_stiffness;  ///< of the bristle along the surfaces, N/m
  Scalar shear_damping;    ///< N s/m
  Scalar shear_flex;       ///< 1 / shear_stiffness
  Scalar roll_stiffness;   ///< N m/rad
  Scalar roll_damping;     ///< N m s/rad
  Scalar roll_flex;        ///< 1 / roll_stiffness, 0 when that is 0
  Scalar roll_arm;         ///< rolling moment's limit over the normal force, m
};

/// State of a contact: how far the surfaces have moved (m) and turned (rad) over each other
/// while they stuck.
struct ContactBristle {
  float slide[3];
  float roll[3];
};

}  // namespace screed
