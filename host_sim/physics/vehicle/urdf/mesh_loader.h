// Triangle meshes from OBJ and STL files, read by Assimp. Knows nothing of robots.
#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "host_sim/physics/vehicle/assembly.h"

namespace screed {

/// Reads a Wavefront OBJ or an STL file (ASCII or binary) and multiplies every vertex by `scale`,
/// axis by axis (each > 0). Polygons become triangles, equal vertices become one, triangles without
/// area, loose points and lines are dropped. Coordinates pass through Assimp as 32-bit floats.
/// Throws InputError: no such file, another format, unreadable, no triangle in it, a coordinate
/// that is not finite.
TriangleMesh load_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale);

}  // namespace screed
