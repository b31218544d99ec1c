// urdfdom behind a fence: it accepts a good deal that is wrong, prints, and keeps one log a
// process. Part of urdf_importer.
#pragma once

#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <Eigen/Geometry>

#include "host_sim/physics/vehicle/urdf/urdf_document.h"

namespace screed::urdf_parts {

/// What urdfdom makes of a checked document; any error it logs is a refusal.
urdf::ModelInterfaceSharedPtr parse_model(const TiXmlDocument& xml, const Diagnostic& diagnostic);

Eigen::Vector3d to_eigen(const urdf::Vector3& v);
/// The pose of an element's <origin>, by its own numbers: urdfdom turns angles into a quaternion
/// whose bits depend on how it was compiled.
Eigen::Isometry3d origin_of(const TiXmlElement& element);

}  // namespace screed::urdf_parts
