#include "host_sim/run/session/session_layout.h"

#include <ode/ode.h>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/content_hash.h"

namespace screed {

namespace {

/// Whether ODE was compiled with fused multiply-add, as Debian's is for arm64: then the product
/// below keeps what its rounding would drop.
bool ode_fuses() {
  const dReal a[] = {1.0 + 0x1p-30, 1.0};
  const dReal b[] = {1.0 + 0x1p-30, -(1.0 + 0x1p-29)};
  const dReal turned_a[] = {a[1], a[0]};
  const dReal turned_b[] = {b[1], b[0]};
  dReal sum = 0.0;
  dReal other = 0.0;
  dMultiply0(&sum, a, b, 1, 2, 1);
  dMultiply0(&other, turned_a, turned_b, 1, 2, 1);
  return sum != 0.0 || other != 0.0;
}

}  // namespace

std::string arithmetic() {
  return ode_fuses() ? "portable 1, ODE with fused multiply-add" : "portable 1";
}

}  // namespace screed

// HDF5 types made from the column lists.

namespace screed::layout {
namespace {

constexpr unsigned kDeflateLevel =
    1;  // higher levels cost ticks and save a few percent (docs/sessions.md)

}  // namespace

hid_t element_type(ColumnType type) {
  switch (type) {
    case ColumnType::kUint8:
      return H5T_STD_U8LE;
    case ColumnType::kInt16:
      return H5T_STD_I16LE;
    case ColumnType::kUint16:
      return H5T_STD_U16LE;
    case ColumnType::kInt32:
      return H5T_STD_I32LE;
    case ColumnType::kUint32:
      return H5T_STD_U32LE;
    case ColumnType::kDouble:
      return H5T_IEEE_F64LE;
  }
  return -1;
}

h5::Handle row_type(std::span<const Column> columns) {
  h5::Handle row(H5Tcreate(H5T_COMPOUND, row_bytes(columns)), H5Tclose, "cannot create a row type");
  for (const Column& column : columns) {
    const hid_t element = element_type(column.type);
    if (column.array) {
      const hsize_t count = column.count;
      const h5::Handle array(H5Tarray_create2(element, 1, &count), H5Tclose, column.name);
      h5::check(H5Tinsert(row.get(), column.name, column.offset, array.get()), column.name);
    } else {
      h5::check(H5Tinsert(row.get(), column.name, column.offset, element), column.name);
    }
  }
  return row;
}

h5::Handle compressed(std::span<const hsize_t> chunk) {
  h5::Handle options(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "cannot create a table");
  h5::check(H5Pset_chunk(options.get(), static_cast<int>(chunk.size()), chunk.data()),
            "cannot set chunks");
  h5::check(H5Pset_shuffle(options.get()), "cannot set the shuffle filter");
  h5::check(H5Pset_deflate(options.get(), kDeflateLevel), "cannot set the deflate filter");
  h5::check(H5Pset_obj_track_times(options.get(), false), "cannot switch off time stamps");
  return options;
}

h5::Handle create_group(hid_t file, const char* name) {
  const h5::Handle options(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, name);
  h5::check(H5Pset_obj_track_times(options.get(), false), name);
  return {H5Gcreate2(file, name, H5P_DEFAULT, options.get(), H5P_DEFAULT), H5Gclose, name};
}

void write_geometry(hid_t dataset, const HeightMapGeometry& geometry) {
  h5::write_attribute(dataset, "unit_m", geometry.unit_m);
  h5::write_attribute(dataset, "spacing_m", geometry.spacing_m);
  h5::write_attribute(dataset, "origin_x_m", geometry.origin_x_m);
  h5::write_attribute(dataset, "origin_y_m", geometry.origin_y_m);
  h5::write_attribute(dataset, "wrap", std::uint64_t{geometry.wrap ? 1U : 0U});
  if (geometry.walls) h5::write_attribute(dataset, "walls", std::uint64_t{1});
}

HeightMapGeometry read_geometry(hid_t dataset, hsize_t nx, hsize_t ny) {
  constexpr hsize_t kMax = 1U << 16;  // 16 GB of heights: a file that says more is damaged
  if (nx == 0 || ny == 0 || nx > kMax || ny > kMax)
    throw h5::Hdf5Failure("a height map of impossible size");
  return {static_cast<std::uint32_t>(nx),
          static_cast<std::uint32_t>(ny),
          h5::read_double(dataset, "unit_m"),
          h5::read_double(dataset, "spacing_m"),
          h5::read_double(dataset, "origin_x_m"),
          h5::read_double(dataset, "origin_y_m"),
          h5::read_uint64(dataset, "wrap") != 0,
          h5::has_attribute(dataset, "walls") && h5::read_uint64(dataset, "walls") != 0};
}

std::string map_hash(const HeightMapView& map) {
  const HeightMapGeometry& g = map.geometry;
  ContentHash hash;
  hash.add(g.nx);
  hash.add(g.ny);
  hash.add(g.unit_m);
  hash.add(g.spacing_m);
  hash.add(g.origin_x_m);
  hash.add(g.origin_y_m);
  hash.add(g.wrap);
  // Not of a bed without: its hash stays what it was.
  if (g.walls) hash.add(g.walls);
  for (const std::int32_t height : map.heights) hash.add(height);
  return hash.hex();
}

}  // namespace screed::layout

namespace screed {

// One hash per part, joined at the end, so that it does not matter when a part becomes known.

SessionHash::SessionHash(const SessionInfo& info) {
  info_.add(info.seed);
  info_.add(info.experiment_text);
  info_.add(info.tick_rate_hz);
  for (const layout::BoardField& field : layout::kBoardFields) {
    info_.add(field.name);
    info_.add(info.board.*field.field);
  }
  for (const ParameterInfo& parameter : kParameterTable) {
    info_.add(parameter.name);
    info_.add(info.parameters.values[parameter.number]);
  }
  info_.add(key_text(command_key_of(info.credentials)));
  info_.add(info.credentials.key_set);
  info_.add(info.credentials.boot_epoch);
}

void SessionHash::set_terrain_before(const HeightMapView& map) {
  terrain_before_ = layout::map_hash(map);
}

void SessionHash::set_terrain_after(const HeightMapView& map) {
  terrain_after_ = layout::map_hash(map);
}

std::string SessionHash::hex(std::uint64_t frames) const {
  ContentHash hash;
  hash.add(info_.hex());
  hash.add(frames);
  hash.add(frames_.hex());
  hash.add(samples_.hex());
  hash.add(outputs_.hex());
  hash.add(terrain_before_);
  hash.add(terrain_after_);
  // Not of a session without: its hash stays what it was.
  if (!heights_.empty()) hash.add(heights_);
  return hash.hex();
}

}  // namespace screed
