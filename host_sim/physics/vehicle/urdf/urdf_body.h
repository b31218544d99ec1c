// Triangle meshes from OBJ, STL and Collada files, read by Assimp. Knows nothing of robots.
#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/urdf/urdf_document.h"

namespace screed {

/// Reads a Wavefront OBJ, an STL (ASCII or binary) or a Collada file (.dae, in the unit that it
/// states; its "up" does not count) and multiplies every vertex by `scale`,
/// axis by axis (each > 0). Polygons become triangles, equal vertices become one, triangles without
/// area, loose points and lines are dropped. Coordinates pass through Assimp as 32-bit floats.
/// Throws InputError: no such file, another format, unreadable, no triangle in it, a coordinate
/// that is not finite.
TriangleMesh load_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale);

}  // namespace screed

// A URDF link as a body: shapes, mass and inertia. Part of urdf_importer.

namespace screed::urdf_parts {

/// The body without its pose. Meshes are searched relative to the folder of urdf_file.
AssemblyBody to_body(const LinkElement& element, const ::urdf::Link& link,
                     const std::filesystem::path& urdf_file, Diagnostic& diagnostic);

}  // namespace screed::urdf_parts
