// Opens session files with suspicion: whatever is wrong with one becomes one InputError that names
// it.
#include "host_sim/run/session/session_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/record.h"
#include "host_sim/run/session/height_series.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_turns.h"

namespace screed {
namespace {

using h5::Hdf5Failure;

constexpr std::uint64_t kBlockRows = 1024;
constexpr const char* kUnreadable = "not a readable session";

template <class Action>
decltype(auto) or_input_error(const std::filesystem::path& path, Action&& action) {
  try {
    return action();
  } catch (const Hdf5Failure& failure) {
    throw InputError(path.string() + ": " + failure.what());
  }
}

/// A session that is being written: a copy in memory of what is there so far.
h5::Handle open_copy(const std::filesystem::path& path) {
  SessionTurns turns(path, false);
  std::vector<char> bytes;
  {
    const std::lock_guard<SessionTurns> turn(turns);
    bytes = turns.bytes();
  }
  constexpr std::size_t kGrowth_bytes = 1U << 16U;  // never used: nothing is written
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, kUnreadable);
  h5::check(H5Pset_fapl_core(access.get(), kGrowth_bytes, false), kUnreadable);
  h5::check(H5Pset_file_image(access.get(), bytes.data(), bytes.size()), kUnreadable);
  // The library wants a name that no file has: nothing can lie below a file.
  const std::filesystem::path name = path / "copy";
  const hid_t id = bytes.empty() ? -1 : H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get());
  if (id < 0) throw Hdf5Failure("the run has only just begun and has saved nothing yet");
  return {id, H5Fclose, ""};
}

h5::Handle open_file(const std::filesystem::path& path, bool& running) {
  h5::begin();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Hdf5Failure("no such file");
  if (std::filesystem::is_directory(status)) throw Hdf5Failure("is a folder, not a session file");
  running = is_being_written(path);
  if (running) return open_copy(path);
  // Negative when the file cannot even be opened: the next call tells why.
  if (H5Fis_hdf5(path.c_str()) == 0) {
    throw Hdf5Failure("not a session: not an HDF5 file, or its beginning is damaged");
  }
  const h5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, kUnreadable);
  // A lock of HDF5's would make a run fail that begins to write just now.
  h5::check(H5Pset_file_locking(access.get(), false, true), kUnreadable);
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose, kUnreadable};
}

void check_format(hid_t file) {
  if (!h5::has_attribute(file, layout::kFormatAttribute) ||
      h5::read_string(file, layout::kFormatAttribute) != layout::kFormat) {
    throw Hdf5Failure("not a session: an HDF5 file of another program");
  }
  const std::uint64_t version = h5::read_uint64(file, layout::kVersionAttribute);
  if (version == 0 || version > layout::kFormatVersion) {
    throw Hdf5Failure("session format " + std::to_string(version) +
                      " is not known; this program reads up to format " +
                      std::to_string(layout::kFormatVersion));
  }
}

/// Reads an integer of the file into a narrower type.
template <class T>
T narrow(std::int64_t value, const char* name) {
  if (value < std::numeric_limits<T>::min() || value > std::numeric_limits<T>::max()) {
    throw Hdf5Failure("'" + std::string(name) + "' is " + std::to_string(value) +
                      ", which is out of its range");
  }
  return static_cast<T>(value);
}

SessionInfo read_info(hid_t file, std::vector<std::string>& missing_parameters) {
  SessionInfo info;
  info.program_version = h5::read_string(file, layout::kProgramAttribute);
  info.arithmetic = h5::has_attribute(file, layout::kArithmeticAttribute)
                        ? h5::read_string(file, layout::kArithmeticAttribute)
                        : kUnnamedArithmetic;
  info.experiment_name = h5::read_string(file, layout::kExperimentNameAttribute);
  info.experiment_text = h5::read_string(file, layout::kExperimentTextAttribute);
  info.seed = h5::read_uint64(file, layout::kSeedAttribute);
  info.tick_rate_hz = narrow<std::uint32_t>(h5::read_int64(file, layout::kTickRateAttribute),
                                            layout::kTickRateAttribute);
  if (info.tick_rate_hz == 0) {
    throw Hdf5Failure(std::string("attribute '") + layout::kTickRateAttribute + "' is 0");
  }
  info.board_name = h5::read_string(file, layout::kBoardNameAttribute);

  const h5::Handle parameters(H5Gopen2(file, layout::kParametersGroup, H5P_DEFAULT), H5Gclose,
                              "cannot read group 'parameters'");
  for (const ParameterInfo& parameter : kParameterTable) {
    if (h5::has_attribute(parameters.get(), parameter.name)) {
      info.parameters.values[parameter.number] =
          narrow<std::int16_t>(h5::read_int64(parameters.get(), parameter.name), parameter.name);
    } else {
      missing_parameters.emplace_back(parameter.name);
    }
  }
  const h5::Handle board(H5Gopen2(file, layout::kBoardGroup, H5P_DEFAULT), H5Gclose,
                         "cannot read group 'board'");
  for (const layout::BoardField& field : layout::kBoardFields) {
    info.board.*field.field =
        narrow<std::uint16_t>(h5::read_int64(board.get(), field.name), field.name);
  }
  const h5::Handle credentials(H5Gopen2(file, layout::kCredentialsGroup, H5P_DEFAULT), H5Gclose,
                               "cannot read group 'credentials'");
  info.credentials = credentials_of(
      parse_key(h5::read_string(credentials.get(), layout::kKeyAttribute), "credentials"),
      narrow<std::uint16_t>(h5::read_int64(credentials.get(), layout::kBootEpochAttribute),
                            layout::kBootEpochAttribute));
  info.credentials.key_set = h5::read_int64(credentials.get(), layout::kKeySetAttribute) != 0;
  return info;
}

/// One table of the file, and where its rows have what this program knows.
class StoredTable {
 public:
  /// A column may be missing only when `optional`; a column of another kind never passes.
  StoredTable(hid_t file, const layout::TableLayout& table, bool optional)
      : name_(table.dataset), row_bytes_(row_bytes(table.columns)) {
    if (!h5::has_link(file, name_)) throw Hdf5Failure("table '" + name() + "' is missing");
    dataset_ = {H5Dopen2(file, name_, H5P_DEFAULT), H5Dclose, name_};
    const h5::Handle space(H5Dget_space(dataset_.get()), H5Sclose, name_);
    const h5::Handle type(H5Dget_type(dataset_.get()), H5Tclose, name_);
    if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Tget_class(type.get()) != H5T_COMPOUND) {
      throw Hdf5Failure("'" + name() + "' is not a table");
    }
    hsize_t rows = 0;
    H5Sget_simple_extent_dims(space.get(), &rows, nullptr);
    rows_ = rows;

    type_ = {H5Tcreate(H5T_COMPOUND, row_bytes_), H5Tclose, name_};
    const h5::Handle all = layout::row_type(table.columns);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const Column& column = table.columns[i];
      const int index = H5Tget_member_index(type.get(), column.name);
      if (index < 0) {
        H5Eclear2(H5E_DEFAULT);
        if (!optional) throw bad_column(column, "is missing");
        missing_.push_back(&column);
        continue;
      }
      const h5::Handle wanted(H5Tget_member_type(all.get(), static_cast<unsigned>(i)), H5Tclose,
                              column.name);
      const h5::Handle found(H5Tget_member_type(type.get(), static_cast<unsigned>(index)), H5Tclose,
                             column.name);
      // Widths may differ (the library converts and clips), kinds and shapes may not.
      if (!same_kind(wanted.get(), found.get())) throw bad_column(column, "is of another type");
      h5::check(H5Tinsert(type_.get(), column.name, column.offset, wanted.get()), column.name);
    }
    if (missing_.size() == table.columns.size()) {
      throw Hdf5Failure("table '" + name() + "' has none of the known columns");
    }
  }

  std::uint64_t rows() const { return rows_; }
  const std::vector<const Column*>& missing() const { return missing_; }

  /// The rows as record.h packs them.
  std::span<const std::uint8_t> read(std::uint64_t first, std::uint64_t count) const {
    std::vector<std::uint8_t>& bytes = scratch_;
    bytes.resize(count * row_bytes_);
    if (count == 0) return bytes;
    const hsize_t start = first;
    const hsize_t rows = count;
    const h5::Handle file_space(H5Dget_space(dataset_.get()), H5Sclose, name_);
    h5::check(
        H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &start, nullptr, &rows, nullptr),
        name_);
    const h5::Handle memory_space(H5Screate_simple(1, &rows, nullptr), H5Sclose, name_);
    h5::check(H5Dread(dataset_.get(), type_.get(), memory_space.get(), file_space.get(),
                      H5P_DEFAULT, bytes.data()),
              ("table '" + name() + "' is damaged").c_str());
    for (const Column* column : missing_) fill(*column, bytes);
    return bytes;
  }

 private:
  std::string name() const { return name_; }

  Hdf5Failure bad_column(const Column& column, const char* what) const {
    return Hdf5Failure("table '" + name() + "': column '" + column.name + "' " + what);
  }

  static bool same_kind(hid_t wanted, hid_t found) {
    const H5T_class_t kind = H5Tget_class(wanted);
    if (H5Tget_class(found) != kind) return false;
    if (kind != H5T_ARRAY) return true;
    hsize_t wanted_count = 0;
    hsize_t found_count = 0;
    if (H5Tget_array_ndims(found) != 1) return false;
    H5Tget_array_dims2(wanted, &wanted_count);
    H5Tget_array_dims2(found, &found_count);
    const h5::Handle wanted_element(H5Tget_super(wanted), H5Tclose, "array");
    const h5::Handle found_element(H5Tget_super(found), H5Tclose, "array");
    return wanted_count == found_count &&
           H5Tget_class(wanted_element.get()) == H5Tget_class(found_element.get());
  }

  /// NaN says "not recorded" where a number can say so.
  void fill(const Column& column, std::vector<std::uint8_t>& bytes) const {
    std::array<std::uint8_t, 8> value{};
    if (column.type == ColumnType::kDouble) value = {0, 0, 0, 0, 0, 0, 0xF8, 0x7F};
    for (std::size_t at = column.offset; at < bytes.size(); at += row_bytes_) {
      std::memcpy(&bytes[at], value.data(), element_bytes(column.type));
    }
  }

  const char* name_;
  std::size_t row_bytes_;
  h5::Handle dataset_;
  h5::Handle type_;
  std::uint64_t rows_ = 0;
  std::vector<const Column*> missing_;
  mutable std::vector<std::uint8_t> scratch_;
};

HeightMap read_map(hid_t group, const char* name) {
  const h5::Handle dataset(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, name);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose, name);
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose, name);
  std::array<hsize_t, 2> size{};
  if (H5Sget_simple_extent_ndims(space.get()) != 2 || H5Tget_class(type.get()) != H5T_INTEGER) {
    throw Hdf5Failure(std::string("terrain '") + name + "' is not a grid of integers");
  }
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  HeightMap map;
  map.geometry = layout::read_geometry(dataset.get(), size[1], size[0]);
  map.heights.resize(size[0] * size[1]);
  h5::check(
      H5Dread(dataset.get(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, map.heights.data()),
      (std::string("terrain '") + name + "' is damaged").c_str());
  return map;
}

SphereSet read_spheres(hid_t group, const char* name) {
  const h5::Handle dataset(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, name);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose, name);
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose, name);
  std::array<hsize_t, 2> size{};
  if (H5Sget_simple_extent_ndims(space.get()) == 2) {
    H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  }
  if (size[1] != 3 || H5Tget_class(type.get()) != H5T_FLOAT) {
    throw Hdf5Failure(std::string("particles '") + name + "' are no rows of x, y, z");
  }
  SphereSet set;
  set.radius_m = h5::read_double(dataset.get(), layout::kParticleRadius);
  set.centers_m.resize(size[0]);
  h5::check(
      H5Dread(dataset.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, set.centers_m.data()),
      (std::string("particles '") + name + "' are damaged").c_str());
  return set;
}

}  // namespace

class SessionReader::Impl {
 public:
  explicit Impl(std::filesystem::path path)
      : path_(std::move(path)),
        file_(open_checked(path_, running_)),
        info_(read_info(file_.get(), missing_parameters_)),
        frames_(file_.get(), layout::kFramesTable, true),
        samples_(file_.get(), layout::kSamplesTable, false),
        outputs_(file_.get(), layout::kOutputsTable, false),
        heights_(HeightSeriesReader::open(file_.get())) {
    for (const Column* column : frames_.missing()) missing_columns_.emplace_back(column->name);
    // A run that was killed may have written one table further than another.
    rows_ = std::min({frames_.rows(), samples_.rows(), outputs_.rows()});
    if (heights_) rows_ = std::min(rows_, heights_->ticks());
    if (h5::has_attribute(file_.get(), layout::kHashAttribute)) {
      hash_ = h5::read_string(file_.get(), layout::kHashAttribute);
      const std::uint64_t frames = h5::read_uint64(file_.get(), layout::kFramesAttribute);
      if (frames_.rows() != frames || samples_.rows() != frames || outputs_.rows() != frames) {
        throw Hdf5Failure("the tables do not have the " + std::to_string(frames) +
                          " rows they should have");
      }
      if (heights_ && heights_->ticks() != frames) {
        throw Hdf5Failure("the recorded heights do not have the " + std::to_string(frames) +
                          " ticks they should have");
      }
    }
  }

  const std::filesystem::path& path() const { return path_; }
  bool running() const { return running_ && hash_.empty(); }
  const SessionInfo& info() const { return info_; }
  std::uint64_t frames() const { return rows_; }
  const std::string& hash() const { return hash_; }
  const std::vector<std::string>& missing_columns() const { return missing_columns_; }
  const std::vector<std::string>& missing_parameters() const { return missing_parameters_; }

  template <std::size_t kBytes, class Row>
  void read(const StoredTable& table, std::uint64_t first, std::span<Row> rows) const {
    if (first > rows_ || rows.size() > rows_ - first) {
      throw std::out_of_range("a session was read behind its last row");
    }
    const auto bytes = table.read(first, rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      unpack(bytes.subspan(i * kBytes).template first<kBytes>(), rows[i]);
      check_radio(rows[i], first + i);
    }
  }

  const StoredTable& frame_table() const { return frames_; }
  const StoredTable& sample_table() const { return samples_; }
  const StoredTable& output_table() const { return outputs_; }

  std::optional<HeightMap> terrain(const char* name) const {
    if (!h5::has_link(file_.get(), layout::kTerrainGroup)) return std::nullopt;
    const h5::Handle group(H5Gopen2(file_.get(), layout::kTerrainGroup, H5P_DEFAULT), H5Gclose,
                           "cannot read group 'terrain'");
    if (!h5::has_link(group.get(), name)) return std::nullopt;
    return read_map(group.get(), name);
  }

  std::optional<SphereSet> particles(const char* name) const {
    if (!h5::has_link(file_.get(), layout::kParticlesGroup)) return std::nullopt;
    const h5::Handle group(H5Gopen2(file_.get(), layout::kParticlesGroup, H5P_DEFAULT), H5Gclose,
                           "cannot read group 'particles'");
    if (!h5::has_link(group.get(), name)) return std::nullopt;
    return read_spheres(group.get(), name);
  }

  std::vector<LevelingPoint> leveling() const {
    if (!h5::has_link(file_.get(), layout::kLevelingTable.dataset)) return {};
    const StoredTable table(file_.get(), layout::kLevelingTable, true);
    constexpr std::uint64_t kAtStartAndEnd = 2;
    if (table.rows() > rows_ + kAtStartAndEnd)
      throw Hdf5Failure("the leveling curve has more points than the run has ticks");
    std::vector<LevelingPoint> points(table.rows());
    const auto bytes = table.read(0, table.rows());
    if (!points.empty()) std::memcpy(points.data(), bytes.data(), bytes.size());
    return points;
  }

  HeightSeriesReader* heights() { return heights_ ? &*heights_ : nullptr; }

  std::string compute_hash() {
    SessionHash hash(info_);
    for (std::uint64_t first = 0; first < rows_; first += kBlockRows) {
      const std::uint64_t count = std::min(kBlockRows, rows_ - first);
      hash.add_frames(frames_.read(first, count));
      hash.add_samples(samples_.read(first, count));
      hash.add_outputs(outputs_.read(first, count));
    }
    if (const auto map = terrain(layout::kTerrainBefore)) hash.set_terrain_before(map->view());
    if (const auto map = terrain(layout::kTerrainAfter)) hash.set_terrain_after(map->view());
    if (heights_) hash.set_heights(heights_->hash());
    return hash.hex(rows_);
  }

 private:
  static h5::Handle open_checked(const std::filesystem::path& path, bool& running) {
    h5::Handle file = open_file(path, running);
    check_format(file.get());
    return file;
  }

  static void check_radio(const SimFrame&, std::uint64_t) {}
  static void check_radio(const SensorSample& sample, std::uint64_t row) {
    check_count(sample.radio_in_count, kRadioInCapacity, "samples", row);
  }
  static void check_radio(const RobotOutput& output, std::uint64_t row) {
    check_count(output.radio_out_count, kRadioOutCapacity, "outputs", row);
  }
  static void check_count(std::uint8_t count, std::uint8_t most, const char* table,
                          std::uint64_t row) {
    if (count <= most) return;
    throw Hdf5Failure("table '" + std::string(table) + "', row " + std::to_string(row) + ": " +
                      std::to_string(count) + " radio bytes; at most " + std::to_string(most) +
                      " are possible");
  }

  std::filesystem::path path_;
  bool running_ = false;
  h5::Handle file_;
  std::vector<std::string> missing_columns_;
  std::vector<std::string> missing_parameters_;
  SessionInfo info_;
  StoredTable frames_;
  StoredTable samples_;
  StoredTable outputs_;
  std::optional<HeightSeriesReader> heights_;
  std::uint64_t rows_ = 0;
  std::string hash_;
};

SessionReader::SessionReader(const std::filesystem::path& file)
    : impl_(or_input_error(file, [&] { return std::make_unique<Impl>(file); })) {}

SessionReader::SessionReader(SessionReader&&) noexcept = default;
SessionReader& SessionReader::operator=(SessionReader&&) noexcept = default;
SessionReader::~SessionReader() = default;

const SessionInfo& SessionReader::info() const {
  return impl_->info();
}
std::uint64_t SessionReader::frames() const {
  return impl_->frames();
}
bool SessionReader::running() const {
  return impl_->running();
}

bool SessionReader::complete() const {
  return !impl_->hash().empty();
}
const std::string& SessionReader::content_hash() const {
  return impl_->hash();
}

const std::vector<std::string>& SessionReader::missing_columns() const {
  return impl_->missing_columns();
}

const std::vector<std::string>& SessionReader::missing_parameters() const {
  return impl_->missing_parameters();
}

void SessionReader::read(std::uint64_t first, std::span<SimFrame> rows) const {
  or_input_error(impl_->path(),
                 [&] { impl_->read<kFrameBytes>(impl_->frame_table(), first, rows); });
}

void SessionReader::read(std::uint64_t first, std::span<SensorSample> rows) const {
  or_input_error(impl_->path(),
                 [&] { impl_->read<kSampleBytes>(impl_->sample_table(), first, rows); });
}

void SessionReader::read(std::uint64_t first, std::span<RobotOutput> rows) const {
  or_input_error(impl_->path(),
                 [&] { impl_->read<kOutputBytes>(impl_->output_table(), first, rows); });
}

std::optional<HeightMap> SessionReader::terrain_before() const {
  return or_input_error(impl_->path(), [&] { return impl_->terrain(layout::kTerrainBefore); });
}

std::optional<HeightMap> SessionReader::terrain_after() const {
  return or_input_error(impl_->path(), [&] { return impl_->terrain(layout::kTerrainAfter); });
}

std::optional<SphereSet> SessionReader::particles_before() const {
  return or_input_error(impl_->path(), [&] { return impl_->particles(layout::kParticlesBefore); });
}

std::optional<SphereSet> SessionReader::particles_after() const {
  return or_input_error(impl_->path(), [&] { return impl_->particles(layout::kParticlesAfter); });
}

std::vector<LevelingPoint> SessionReader::leveling() const {
  return or_input_error(impl_->path(), [&] { return impl_->leveling(); });
}

bool SessionReader::has_heights() const {
  return impl_->heights() != nullptr;
}

std::uint64_t SessionReader::height_changes() const {
  return has_heights() ? impl_->heights()->changes() : 0;
}

const HeightMap& SessionReader::heights_after(std::uint64_t ticks) const {
  return or_input_error(impl_->path(),
                        [&]() -> const HeightMap& { return impl_->heights()->after(ticks); });
}

HeightExtremes SessionReader::height_extremes() const {
  return or_input_error(impl_->path(), [&] { return impl_->heights()->extremes(); });
}

std::string SessionReader::compute_content_hash() const {
  return or_input_error(impl_->path(), [&] { return impl_->compute_hash(); });
}

}  // namespace screed
