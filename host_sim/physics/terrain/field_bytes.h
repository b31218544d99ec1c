// A height field as the parts that make it, for an archive as those of cereal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

struct FieldBytes {
  int32_t nx = 0;
  int32_t ny = 0;
  double spacing_m = 0.0;
  BedEdge edge = BedEdge::kOpen;
  std::vector<Height> heights;  ///< row by row from the south

  template <typename Archive>
  void serialize(Archive& archive) {
    archive(nx, ny, spacing_m, edge, heights);
  }
};

inline FieldBytes bytes_of(const HeightField& field) {
  const size_t nodes = static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny());
  return {field.nx(),
          field.ny(),
          field.spacing_m(),
          field.edge(),
          {field.heights(), field.heights() + nodes}};
}

/// Throws InputError where there are not as many heights as nodes, and as HeightField does.
inline HeightField field_of(const FieldBytes& bytes) {
  HeightField field(bytes.nx, bytes.ny, bytes.spacing_m, bytes.edge == BedEdge::kWrapped);
  if (bytes.edge == BedEdge::kWalled) field.add_walls();
  auto height = bytes.heights.begin();
  if (bytes.heights.size() != static_cast<size_t>(bytes.nx) * static_cast<size_t>(bytes.ny))
    throw InputError("a height field with other heights than nodes");
  for (int iy = 0; iy < bytes.ny; ++iy) {
    for (int ix = 0; ix < bytes.nx; ++ix) field.set_node(ix, iy, *height++);
  }
  field.refresh_bounds();
  return field;
}

}  // namespace screed
