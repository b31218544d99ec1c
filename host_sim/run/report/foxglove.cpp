// Schemas and values as JSON.
#include "host_sim/run/report/foxglove.h"

#include <utility>
#include <vector>

namespace screed::foxglove {
namespace {

using Fields = std::vector<std::pair<const char*, Json>>;

Json object_of(const Fields& fields) {
  Json properties = Json::object();
  for (const auto& [name, schema] : fields) properties[name] = schema;
  return {{"type", "object"}, {"properties", properties}};
}

Json list_of(Json item) {
  return {{"type", "array"}, {"items", std::move(item)}};
}
Json number() {
  return {{"type", "number"}};
}
Json integer() {
  return {{"type", "integer"}};
}
Json text() {
  return {{"type", "string"}};
}
Json truth() {
  return {{"type", "boolean"}};
}
Json bytes() {
  return {{"type", "string"}, {"contentEncoding", "base64"}};
}
Json time() {
  return object_of({{"sec", integer()}, {"nsec", integer()}});
}
Json vector() {
  return object_of({{"x", number()}, {"y", number()}, {"z", number()}});
}
Json color() {
  return object_of({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
Json quaternion() {
  return object_of({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
Json pose() {
  return object_of({{"position", vector()}, {"orientation", quaternion()}});
}

/// What an entity can show. All have to be there.
constexpr const char* kEntityLists[] = {"metadata", "arrows",    "cubes", "spheres", "cylinders",
                                        "lines",    "triangles", "texts", "models"};

}  // namespace

Json transforms_schema() {
  return object_of({{"transforms", list_of(object_of({{"timestamp", time()},
                                                      {"parent_frame_id", text()},
                                                      {"child_frame_id", text()},
                                                      {"translation", vector()},
                                                      {"rotation", quaternion()}}))}});
}

Json scene_schema() {
  const Json cube = object_of({{"pose", pose()}, {"size", vector()}, {"color", color()}});
  const Json triangles = object_of({{"pose", pose()},
                                    {"points", list_of(vector())},
                                    {"color", color()},
                                    {"colors", list_of(color())},
                                    {"indices", list_of(integer())}});
  Json entity = object_of({{"timestamp", time()},
                           {"frame_id", text()},
                           {"id", text()},
                           {"lifetime", time()},
                           {"frame_locked", truth()}});
  for (const char* list : kEntityLists) entity["properties"][list] = list_of(object_of({}));
  entity["properties"]["cubes"] = list_of(cube);
  entity["properties"]["triangles"] = list_of(triangles);
  return object_of(
      {{"deletions", list_of(object_of({{"timestamp", time()}}))}, {"entities", list_of(entity)}});
}

Json grid_schema() {
  return object_of(
      {{"timestamp", time()},
       {"frame_id", text()},
       {"pose", pose()},
       {"column_count", integer()},
       {"cell_size", object_of({{"x", number()}, {"y", number()}})},
       {"row_stride", integer()},
       {"cell_stride", integer()},
       {"fields",
        list_of(object_of({{"name", text()}, {"offset", integer()}, {"type", integer()}}))},
       {"data", bytes()}});
}

Json log_schema() {
  return object_of({{"timestamp", time()},
                    {"level", integer()},
                    {"message", text()},
                    {"name", text()},
                    {"file", text()},
                    {"line", integer()}});
}

Json timestamp(std::uint64_t time_ns) {
  constexpr std::uint64_t kNsPerS = 1000000000U;
  return {{"sec", time_ns / kNsPerS}, {"nsec", time_ns % kNsPerS}};
}

Json vector_of(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

Json quaternion_of(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

Json pose_at(const Eigen::Vector3d& place) {
  return {{"position", vector_of(place)},
          {"orientation", quaternion_of(Eigen::Quaterniond::Identity())}};
}

Json color_of(const Color& it) {
  return {{"r", it.red}, {"g", it.green}, {"b", it.blue}, {"a", it.alpha}};
}

Json entity(std::uint64_t time_ns, const std::string& frame, const std::string& id) {
  Json json = {{"timestamp", timestamp(time_ns)},
               {"frame_id", frame},
               {"id", id},
               {"lifetime", timestamp(0)},  // until one of the same id
               {"frame_locked", true}};
  for (const char* list : kEntityLists) json[list] = Json::array();
  return json;
}

Json scene_of(Json entities) {
  return {{"deletions", Json::array()}, {"entities", std::move(entities)}};
}

}  // namespace screed::foxglove
