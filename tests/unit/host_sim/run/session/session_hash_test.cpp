// The content hash of a session: what it covers, and what it does not.
#include "firmware/parameters/parameter_table.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

TEST_F(SessionTest, TheHashCoversEveryByteOfEveryRow) {
  Recording run = random_run(1);
  run.samples[0].radio_in_count = kRadioInCapacity - 1;
  run.outputs[0].radio_out_count = kRadioOutCapacity - 1;
  int number = 0;
  const auto hash = [&](const Recording& changed) {
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash(run);
  EXPECT_EQ(hash(run), original);
  const auto check = [&]<std::size_t N, class Row>(const std::array<std::uint8_t, N>& bytes,
                                                   Row& row, std::span<const Column> columns) {
    const Row unchanged = row;
    for (std::size_t i = 0; i < N; ++i) {
      auto other = bytes;
      other[i] ^= 1;
      unpack(other, row);
      const bool valid = columns.back().array ? i + 1 < N : true;  // the last radio byte is not
      EXPECT_EQ(hash(run) != original, valid) << columns.front().name << "..., byte " << i;
    }
    row = unchanged;
  };
  check(packed<kFrameBytes>(run.frames[0]), run.frames[0], kFrameColumns);
  check(packed<kSampleBytes>(run.samples[0]), run.samples[0], kSampleColumns);
  check(packed<kOutputBytes>(run.outputs[0]), run.outputs[0], kOutputColumns);
  EXPECT_EQ(hash(run), original);
}

TEST_F(SessionTest, TheHashCoversTheConditionsButNotTheNames) {
  const Recording run = random_run(2);
  int number = 0;
  const auto hash = [&](const std::function<void(Recording&)>& change) {
    Recording changed = run;
    change(changed);
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash([](Recording&) {});
  EXPECT_EQ(original, hash([](Recording& r) { r.info.program_version = "9"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.experiment_name = "pit"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.board_name = "other"; }));

  EXPECT_NE(original, hash([](Recording& r) { ++r.info.seed; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.experiment_text += ' '; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.tick_rate_hz = 50; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.info.board.tread_mm; }));
  for (const ParameterInfo& parameter : kParameterTable) {
    EXPECT_NE(original, hash([&](Recording& r) { ++r.info.parameters.values[parameter.number]; }))
        << parameter.name;
  }
  EXPECT_NE(original, hash([](Recording& r) { ++r.before.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.after.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.before, r.after); }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.unit_m = 2e-6; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.spacing_m = 0.025; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_x_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_y_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.wrap = false; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.walls = true; }));
  EXPECT_NE(original,
            hash([](Recording& r) { std::swap(r.before.geometry.nx, r.before.geometry.ny); }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.frames[0], r.frames[1]); }));
}

TEST_F(SessionTest, TheHashShowsAnEditedFile) {
  const std::string hash = write_run(file_, random_run(3));
  edit([](hid_t file) {
    const h5::Handle group(H5Gopen2(file, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
    h5::write_attribute(group.get(), "climb_speed", std::int64_t{124});
  });
  const SessionReader reader(file_);
  EXPECT_EQ(reader.content_hash(), hash);
  EXPECT_NE(reader.compute_content_hash(), hash);
}

}  // namespace
}  // namespace screed
