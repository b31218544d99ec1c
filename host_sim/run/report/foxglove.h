// What viewers draw, in the schemas that Foxglove has published and others read too, as JSON: where
// robots are, bodies and ground in three dimensions, grids, lines of a log.
//
// Source: github.com/foxglove/foxglove-sdk, schemas/jsonschema.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "host_sim/core/json.h"
#include "host_sim/render/picture/color_map.h"

namespace screed::foxglove {

/// JSON schemas of foxglove.FrameTransforms, SceneUpdate, Grid and Log, of what is used of them.
Json transforms_schema();
Json scene_schema();
Json grid_schema();
Json log_schema();

Json timestamp(std::uint64_t time_ns);
Json vector_of(const Eigen::Vector3d& v);
Json quaternion_of(const Eigen::Quaterniond& q);
/// Not turned.
Json pose_at(const Eigen::Vector3d& place);
Json color_of(const Color& it);

/// Something in the frame of that name that stays until another one of the same id comes. It shows
/// nothing before "cubes" or "triangles" are added.
Json entity(std::uint64_t time_ns, const std::string& frame, const std::string& id);
/// A foxglove.SceneUpdate of a list of entities.
Json scene_of(Json entities);

}  // namespace screed::foxglove
