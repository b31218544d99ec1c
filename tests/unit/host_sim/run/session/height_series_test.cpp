// The height map of a session, tick by tick: what was recorded comes back to the last unit.
#include <algorithm>

#include "host_sim/run/session/height_series.h"
#include "host_sim/run/simulation/recorders.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

/// Ticks that change a few nodes of a map each, now and then none.
class Digging {
 public:
  explicit Digging(std::size_t ticks) : run(random_run(ticks)) {
    run.before.geometry = {37, 21, 0x1p-24, 0.005, -0.1, 0.2, true};
    Noise noise(5);
    std::vector<std::int32_t> map(std::size_t{37} * 21);
    for (std::int32_t& height : map) height = static_cast<std::int32_t>(noise.next() % 100000);
    run.before.heights = map;
    maps.push_back(map);
    for (std::size_t tick = 0; tick < ticks; ++tick) {
      std::vector<HeightChange> change;
      for (std::uint32_t node = 0; tick % 7 != 3 && node < map.size(); ++node) {
        if (noise.next() % 50 != 0) continue;
        change.push_back({node, static_cast<std::int32_t>(noise.next() % 2001) - 1000});
        map[node] += change.back().by;
      }
      changes.push_back(change);
      maps.push_back(map);
    }
    run.after = {run.before.geometry, map};
  }

  std::string write(const fs::path& file) const {
    SessionWriter writer(file, run.info);
    writer.write_terrain_before(run.before.view());
    writer.record_heights(run.before.view());
    append(writer);
    writer.write_terrain_after(run.after.view());
    return writer.finish();
  }
  void append(SessionWriter& writer) const {
    for (std::size_t i = 0; i < changes.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i], changes[i]);
    }
  }

  Recording run;
  std::vector<std::vector<HeightChange>> changes;
  std::vector<std::vector<std::int32_t>> maps;  ///< maps[n]: after n ticks
};

class HeightSeries : public SessionTest {};

TEST_F(HeightSeries, TheMapOfEveryTickComesBack) {
  const Digging digging(10000);  // over two key frames
  digging.write(file_);
  const SessionReader reader(file_);
  ASSERT_TRUE(reader.has_heights());
  EXPECT_EQ(reader.heights_after(0).geometry.nx, 37U);
  EXPECT_EQ(reader.heights_after(0).geometry.ny, 21U);
  for (std::size_t tick = 0; tick <= 10000; ++tick) {
    ASSERT_EQ(reader.heights_after(tick).heights, digging.maps[tick]) << tick;
  }
  for (const std::size_t tick : {9999U, 3U, 4096U, 4095U, 8191U, 8192U, 0U, 10000U}) {
    EXPECT_EQ(reader.heights_after(tick).heights, digging.maps[tick]) << tick;
  }
  EXPECT_THROW(reader.heights_after(10001), std::out_of_range);
  EXPECT_EQ(reader.heights_after(10000).heights, reader.terrain_after()->heights);

  std::int32_t lowest = INT32_MAX;
  std::int32_t highest = INT32_MIN;
  for (const auto& map : digging.maps) {
    lowest = std::min(lowest, *std::min_element(map.begin(), map.end()));
    highest = std::max(highest, *std::max_element(map.begin(), map.end()));
  }
  EXPECT_EQ(reader.height_extremes().lowest, lowest);
  EXPECT_EQ(reader.height_extremes().highest, highest);
}

TEST_F(HeightSeries, TheContentHashCoversIt) {
  const Digging digging(300);
  const std::string hash = digging.write(file_);
  EXPECT_EQ(SessionReader(file_).compute_content_hash(), hash);
  Digging other = digging;
  const auto changed = std::find_if(other.changes.begin(), other.changes.end(),
                                    [](const auto& change) { return change.size() > 1; });
  changed->front().by += 1;
  EXPECT_NE(other.write(base_ / "other.h5"), hash);
  other = digging;
  changed->front().by -= 1;
  // The same changes a tick later.
  std::rotate(other.changes.begin(), other.changes.end() - 1, other.changes.end());
  EXPECT_NE(other.write(base_ / "later.h5"), hash);
  EXPECT_NE(write_run(base_ / "without.h5", digging.run), hash);
}

TEST_F(HeightSeries, H5dumpReadsIt) {
  const Digging digging(20);
  digging.write(file_);
  const std::string key = output_of("h5dump -y -w 1 -d /heights/key_frames " + file_.string());
  EXPECT_NE(key.find("SIMPLE { ( 1, 21, 37 ) / ( H5S_UNLIMITED, 21, 37 ) }"), std::string::npos);
  EXPECT_NE(key.find("DATA {\n      " + std::to_string(digging.maps[0][0]) + ","),
            std::string::npos)
      << key.substr(0, 400);
  const std::string ends = output_of("h5dump -y -w 1 -d /heights/change_ends " + file_.string());
  EXPECT_NE(ends.find(" " + std::to_string(SessionReader(file_).height_changes()) + "\n"),
            std::string::npos)
      << ends;
}

TEST_F(HeightSeries, ASessionWithoutSaysSo) {
  write_run(file_, random_run(3));
  EXPECT_FALSE(SessionReader(file_).has_heights());
}

TEST_F(HeightSeries, OfAKilledRunWhatIsThereIsRead) {
  const Digging digging(3000);
  {
    SessionWriter writer(file_, digging.run.info);
    writer.record_heights(digging.run.before.view());
    digging.append(writer);
  }
  const SessionReader reader(file_);
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.frames(), 2048U);
  EXPECT_EQ(reader.heights_after(2048).heights, digging.maps[2048]);
}

TEST_F(HeightSeries, DamageIsReported) {
  const Digging digging(20);
  digging.write(file_);
  edit([](hid_t file) {
    const h5::Handle nodes(H5Dopen2(file, "heights/change_nodes", H5P_DEFAULT), H5Dclose, "open");
    const hsize_t count = 1;
    const hsize_t first = 5;
    const h5::Handle space(H5Dget_space(nodes.get()), H5Sclose, "space");
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &first, nullptr, &count, nullptr);
    const h5::Handle one(H5Screate_simple(1, &count, nullptr), H5Sclose, "space");
    const std::uint32_t outside = 37 * 21;
    h5::check(
        H5Dwrite(nodes.get(), H5T_NATIVE_UINT32, one.get(), space.get(), H5P_DEFAULT, &outside),
        "write");
  });
  expect_line(message_of<InputError>([&] { SessionReader(file_).heights_after(20); }), file_,
              "a change outside of the map");
  edit([](hid_t file) { H5Ldelete(file, "heights/key_frames", H5P_DEFAULT); });
  expect_refused("'key_frames' is missing");
}

TEST_F(HeightSeries, HeightsBeginWithTheSession) {
  const Digging digging(2);
  SessionWriter writer(file_, digging.run.info);
  writer.append(digging.run.frames[0], digging.run.samples[0], digging.run.outputs[0]);
  EXPECT_THROW(writer.record_heights(digging.run.before.view()), std::logic_error);
}

TEST(HeightWatch, FindsEveryChangeOnceAndNothingElse) {
  HeightField field(70, 35, 0.01, true);
  HeightWatch watch(field);
  EXPECT_TRUE(watch.changes(field).empty());
  Noise noise(3);
  std::vector<Height> known(std::size_t{70} * 35, 0);
  for (int round = 0; round < 200; ++round) {
    for (int i = 0; i < 20; ++i) {
      const int ix = static_cast<int>(noise.next() % 70);
      const int iy = static_cast<int>(noise.next() % 35);
      field.set_node(ix, iy, static_cast<Height>(noise.next() % 3));
    }
    for (const HeightChange& change : watch.changes(field)) {
      EXPECT_NE(change.by, 0);
      known[change.node] += change.by;
    }
    for (std::size_t node = 0; node < known.size(); ++node) {
      ASSERT_EQ(known[node], field.node(static_cast<int>(node % 70), static_cast<int>(node / 70)));
    }
  }
}

}  // namespace
}  // namespace screed
