// Frames out of runs, and recordings in HDF5.
#include "host_sim/grid/grid_recording.h"

#include <algorithm>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/grid/grid_run.h"

namespace screed {

uint64_t GridFrame::carried() const {
  return static_cast<uint64_t>(std::count_if(
      agents.begin(), agents.end(), [](const FrameAgent& agent) { return agent.carries; }));
}

GridFrame frame_of(const GridRun& run) {
  GridFrame frame{run.world().terrain(), {}, run.cycles(), run.swarm().counts().units};
  for (size_t i = 0; i < run.swarm().size(); ++i) {
    const AgentView view = run.swarm().view(i);
    frame.agents.push_back({run.world().x(view.place), run.world().y(view.place), view.carries});
  }
  return frame;
}

namespace {

constexpr const char* kRecordingFormat = "screed grid run";
constexpr uint64_t kRecordingFormatVersion = 1;
constexpr uint64_t kChunkCycles = 1024;

h5::Handle simple_space(std::initializer_list<hsize_t> size) {
  return {H5Screate_simple(static_cast<int>(size.size()), size.begin(), nullptr), H5Sclose,
          "cannot create a data space"};
}

/// A table [0.., agents] that grows, compressed.
h5::Handle growing_table(hid_t file, const char* name, hid_t type, hsize_t agents) {
  const hsize_t size[2] = {0, agents};
  const hsize_t most[2] = {H5S_UNLIMITED, agents};
  const h5::Handle space(H5Screate_simple(2, size, most), H5Sclose, name);
  const h5::Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  // About 256 kB a chunk at most, however many agents there are.
  const hsize_t rows = std::clamp<hsize_t>(65536 / std::max<hsize_t>(1, agents), 1, kChunkCycles);
  const hsize_t chunk[2] = {rows, agents};
  h5::check(H5Pset_chunk(creation.get(), 2, chunk), name);
  h5::check(H5Pset_shuffle(creation.get()), name);
  h5::check(H5Pset_deflate(creation.get(), 4), name);
  h5::check(H5Pset_fletcher32(creation.get()), name);
  return {H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
          H5Dclose, name};
}

template <class T>
void append_rows(const h5::Handle& table, hid_t type, hsize_t& rows, hsize_t agents,
                 std::vector<T>& buffer) {
  if (buffer.empty() || agents == 0) return;
  const hsize_t added = buffer.size() / agents;
  const hsize_t size[2] = {rows + added, agents};
  h5::check(H5Dset_extent(table.get(), size), "cannot extend a table");
  const h5::Handle file_space(H5Dget_space(table.get()), H5Sclose, "cannot append");
  const hsize_t start[2] = {rows, 0};
  const hsize_t count[2] = {added, agents};
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr),
            "cannot append");
  const h5::Handle memory_space = simple_space({added, agents});
  h5::check(
      H5Dwrite(table.get(), type, memory_space.get(), file_space.get(), H5P_DEFAULT, buffer.data()),
      "cannot append");
  rows += added;
  buffer.clear();
}

void write_heights(hid_t file, const char* name, const GridTerrain& terrain) {
  const h5::Handle space =
      simple_space({static_cast<hsize_t>(terrain.height), static_cast<hsize_t>(terrain.width)});
  const h5::Handle table(
      H5Dcreate2(file, name, H5T_STD_U16LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, name);
  h5::check(H5Dwrite(table.get(), H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                     terrain.heights.data()),
            name);
}

/// A whole table of two dimensions.
template <class T>
std::vector<T> read_table(hid_t file, const char* name, hid_t type, hsize_t (&size)[2]) {
  if (!h5::has_link(file, name)) throw h5::Hdf5Failure(std::string("no table '") + name + "'");
  const h5::Handle table(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
  const h5::Handle space(H5Dget_space(table.get()), H5Sclose, name);
  if (H5Sget_simple_extent_ndims(space.get()) != 2) {
    throw h5::Hdf5Failure(std::string("table '") + name + "' is not of two dimensions");
  }
  H5Sget_simple_extent_dims(space.get(), size, nullptr);
  constexpr hsize_t kMax = hsize_t{1} << 31;
  if (size[1] != 0 && size[0] > kMax / size[1]) {
    throw h5::Hdf5Failure(std::string("table '") + name + "' is too large");
  }
  std::vector<T> values(size[0] * size[1]);
  h5::check(H5Dread(table.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  return values;
}

}  // namespace

struct GridRecorder::File {
  explicit File(const std::filesystem::path& path) : place(path) {}

  PartialFile place;  ///< the first: removed when the library has closed it
  h5::Handle file;
  h5::Handle places_table;
  h5::Handle operations_table;
  hsize_t agents = 0;
  hsize_t place_rows = 0;
  hsize_t operation_rows = 0;
  std::vector<uint32_t> places;
  std::vector<uint8_t> operations;

  /// Errors of the library as one line with the file's name.
  template <class Work>
  void guarded(Work work) {
    try {
      work();
    } catch (const h5::Hdf5Failure& failure) {
      throw RunError(place.path().string() + ": " + failure.what());
    }
  }

  void add_places(const GridRun& run) {
    const auto columns = static_cast<uint32_t>(run.world().width());
    for (size_t i = 0; i < agents; ++i) {
      const GridPlace at = run.swarm().view(i).place;
      places.push_back(static_cast<uint32_t>(run.world().y(at)) * columns +
                       static_cast<uint32_t>(run.world().x(at)));
    }
  }

  void flush() {
    append_rows(places_table, H5T_NATIVE_UINT32, place_rows, agents, places);
    append_rows(operations_table, H5T_NATIVE_UINT8, operation_rows, agents, operations);
  }
};

GridRecorder::GridRecorder(const std::filesystem::path& path, const GridRun& run,
                           const std::string& program_version)
    : file_(std::make_unique<File>(path)) {
  File& f = *file_;
  f.agents = run.swarm().size();
  if (std::filesystem::exists(path)) {
    throw InputError(path.string() + ": exists already; name another file to record to");
  }
  h5::begin();
  f.guarded([&] {
    f.file =
        h5::Handle(H5Fcreate(f.place.partial().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                   H5Fclose, "cannot create the file");
    const hid_t id = f.file.get();
    h5::write_attribute(id, "format", std::string(kRecordingFormat));
    h5::write_attribute(id, "format_version", kRecordingFormatVersion);
    h5::write_attribute(id, "program_version", program_version);
    for (const auto& [name, value] : describe(run.config())) {
      h5::write_attribute(id, name.c_str(), value);
    }
    write_heights(id, "heights_before", run.world().terrain());
    f.places_table = growing_table(id, "places", H5T_STD_U32LE, f.agents);
    f.operations_table = growing_table(id, "operations", H5T_STD_U8LE, f.agents);
  });
  f.add_places(run);
}

GridRecorder::~GridRecorder() = default;

void GridRecorder::add_cycle(const GridRun& run) {
  File& f = *file_;
  for (size_t i = 0; i < f.agents; ++i) {
    f.operations.push_back(static_cast<uint8_t>(run.swarm().view(i).last_operation));
  }
  f.add_places(run);
  if (f.operations.size() >= kChunkCycles * f.agents) f.guarded([&] { f.flush(); });
}

void GridRecorder::finish(const GridRun& run) {
  File& f = *file_;
  f.guarded([&] {
    f.flush();
    write_heights(f.file.get(), "heights_after", run.world().terrain());
    h5::write_attribute(f.file.get(), "cycles", run.cycles());
    h5::write_attribute(f.file.get(), "units", run.swarm().counts().units);
    f.places_table.close("cannot save");
    f.operations_table.close("cannot save");
    f.file.close("cannot save");
  });
  f.place.commit();
}

GridReplay::GridReplay(const std::filesystem::path& path) : path_(path) {
  const auto refuse = [&](const std::string& why) { throw InputError(path.string() + ": " + why); };
  h5::begin();
  try {
    const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                          "cannot be read as HDF5");
    if (!h5::has_attribute(file.get(), "format") ||
        h5::read_string(file.get(), "format") != kRecordingFormat) {
      refuse("is not a recording of `screed grid --record`");
    }
    if (const uint64_t version = h5::read_uint64(file.get(), "format_version");
        version != kRecordingFormatVersion) {
      refuse("has format version " + std::to_string(version) + "; this program reads " +
             std::to_string(kRecordingFormatVersion));
    }
    for (const auto& [name, unused] : describe(GridConfig())) {
      values_.emplace_back(name, h5::read_string(file.get(), name.c_str()));
    }
    hsize_t grid[2];
    hsize_t grid_after[2];
    hsize_t places[2];
    hsize_t operations[2];
    frame_.terrain.heights =
        read_table<uint16_t>(file.get(), "heights_before", H5T_NATIVE_UINT16, grid);
    after_ = read_table<uint16_t>(file.get(), "heights_after", H5T_NATIVE_UINT16, grid_after);
    places_ = read_table<uint32_t>(file.get(), "places", H5T_NATIVE_UINT32, places);
    operations_ = read_table<uint8_t>(file.get(), "operations", H5T_NATIVE_UINT8, operations);
    if (places[0] != operations[0] + 1 || places[1] != operations[1] || places[1] == 0 ||
        grid[0] == 0 || grid[1] == 0 || grid[0] > kLargestGridSide || grid[1] > kLargestGridSide ||
        grid_after[0] != grid[0] || grid_after[1] != grid[1]) {
      refuse("its tables do not fit together");
    }
    frame_.terrain.height = static_cast<int>(grid[0]);
    frame_.terrain.width = static_cast<int>(grid[1]);
    cycles_ = operations[0];
    agents_ = places[1];
  } catch (const h5::Hdf5Failure& failure) {
    refuse(failure.what());
  }
  if (std::any_of(places_.begin(), places_.end(),
                  [this](uint32_t place) { return place >= frame_.terrain.heights.size(); })) {
    refuse("an agent stands outside the grid");
  }
  frame_.agents.resize(agents_, FrameAgent{0, 0, false});
  place_agents();
}

const std::string& GridReplay::value(const std::string& name) const {
  const auto found = std::find_if(values_.begin(), values_.end(),
                                  [&](const auto& value) { return value.first == name; });
  if (found == values_.end()) throw InputError(path_.string() + ": has no value '" + name + "'");
  return found->second;
}

void GridReplay::place_agents() {
  const auto columns = static_cast<uint32_t>(frame_.terrain.width);
  for (size_t i = 0; i < agents_; ++i) {
    const uint32_t place = places_[frame_.cycle * agents_ + i];
    frame_.agents[i].x = static_cast<int>(place % columns);
    frame_.agents[i].y = static_cast<int>(place / columns);
  }
}

void GridReplay::cycle() {
  for (size_t i = 0; i < agents_; ++i) {
    const size_t entry = frame_.cycle * agents_ + i;
    const auto operation = static_cast<GridOperation>(operations_[entry]);
    if (operation == GridOperation::kNone) continue;
    uint16_t& stack = frame_.terrain.heights[places_[entry]];
    FrameAgent& agent = frame_.agents[i];
    const bool takes = operation == GridOperation::kPickUp;
    if (takes ? (stack == 0 || agent.carries)
              : (operation != GridOperation::kDeposit || stack >= kMaxStackHeight ||
                 !agent.carries)) {
      throw InputError(path_.string() + ": cycle " + std::to_string(frame_.cycle) + ", agent " +
                       std::to_string(i) + ": an operation that is not possible");
    }
    stack = static_cast<uint16_t>(takes ? stack - 1 : stack + 1);
    agent.carries = takes;
    if (takes) ++frame_.units;
  }
  ++frame_.cycle;
  place_agents();
}

}  // namespace screed
