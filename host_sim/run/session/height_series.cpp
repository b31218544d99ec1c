// Key frames and changes in HDF5.
#include "host_sim/run/session/height_series.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "host_sim/run/session/session_layout.h"

namespace screed {
namespace {

using h5::Hdf5Failure;

constexpr hsize_t kChangeChunk = 1U << 16;
constexpr hsize_t kTickChunk = 4096;
constexpr hsize_t kTile = 128;
constexpr std::uint64_t kReadTicks = 256;  // of a scan over the whole series

h5::Handle growing(hid_t group, const char* name, hid_t type, hsize_t chunk) {
  const hsize_t none = 0;
  const hsize_t limit = H5S_UNLIMITED;
  const h5::Handle space(H5Screate_simple(1, &none, &limit), H5Sclose, name);
  const h5::Handle options = layout::compressed(std::array<hsize_t, 1>{chunk});
  return {H5Dcreate2(group, name, type, space.get(), H5P_DEFAULT, options.get(), H5P_DEFAULT),
          H5Dclose, name};
}

template <class T>
void append_to(const h5::Handle& dataset, hsize_t first, hid_t type, const std::vector<T>& values,
               const char* name) {
  if (values.empty()) return;
  const hsize_t count = values.size();
  const hsize_t total = first + count;
  h5::check(H5Dset_extent(dataset.get(), &total), name);
  const h5::Handle file_space(H5Dget_space(dataset.get()), H5Sclose, name);
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &first, nullptr, &count, nullptr),
            name);
  const h5::Handle memory_space(H5Screate_simple(1, &count, nullptr), H5Sclose, name);
  h5::check(H5Dwrite(dataset.get(), type, memory_space.get(), file_space.get(), H5P_DEFAULT,
                     values.data()),
            name);
}

[[noreturn]] void damaged(const std::string& what) {
  throw Hdf5Failure("the recorded heights are damaged: " + what);
}

h5::Handle open_dataset(hid_t group, const char* name) {
  if (!h5::has_link(group, name)) damaged(std::string("'") + name + "' is missing");
  return {H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, name};
}

std::uint64_t length_of(const h5::Handle& dataset, const char* name) {
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose, name);
  const h5::Handle type(H5Dget_type(dataset.get()), H5Tclose, name);
  if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Tget_class(type.get()) != H5T_INTEGER)
    damaged(std::string("'") + name + "' is not a row of integers");
  hsize_t length = 0;
  H5Sget_simple_extent_dims(space.get(), &length, nullptr);
  return length;
}

template <class T>
void read_range(const h5::Handle& dataset, hsize_t first, hid_t type, std::vector<T>& values,
                const char* name) {
  if (values.empty()) return;
  const hsize_t count = values.size();
  const h5::Handle file_space(H5Dget_space(dataset.get()), H5Sclose, name);
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &first, nullptr, &count, nullptr),
            name);
  const h5::Handle memory_space(H5Screate_simple(1, &count, nullptr), H5Sclose, name);
  h5::check(H5Dread(dataset.get(), type, memory_space.get(), file_space.get(), H5P_DEFAULT,
                    values.data()),
            (std::string("recorded heights, '") + name + "'").c_str());
}

std::vector<std::uint64_t> read_all(hid_t group, const char* name) {
  const h5::Handle dataset = open_dataset(group, name);
  constexpr std::uint64_t kMax = 1U << 28;
  const std::uint64_t length = length_of(dataset, name);
  if (length > kMax) damaged(std::string("'") + name + "' has an impossible length");
  std::vector<std::uint64_t> values(length);
  read_range(dataset, 0, H5T_NATIVE_UINT64, values, name);
  return values;
}

void add_to_hash(ContentHash& hash, std::span<const std::uint32_t> nodes,
                 std::span<const std::int32_t> changes) {
  hash.add(static_cast<std::uint64_t>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    hash.add(nodes[i]);
    hash.add(changes[i]);
  }
}

}  // namespace

HeightSeriesWriter::HeightSeriesWriter(hid_t file, const HeightMapView& first)
    : group_(layout::create_group(file, layout::kHeightsGroup)),
      geometry_(first.geometry),
      map_(first.heights.begin(), first.heights.end()) {
  constexpr const char* kName = layout::kHeightKeys;
  const std::array<hsize_t, 3> none{0, geometry_.ny, geometry_.nx};
  const std::array<hsize_t, 3> limit{H5S_UNLIMITED, geometry_.ny, geometry_.nx};
  const std::array<hsize_t, 3> chunk{1, std::min<hsize_t>(geometry_.ny, kTile),
                                     std::min<hsize_t>(geometry_.nx, kTile)};
  const h5::Handle space(H5Screate_simple(3, none.data(), limit.data()), H5Sclose, kName);
  const h5::Handle options = layout::compressed(chunk);
  keys_ = {H5Dcreate2(group_.get(), kName, H5T_STD_I32LE, space.get(), H5P_DEFAULT, options.get(),
                      H5P_DEFAULT),
           H5Dclose, kName};
  layout::write_geometry(keys_.get(), geometry_);
  key_ticks_ = growing(group_.get(), layout::kHeightKeyTicks, H5T_STD_U64LE, kTickChunk);
  nodes_ = growing(group_.get(), layout::kHeightNodes, H5T_STD_U32LE, kChangeChunk);
  changes_ = growing(group_.get(), layout::kHeightChanges, H5T_STD_I32LE, kChangeChunk);
  ends_ = growing(group_.get(), layout::kHeightEnds, H5T_STD_U64LE, kTickChunk);
  hash_.add(layout::map_hash(first));
  write_key();
}

void HeightSeriesWriter::write_key() {
  constexpr const char* kName = layout::kHeightKeys;
  const std::array<hsize_t, 3> first{key_count_, 0, 0};
  const std::array<hsize_t, 3> count{1, geometry_.ny, geometry_.nx};
  const std::array<hsize_t, 3> total{key_count_ + 1, geometry_.ny, geometry_.nx};
  h5::check(H5Dset_extent(keys_.get(), total.data()), kName);
  const h5::Handle file_space(H5Dget_space(keys_.get()), H5Sclose, kName);
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, first.data(), nullptr,
                                count.data(), nullptr),
            kName);
  const h5::Handle memory_space(H5Screate_simple(3, count.data(), nullptr), H5Sclose, kName);
  h5::check(H5Dwrite(keys_.get(), H5T_NATIVE_INT32, memory_space.get(), file_space.get(),
                     H5P_DEFAULT, map_.data()),
            kName);
  append_to(key_ticks_, key_count_, H5T_NATIVE_UINT64, std::vector<std::uint64_t>{ticks_},
            layout::kHeightKeyTicks);
  ++key_count_;
  changes_at_key_ = changes_count_;
}

void HeightSeriesWriter::append(std::span<const HeightChange> changes) {
  const std::size_t begin = waiting_nodes_.size();
  for (const HeightChange& change : changes) {
    map_[change.node] += change.by;
    waiting_nodes_.push_back(change.node);
    waiting_changes_.push_back(change.by);
  }
  changes_count_ += changes.size();
  waiting_ends_.push_back(changes_count_);
  ++ticks_;
  add_to_hash(hash_, std::span(waiting_nodes_).subspan(begin),
              std::span(waiting_changes_).subspan(begin));
  // A bed at rest needs no further key frame.
  if (ticks_ % kKeyInterval == 0 && changes_count_ != changes_at_key_) write_key();
}

void HeightSeriesWriter::write() {
  append_to(nodes_, written_changes_, H5T_NATIVE_UINT32, waiting_nodes_, layout::kHeightNodes);
  append_to(changes_, written_changes_, H5T_NATIVE_INT32, waiting_changes_, layout::kHeightChanges);
  append_to(ends_, written_ticks_, H5T_NATIVE_UINT64, waiting_ends_, layout::kHeightEnds);
  written_changes_ += waiting_nodes_.size();
  written_ticks_ += waiting_ends_.size();
  waiting_nodes_.clear();
  waiting_changes_.clear();
  waiting_ends_.clear();
}

void HeightSeriesWriter::close() {
  write();
  keys_.close(layout::kHeightKeys);
  key_ticks_.close(layout::kHeightKeyTicks);
  nodes_.close(layout::kHeightNodes);
  changes_.close(layout::kHeightChanges);
  ends_.close(layout::kHeightEnds);
  group_.close(layout::kHeightsGroup);
}

std::optional<HeightSeriesReader> HeightSeriesReader::open(hid_t file) {
  if (!h5::has_link(file, layout::kHeightsGroup)) return std::nullopt;
  const h5::Handle group(H5Gopen2(file, layout::kHeightsGroup, H5P_DEFAULT), H5Gclose,
                         layout::kHeightsGroup);
  HeightSeriesReader reader;
  reader.keys_ = open_dataset(group.get(), layout::kHeightKeys);
  const h5::Handle space(H5Dget_space(reader.keys_.get()), H5Sclose, layout::kHeightKeys);
  std::array<hsize_t, 3> size{};
  if (H5Sget_simple_extent_ndims(space.get()) != 3) damaged("key frames are not a row of maps");
  H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  reader.map_.geometry = layout::read_geometry(reader.keys_.get(), size[2], size[1]);
  reader.map_.heights.resize(size[1] * size[2]);
  reader.nodes_ = open_dataset(group.get(), layout::kHeightNodes);
  reader.changes_ = open_dataset(group.get(), layout::kHeightChanges);
  reader.ends_ = read_all(group.get(), layout::kHeightEnds);
  reader.key_ticks_ = read_all(group.get(), layout::kHeightKeyTicks);

  const std::uint64_t changes = std::min(length_of(reader.nodes_, layout::kHeightNodes),
                                         length_of(reader.changes_, layout::kHeightChanges));
  // A run that was killed may have written one of the tables further than another.
  while (!reader.ends_.empty() && reader.ends_.back() > changes) reader.ends_.pop_back();
  if (!std::is_sorted(reader.ends_.begin(), reader.ends_.end())) damaged("ticks out of order");
  const std::size_t keys = std::min<std::size_t>(size[0], reader.key_ticks_.size());
  reader.key_ticks_.resize(keys);
  if (keys == 0 || reader.key_ticks_[0] != 0 ||
      !std::is_sorted(reader.key_ticks_.begin(), reader.key_ticks_.end()))
    damaged("no key frame to begin with");
  return reader;
}

void HeightSeriesReader::read_key(std::size_t key) {
  at_.reset();
  const std::array<hsize_t, 3> first{key, 0, 0};
  const std::array<hsize_t, 3> count{1, map_.geometry.ny, map_.geometry.nx};
  const h5::Handle file_space(H5Dget_space(keys_.get()), H5Sclose, layout::kHeightKeys);
  h5::check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, first.data(), nullptr,
                                count.data(), nullptr),
            layout::kHeightKeys);
  const h5::Handle memory_space(H5Screate_simple(3, count.data(), nullptr), H5Sclose,
                                layout::kHeightKeys);
  h5::check(H5Dread(keys_.get(), H5T_NATIVE_INT32, memory_space.get(), file_space.get(),
                    H5P_DEFAULT, map_.heights.data()),
            "recorded heights, a key frame");
  at_ = key_ticks_[key];
}

void HeightSeriesReader::read_changes(std::uint64_t begin, std::uint64_t end) {
  const std::uint64_t first = begin == 0 ? 0 : ends_[begin - 1];
  const std::uint64_t count = (end == 0 ? 0 : ends_[end - 1]) - first;
  read_nodes_.resize(count);
  read_changes_.resize(count);
  read_range(nodes_, first, H5T_NATIVE_UINT32, read_nodes_, layout::kHeightNodes);
  read_range(changes_, first, H5T_NATIVE_INT32, read_changes_, layout::kHeightChanges);
  for (const std::uint32_t node : read_nodes_) {
    if (node >= map_.heights.size()) damaged("a change outside of the map");
  }
}

const HeightMap& HeightSeriesReader::after(std::uint64_t ticks) {
  if (ticks > ends_.size()) throw std::out_of_range("heights were read behind the last tick");
  const auto behind = std::upper_bound(key_ticks_.begin(), key_ticks_.end(), ticks);
  const auto key = static_cast<std::size_t>(behind - key_ticks_.begin()) - 1;
  if (!at_.has_value() || *at_ > ticks || *at_ < key_ticks_[key]) read_key(key);
  while (*at_ < ticks) {
    const std::uint64_t next = std::min(ticks, *at_ + kReadTicks);
    read_changes(*at_, next);
    for (std::size_t i = 0; i < read_nodes_.size(); ++i) {
      std::int32_t& height = map_.heights[read_nodes_[i]];
      // Modulo 2^32: a damaged file is no undefined behaviour.
      height = static_cast<std::int32_t>(static_cast<std::uint32_t>(height) +
                                         static_cast<std::uint32_t>(read_changes_[i]));
    }
    at_ = next;
  }
  return map_;
}

HeightExtremes HeightSeriesReader::extremes() {
  const std::vector<std::int32_t>& heights = after(0).heights;
  const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
  HeightExtremes found{*lowest, *highest};
  for (std::uint64_t tick = 0; tick < ticks();) {
    const std::uint64_t next = std::min(ticks(), tick + kReadTicks);
    // In single ticks: a height may rise and fall again between two looks.
    read_changes(tick, next);
    for (std::size_t i = 0; i < read_nodes_.size(); ++i) {
      std::int32_t& height = map_.heights[read_nodes_[i]];
      height = static_cast<std::int32_t>(static_cast<std::uint32_t>(height) +
                                         static_cast<std::uint32_t>(read_changes_[i]));
      found.lowest = std::min(found.lowest, height);
      found.highest = std::max(found.highest, height);
    }
    at_ = tick = next;
  }
  return found;
}

std::string HeightSeriesReader::hash() {
  ContentHash hash;
  hash.add(layout::map_hash(after(0).view()));
  for (std::uint64_t tick = 0; tick < ticks(); tick += kReadTicks) {
    const std::uint64_t end = std::min(ticks(), tick + kReadTicks);
    read_changes(tick, end);
    const std::uint64_t first = tick == 0 ? 0 : ends_[tick - 1];
    for (std::uint64_t i = tick; i < end; ++i) {
      const std::uint64_t begin = (i == 0 ? 0 : ends_[i - 1]) - first;
      const std::uint64_t count = ends_[i] - first - begin;
      add_to_hash(hash, std::span(read_nodes_).subspan(begin, count),
                  std::span(read_changes_).subspan(begin, count));
    }
  }
  return hash.hex();
}

}  // namespace screed
