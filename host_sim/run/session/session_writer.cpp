// Rows are packed into memory and handed to HDF5 a chunk at a time: no call of the library in an
// ordinary tick.
#include "host_sim/run/session/session_writer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/record.h"
#include "host_sim/run/session/height_series.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_turns.h"

namespace screed {
namespace {

/// A growing table and the rows that wait to be written.
class GrowingTable {
 public:
  /// block_rows: as many rows wait at most, and are one chunk of the file.
  GrowingTable(hid_t file, const layout::TableLayout& table,
               std::size_t block_rows = SessionWriter::kBlockRows)
      : name_(table.dataset),
        row_bytes_(row_bytes(table.columns)),
        type_(layout::row_type(table.columns)),
        buffer_(block_rows * row_bytes_) {
    const hsize_t rows = 0;
    const hsize_t limit = H5S_UNLIMITED;
    const h5::Handle space(H5Screate_simple(1, &rows, &limit), H5Sclose, name_);
    const h5::Handle options = layout::compressed(std::array<hsize_t, 1>{block_rows});
    dataset_ = {
        H5Dcreate2(file, name_, type_.get(), space.get(), H5P_DEFAULT, options.get(), H5P_DEFAULT),
        H5Dclose, name_};
    std::vector<const char*> units;
    std::vector<const char*> meanings;
    for (const Column& column : table.columns) {
      units.push_back(column.unit);
      meanings.push_back(column.meaning);
    }
    h5::write_attribute(dataset_.get(), "units", units);
    h5::write_attribute(dataset_.get(), "meanings", meanings);
  }

  std::uint8_t* row(std::size_t index) { return &buffer_[index * row_bytes_]; }

  std::span<const std::uint8_t> bytes(std::size_t rows) const {
    return std::span(buffer_).first(rows * row_bytes_);
  }

  void write(hsize_t first, hsize_t rows) {
    const hsize_t total = first + rows;
    h5::check(H5Dset_extent(dataset_.get(), &total), name_);
    const h5::Handle file_space(H5Dget_space(dataset_.get()), H5Sclose, name_);
    h5::check(
        H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &first, nullptr, &rows, nullptr),
        name_);
    const h5::Handle memory_space(H5Screate_simple(1, &rows, nullptr), H5Sclose, name_);
    h5::check(H5Dwrite(dataset_.get(), type_.get(), memory_space.get(), file_space.get(),
                       H5P_DEFAULT, buffer_.data()),
              name_);
  }

  void close() { dataset_.close(name_); }

 private:
  const char* name_;
  std::size_t row_bytes_;
  h5::Handle type_;
  h5::Handle dataset_;
  std::vector<std::uint8_t> buffer_;
};

h5::Handle create_file(const std::filesystem::path& file) {
  h5::begin();
  const h5::Handle options(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "cannot create a file");
  h5::check(H5Pset_obj_track_times(options.get(), false), "cannot switch off time stamps");
  // The format of HDF5 1.8: unlike the default of 1996 its structures carry checksums, and unlike
  // that of 1.10 the file of a killed run opens without repair.
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot create a file");
  h5::check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18),
            "cannot set the file format");
  return {H5Fcreate(file.c_str(), H5F_ACC_EXCL, options.get(), access.get()), H5Fclose,
          "cannot create it"};
}

void write_with_unit(hid_t group, const char* name, std::int64_t value, const char* unit) {
  h5::write_attribute(group, name, value);
  if (*unit != '\0')
    h5::write_attribute(group, (std::string(name) + ".unit").c_str(), std::string(unit));
}

void write_info(hid_t file, const SessionInfo& info) {
  h5::write_attribute(file, layout::kFormatAttribute, std::string(layout::kFormat));
  h5::write_attribute(file, layout::kVersionAttribute, layout::kFormatVersion);
  h5::write_attribute(file, layout::kProgramAttribute, info.program_version);
  h5::write_attribute(file, layout::kArithmeticAttribute, info.arithmetic);
  h5::write_attribute(file, layout::kExperimentNameAttribute, info.experiment_name);
  h5::write_attribute(file, layout::kExperimentTextAttribute, info.experiment_text);
  h5::write_attribute(file, layout::kSeedAttribute, info.seed);
  h5::write_attribute(file, layout::kTickRateAttribute, std::uint64_t{info.tick_rate_hz});
  h5::write_attribute(file, layout::kBoardNameAttribute, info.board_name);
  h5::write_attribute(file, layout::kFramesAttribute, std::uint64_t{0});

  const h5::Handle parameters = layout::create_group(file, layout::kParametersGroup);
  for (const ParameterInfo& parameter : kParameterTable) {
    write_with_unit(parameters.get(), parameter.name, info.parameters.values[parameter.number],
                    parameter.unit);
  }
  const h5::Handle board = layout::create_group(file, layout::kBoardGroup);
  for (const layout::BoardField& field : layout::kBoardFields) {
    write_with_unit(board.get(), field.name, info.board.*field.field, field.unit);
  }
  const h5::Handle credentials = layout::create_group(file, layout::kCredentialsGroup);
  h5::write_attribute(credentials.get(), layout::kKeyAttribute,
                      key_text(command_key_of(info.credentials)));
  h5::write_attribute(credentials.get(), layout::kKeySetAttribute,
                      std::int64_t{info.credentials.key_set ? 1 : 0});
  h5::write_attribute(credentials.get(), layout::kBootEpochAttribute,
                      std::int64_t{info.credentials.boot_epoch});
}

}  // namespace

class SessionWriter::Impl {
 public:
  Impl(std::filesystem::path path, const SessionInfo& info)
      : path_(std::move(path)),
        file_(create_file(path_)),
        turns_(path_, true),
        terrain_(layout::create_group(file_.get(), layout::kTerrainGroup)),
        frames_(file_.get(), layout::kFramesTable),
        samples_(file_.get(), layout::kSamplesTable),
        outputs_(file_.get(), layout::kOutputsTable),
        hash_(info) {
    const std::lock_guard<SessionTurns> turn(turns_);
    write_info(file_.get(), info);
    flush();
  }

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t frames() const { return written_ + waiting_; }

  void record_heights(const HeightMapView& map) {
    const std::lock_guard<SessionTurns> turn(turns_);
    if (frames() != 0 || heights_.has_value()) {
      throw std::logic_error("heights are recorded from the first tick on");
    }
    heights_.emplace(file_.get(), map);
  }

  /// True when a whole block waits.
  bool append(const SimFrame& frame, const SensorSample& sample, const RobotOutput& output,
              std::span<const HeightChange> changes) {
    if (heights_) heights_->append(changes);
    pack(frame, FrameRow(frames_.row(waiting_), kFrameBytes));
    pack(sample, SampleRow(samples_.row(waiting_), kSampleBytes));
    pack(output, OutputRow(outputs_.row(waiting_), kOutputBytes));
    return ++waiting_ == kBlockRows;
  }

  void write_block() {
    if (waiting_ == 0) return;
    const std::lock_guard<SessionTurns> turn(turns_);
    hash_.add_frames(frames_.bytes(waiting_));
    hash_.add_samples(samples_.bytes(waiting_));
    hash_.add_outputs(outputs_.bytes(waiting_));
    frames_.write(written_, waiting_);
    samples_.write(written_, waiting_);
    outputs_.write(written_, waiting_);
    if (heights_) heights_->write();
    written_ += waiting_;
    waiting_ = 0;
    h5::write_attribute(file_.get(), layout::kFramesAttribute, written_);
    flush();
  }

  void append_leveling(const LevelingPoint& point) {
    const std::lock_guard<SessionTurns> turn(turns_);
    constexpr std::size_t kBlockPoints = 64;
    if (!leveling_) leveling_.emplace(file_.get(), layout::kLevelingTable, kBlockPoints);
    std::memcpy(leveling_->row(0), &point, kLevelingBytes);  // our hosts are little endian
    leveling_->write(leveling_points_++, 1);
  }

  void write_soil(const SoilParameters& soil) {
    const std::lock_guard<SessionTurns> turn(turns_);
    const h5::Handle group = layout::create_group(file_.get(), layout::kSoilGroup);
    for (const SoilParameterInfo& parameter : kSoilParameters) {
      h5::write_attribute(group.get(), parameter.key, soil.*parameter.member);
      if (*parameter.unit != '\0') {
        h5::write_attribute(group.get(), (std::string(parameter.key) + ".unit").c_str(),
                            std::string(parameter.unit));
      }
    }
    flush();
  }

  void write_terrain(const char* name, const HeightMapView& map) {
    const std::lock_guard<SessionTurns> turn(turns_);
    const HeightMapGeometry& g = map.geometry;
    constexpr hsize_t kTile = 128;
    const std::array<hsize_t, 2> size{g.ny, g.nx};
    const std::array<hsize_t, 2> chunk{std::clamp<hsize_t>(g.ny, 1, kTile),
                                       std::clamp<hsize_t>(g.nx, 1, kTile)};
    const h5::Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose, name);
    const h5::Handle options = layout::compressed(chunk);
    h5::Handle dataset(H5Dcreate2(terrain_.get(), name, H5T_STD_I32LE, space.get(), H5P_DEFAULT,
                                  options.get(), H5P_DEFAULT),
                       H5Dclose, name);
    h5::check(H5Dwrite(dataset.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                       map.heights.data()),
              name);
    layout::write_geometry(dataset.get(), g);
    dataset.close(name);
    flush();
  }

  void write_particles(const char* name, const SphereSet& particles) {
    const std::lock_guard<SessionTurns> turn(turns_);
    const h5::Handle group =
        h5::has_link(file_.get(), layout::kParticlesGroup)
            ? h5::Handle(H5Gopen2(file_.get(), layout::kParticlesGroup, H5P_DEFAULT), H5Gclose,
                         layout::kParticlesGroup)
            : layout::create_group(file_.get(), layout::kParticlesGroup);
    constexpr hsize_t kRows = 4096;
    const std::array<hsize_t, 2> size{particles.centers_m.size(), 3};
    const std::array<hsize_t, 2> chunk{std::clamp<hsize_t>(size[0], 1, kRows), 3};
    const h5::Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose, name);
    const h5::Handle options = layout::compressed(chunk);
    h5::Handle dataset(H5Dcreate2(group.get(), name, H5T_IEEE_F32LE, space.get(), H5P_DEFAULT,
                                  options.get(), H5P_DEFAULT),
                       H5Dclose, name);
    h5::check(H5Dwrite(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                       particles.centers_m.data()),
              name);
    h5::write_attribute(dataset.get(), "unit", std::string("m"));
    h5::write_attribute(dataset.get(), layout::kParticleRadius, particles.radius_m);
    dataset.close(name);
    flush();
  }

  SessionHash& hash() { return hash_; }

  std::string finish() {
    write_block();
    const std::lock_guard<SessionTurns> turn(turns_);
    if (heights_) {
      hash_.set_heights(heights_->hash());
      heights_->close();
    }
    std::string hash = hash_.hex(written_);
    frames_.close();
    samples_.close();
    outputs_.close();
    if (leveling_) leveling_->close();
    terrain_.close("cannot close it");
    h5::write_attribute(file_.get(), layout::kHashAttribute, hash);
    flush();
    file_.close("cannot close it");
    return hash;
  }

 private:
  void flush() { h5::check(H5Fflush(file_.get(), H5F_SCOPE_LOCAL), "cannot write"); }

  std::filesystem::path path_;
  h5::Handle file_;
  SessionTurns turns_;
  h5::Handle terrain_;
  GrowingTable frames_;
  GrowingTable samples_;
  GrowingTable outputs_;
  std::optional<GrowingTable> leveling_;
  std::uint64_t leveling_points_ = 0;
  std::optional<HeightSeriesWriter> heights_;
  SessionHash hash_;
  std::uint64_t written_ = 0;
  std::size_t waiting_ = 0;
};

namespace {

template <class Action>
auto or_run_error(const std::filesystem::path& path, Action&& action) {
  try {
    return action();
  } catch (const h5::Hdf5Failure& failure) {
    throw RunError(path.string() + ": cannot write the session: " + failure.what());
  }
}

void check_map(const HeightMapView& map) {
  const HeightMapGeometry& g = map.geometry;
  if (g.nx == 0 || g.ny == 0 || map.heights.size() != std::size_t{g.nx} * g.ny) {
    throw std::invalid_argument("a height map must have nx * ny heights, at least one");
  }
}

}  // namespace

SessionWriter::SessionWriter(const std::filesystem::path& file, const SessionInfo& info)
    : impl_(or_run_error(file, [&] {
        if (info.experiment_text.find('\0') != std::string::npos) {
          throw InputError("experiment " + info.experiment_name + ": the text has a NUL byte");
        }
        return std::make_unique<Impl>(file, info);
      })) {}

SessionWriter::SessionWriter(SessionWriter&&) noexcept = default;
SessionWriter& SessionWriter::operator=(SessionWriter&&) noexcept = default;
SessionWriter::~SessionWriter() = default;

void SessionWriter::append(const SimFrame& frame, const SensorSample& sample,
                           const RobotOutput& output, std::span<const HeightChange> changes) {
  or_run_error(impl_->path(), [&] {
    if (impl_->append(frame, sample, output, changes)) impl_->write_block();
  });
}

void SessionWriter::record_heights(const HeightMapView& map) {
  check_map(map);
  or_run_error(impl_->path(), [&] { impl_->record_heights(map); });
}

void SessionWriter::append_leveling(const LevelingPoint& point) {
  or_run_error(impl_->path(), [&] { impl_->append_leveling(point); });
}

void SessionWriter::write_soil(const SoilParameters& soil) {
  or_run_error(impl_->path(), [&] { impl_->write_soil(soil); });
}

void SessionWriter::write_terrain_before(const HeightMapView& map) {
  check_map(map);
  impl_->hash().set_terrain_before(map);
  or_run_error(impl_->path(), [&] { impl_->write_terrain(layout::kTerrainBefore, map); });
}

void SessionWriter::write_terrain_after(const HeightMapView& map) {
  check_map(map);
  impl_->hash().set_terrain_after(map);
  or_run_error(impl_->path(), [&] { impl_->write_terrain(layout::kTerrainAfter, map); });
}

void SessionWriter::write_particles_before(const SphereSet& particles) {
  or_run_error(impl_->path(), [&] { impl_->write_particles(layout::kParticlesBefore, particles); });
}

void SessionWriter::write_particles_after(const SphereSet& particles) {
  or_run_error(impl_->path(), [&] { impl_->write_particles(layout::kParticlesAfter, particles); });
}

std::string SessionWriter::finish() {
  return or_run_error(impl_->path(), [&] { return impl_->finish(); });
}

std::uint64_t SessionWriter::frames() const {
  return impl_->frames();
}

}  // namespace screed
