// Tables as CSV and HDF5.
#include "host_sim/campaign/campaign_results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_sim/core/hdf5_handle.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

ValueTable table_of(const std::vector<Json>& rows) {
  ValueTable table;
  for (const Json& row : rows) {
    table.add_row();
    table.set_all(row);
  }
  return table;
}

TEST(ValueTable, FlattensObjectsAndLists) {
  const ValueTable table = table_of({Json::parse(
      R"({"a":1,"b":{"c":0.1,"d":{"e":true}},"f":["x","y z"],"g":[1,[2]],"h":[],"i":null})")});
  EXPECT_EQ(table.csv(), "a,b.c,b.d.e,f,g.0,g.1.0,h,i\n1,0.1,1,x; y z,1,2,,\n");
}

TEST(ValueTable, ColumnsThatARowLacksAreEmpty) {
  const ValueTable table = table_of({Json::parse(R"({"a":1})"), Json::parse(R"({"b":2.5})"),
                                     Json::parse(R"({"a":-3,"b":1e-9})")});
  EXPECT_EQ(table.csv(), "a,b\n1,\n,2.5\n-3,1e-09\n");
}

TEST(ValueTable, QuotesWhatACellCannotHold) {
  ValueTable table;
  table.add_row();
  table.set("a,b", R"(say "no")");
  table.set("c", "one, two");
  table.set("d", "line\nline");
  EXPECT_EQ(table.csv(), "\"a,b\",c,d\n\"say \"\"no\"\"\",\"one, two\",\"line\nline\"\n");
}

TEST(ValueTable, WhatIsSetFirstStays) {
  ValueTable table;
  table.add_row();
  table.set("a", 1);
  table.set_all(Json::parse(R"({"a":2,"b":3})"));
  EXPECT_EQ(table.csv(), "a,b\n1,3\n");
}

/// The values of a dataset as doubles.
std::vector<double> read(hid_t file, const char* name, H5T_class_t kind, size_t rows) {
  const h5::Handle dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose, name);
  EXPECT_EQ(H5Tget_class(type.get()), kind) << name;
  std::vector<double> values(rows);
  h5::check(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            name);
  return values;
}

TEST(ValueTable, WritesEachColumnInItsType) {
  const TempFolder folder;
  const std::filesystem::path path = folder.path() / "t.h5";
  const ValueTable table =
      table_of({Json::parse(R"({"i":-1,"u":18446744073709551615,"r":0.5,"n":1,"t":"ab","b":true})"),
                Json::parse(R"({"i":7,"u":1,"r":2,"t":"c","b":false})")});
  h5::begin();
  {
    const h5::Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                          H5Fclose, "file");
    table.write(file.get(), "rows");
  }
  const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "file");
  EXPECT_EQ(read(file.get(), "rows/i", H5T_INTEGER, 2), (std::vector<double>{-1, 7}));
  EXPECT_EQ(read(file.get(), "rows/u", H5T_INTEGER, 2), (std::vector<double>{0x1p64, 1}));
  EXPECT_EQ(read(file.get(), "rows/r", H5T_FLOAT, 2), (std::vector<double>{0.5, 2}));
  EXPECT_EQ(read(file.get(), "rows/b", H5T_INTEGER, 2), (std::vector<double>{1, 0}));
  const std::vector<double> with_null = read(file.get(), "rows/n", H5T_FLOAT, 2);
  EXPECT_EQ(with_null[0], 1.0);
  EXPECT_TRUE(std::isnan(with_null[1]));
  const h5::Handle texts(H5Dopen2(file.get(), "rows/t", H5P_DEFAULT), H5Dclose, "t");
  const h5::Handle type(H5Dget_type(texts.get()), H5Tclose, "t");
  EXPECT_EQ(H5Tget_size(type.get()), 3U);
  std::string bytes(6, '?');
  h5::check(H5Dread(texts.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), "t");
  EXPECT_EQ(bytes, std::string("ab\0c\0\0", 6));
}

}  // namespace
}  // namespace screed
