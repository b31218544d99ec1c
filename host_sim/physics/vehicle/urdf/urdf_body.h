// A URDF link as a body: shapes, mass and inertia. Part of urdf_importer.
#pragma once

#include <filesystem>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"
#include "host_sim/physics/vehicle/urdf/urdf_model.h"

namespace screed::urdf_parts {

/// The body without its pose. Meshes are searched relative to the folder of urdf_file.
AssemblyBody to_body(const LinkElement& element, const urdf::Link& link,
                     const std::filesystem::path& urdf_file, const Diagnostic& diagnostic);

}  // namespace screed::urdf_parts
