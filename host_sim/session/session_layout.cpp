// HDF5 types made from the column lists.
#include "host_sim/session/session_layout.h"

namespace screed::layout {

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

}  // namespace screed::layout
