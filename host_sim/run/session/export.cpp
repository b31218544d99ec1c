// CSV by std::to_chars: exact, independent of the locale, and several times faster than streams.
#include "host_sim/run/session/export.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "schema/values.h"

namespace screed {

namespace {

constexpr std::uint64_t kCsvBlockRows = 1024;
constexpr std::size_t kNumberChars = 32;  // longest shortest double is 24 characters

std::string header(std::span<const Column> columns, bool numbered) {
  std::string line = numbered ? "frame" : "";
  for (const Column& column : columns) {
    if (!line.empty()) line += ',';
    line += column.name;
    if (*column.unit != '\0') line += std::string(" [") + column.unit + "]";
  }
  return line + "\n";
}

template <class T>
char* put(char* cursor, T value) {
  cursor = std::to_chars(cursor, cursor + kNumberChars, value).ptr;
  *cursor++ = ',';
  return cursor;
}

template <class T>
T taken_from(const std::uint8_t* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(value));  // rows are little endian, and so are our hosts
  return value;
}

char* put_line(char* cursor, std::span<const Column> columns, const SimFrame& frame) {
  std::array<std::uint8_t, kFrameBytes> row{};
  pack(frame, row);
  for (const Column& column : columns) {
    const std::uint8_t* bytes = &row[column.offset];
    cursor = column.type == ColumnType::kDouble ? put(cursor, taken_from<double>(bytes))
                                                : put(cursor, taken_from<std::int32_t>(bytes));
  }
  cursor[-1] = '\n';
  return cursor;
}

void write_rows(const SessionReader& session, std::span<const Column> columns,
                const FrameRange& range, bool numbered, AtomicFile& file,
                const TaskProgress& progress) {
  file.write(header(columns, numbered));
  std::vector<SimFrame> frames;
  std::vector<char> text(kCsvBlockRows * (columns.size() + 1) * (kNumberChars + 1));
  for (std::uint64_t done = 0; done < range.count; done += kCsvBlockRows) {
    report_progress(progress, "exporting a table", done, range.count);
    frames.resize(std::min(kCsvBlockRows, range.count - done));
    session.read(range.first + done, std::span(frames));
    char* cursor = text.data();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (numbered) cursor = put(cursor, range.first + done + i);
      cursor = put_line(cursor, columns, frames[i]);
    }
    file.write(std::string_view(text.data(), static_cast<std::size_t>(cursor - text.data())));
  }
}

static_assert(std::all_of(kFrameColumns.begin(), kFrameColumns.end(),
                          [](const Column& column) {
                            return column.type == ColumnType::kDouble ||
                                   column.type == ColumnType::kInt32;
                          }),
              "put_line knows no other type");

}  // namespace

std::span<const Column> table_5_1_columns() {
  static const std::vector<Column> columns = [] {
    std::vector<Column> found;
    for (const char* name : {"x", "y", "delta_x", "delta_y", "delta_theta", "v_left", "v_right",
                             "pitch", "roll", "linear", "angular"}) {
      found.push_back(*std::find_if(
          kFrameColumns.begin(), kFrameColumns.end(),
          [&](const Column& column) { return std::string_view(column.name) == name; }));
    }
    return found;
  }();
  return columns;
}

void export_frames_csv(const SessionReader& session, const std::filesystem::path& csv) {
  AtomicFile file(csv);
  write_rows(session, kFrameColumns, {0, session.frames()}, false, file, {});
  file.commit();
}

void export_leveling_csv(std::span<const LevelingPoint> points, const std::filesystem::path& csv) {
  AtomicFile file(csv);
  file.write(header(kLevelingColumns, false));
  std::array<char, kLevelingColumns.size() * (kNumberChars + 1)> text{};
  for (const LevelingPoint& point : points) {
    char* cursor = text.data();
    for (const Column& column : kLevelingColumns) {
      const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&point);
      cursor = put(cursor, taken_from<double>(bytes + column.offset));
    }
    cursor[-1] = '\n';
    file.write(std::string_view(text.data(), static_cast<std::size_t>(cursor - text.data())));
  }
  file.commit();
}

void export_columns_csv(const SessionReader& session, std::span<const Column> columns,
                        const FrameRange& range, const std::filesystem::path& csv,
                        const TaskProgress& progress) {
  AtomicFile file(csv);
  write_rows(session, columns, range, true, file, progress);
  file.commit();
}

FrameRange training_frames(const SessionReader& session) {
  FrameRange range;
  std::vector<SimFrame> frames;
  bool begun = false;
  for (std::uint64_t first = 0; first < session.frames(); first += kCsvBlockRows) {
    frames.resize(std::min(kCsvBlockRows, session.frames() - first));
    session.read(first, std::span(frames));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].leveling_state !=
          static_cast<std::int32_t>(message::LevelingState::kTrainingDrive))
        continue;
      if (!begun) range.first = first + i;
      begun = true;
      range.count = first + i + 1 - range.first;
    }
  }
  return range;
}

// Image series of recorded heights.

namespace {

namespace fs = std::filesystem;

constexpr double kWhite = 65535.0;

std::string numbered(const char* name, std::uint64_t frame) {
  char number[32];
  std::snprintf(number, sizeof number, "_%06llu.png", static_cast<unsigned long long>(frame));
  return name + std::string(number);
}

void check(const SessionReader& session, const FrameRange& range, std::uint64_t every) {
  if (!session.has_heights()) {
    throw InputError("the session has no recorded heights; sim --heights and record keep them");
  }
  if (range.count == 0 || every == 0) throw InputError("no frame to export");
}

/// Who is told how many of the chosen frames are done, and as what.
struct ExportProgress {
  const TaskProgress& listener;
  const char* task;
};

/// Calls action(frame, map after it) for the chosen frames.
template <class Action>
void for_each_frame(const SessionReader& session, const FrameRange& range, std::uint64_t every,
                    const ExportProgress& progress, Action&& action) {
  for (std::uint64_t i = 0; i < range.count; i += every) {
    report_progress(progress.listener, progress.task, i, range.count);
    action(range.first + i, session.heights_after(range.first + i + 1));
  }
}

/// What a robot has driven since a frame, on its way through the session.
class RecordedPath {
 public:
  RecordedPath(const SessionReader& session, std::uint64_t first)
      : session_(session), first_(first), next_(first) {}

  /// Goes on to a frame, not before the last one. Without a shape there is no outline.
  void go_to(std::uint64_t frame, const std::optional<RobotShape>& shape, PictureRobot& robot) {
    constexpr std::uint64_t kPathFrames = 10;
    frames_.resize(frame + 1 - next_);
    session_.read(next_, std::span(frames_));
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if ((next_ + i - first_) % kPathFrames == 0)
        robot.path.push_back(
            {frames_[i].x, frames_[i].y, static_cast<std::size_t>(frames_[i].leveling_state)});
    }
    const SimFrame& now = frames_.back();
    next_ = frame + 1;
    if (shape) robot.outline = RobotOutline{now.x, now.y, now.yaw, *shape};
  }

 private:
  const SessionReader& session_;
  std::uint64_t first_;
  std::uint64_t next_;
  std::vector<SimFrame> frames_;
};

}  // namespace

HeightField field_of(const HeightMap& map) {
  const HeightMapGeometry& g = map.geometry;
  if (g.unit_m != kHeightUnit_m) {
    throw InputError("the session's heights are in units of " + std::to_string(g.unit_m) +
                     " m; this program knows " + std::to_string(kHeightUnit_m));
  }
  const int nx = static_cast<int>(g.nx);
  HeightField field(nx, static_cast<int>(g.ny), g.spacing_m, g.wrap);
  if (g.walls) field.add_walls();
  for (std::size_t i = 0; i < map.heights.size(); ++i) {
    const int at = static_cast<int>(i);
    field.set_node(at % nx, at / nx, map.heights[i]);
  }
  return field;
}

HeightExport export_heights_png(const SessionReader& session, const FrameRange& range,
                                std::uint64_t every, const fs::path& folder,
                                const TaskProgress& progress) {
  check(session, range, every);
  const HeightExtremes extremes = session.height_extremes();
  const HeightMapGeometry geometry = session.heights_after(0).geometry;
  const double black = extremes.lowest;
  // A level bed is black throughout, of a scale that is no division by zero.
  const double span = std::max(1.0, static_cast<double>(extremes.highest) - black);

  HeightExport done;
  done.scale = {black * geometry.unit_m, (black + span) * geometry.unit_m};
  Json frames = Json::array();
  std::vector<std::uint16_t> samples(std::size_t{geometry.nx} * geometry.ny);
  const ExportProgress told{progress, "exporting heights"};
  PartialFolder partial(folder);
  for_each_frame(session, range, every, told, [&](std::uint64_t frame, const HeightMap& map) {
    for (std::size_t row = 0; row < geometry.ny; ++row) {
      const std::int32_t* heights = &map.heights[(geometry.ny - 1 - row) * geometry.nx];
      for (std::size_t x = 0; x < geometry.nx; ++x) {
        samples[row * geometry.nx + x] =
            static_cast<std::uint16_t>(std::floor((heights[x] - black) / span * kWhite + 0.5));
      }
    }
    const std::string name = numbered("height", frame);
    write_grey16_png(partial.partial() / name, static_cast<int>(geometry.nx),
                     static_cast<int>(geometry.ny), samples);
    done.files.push_back(folder / name);
    frames.push_back({{"frame", frame}, {"file", name}});
  });

  const Json json = {{"meaning", "height in m = black_m + sample * (white_m - black_m) / 65535"},
                     {"black_m", done.scale.black_m},
                     {"white_m", done.scale.white_m},
                     {"m_per_sample_step", span * geometry.unit_m / kWhite},
                     {"m_per_pixel", geometry.spacing_m},
                     {"west_m", geometry.origin_x_m},
                     {"south_m", geometry.origin_y_m},
                     {"top_row", "north"},
                     {"wrap", geometry.wrap},
                     {"walls", geometry.walls},
                     {"frames", frames}};
  write_file(partial.partial() / "scale.json", json.dump(1) + "\n");
  partial.commit();
  return done;
}

std::vector<fs::path> export_pictures(std::span<const SessionReader> sessions,
                                      const FrameRange& range, std::uint64_t every,
                                      const fs::path& folder, const PictureSeries& series,
                                      const TaskProgress& progress) {
  const SessionReader& session = sessions.front();
  check(session, range, every);
  std::vector<fs::path> files;
  PictureOptions options;
  const HeightExtremes extremes = session.height_extremes();
  options.heights = HeightRange{extremes.lowest * kHeightUnit_m, extremes.highest * kHeightUnit_m};
  options.state_names = series.state_names;
  std::vector<RecordedPath> paths;
  for (const SessionReader& robot : sessions) paths.emplace_back(robot, range.first);
  options.robots.resize(paths.size());
  const ExportProgress told{progress, "exporting pictures"};
  PartialFolder partial(folder);
  HeightPainter painter;
  for_each_frame(session, range, every, told, [&](std::uint64_t frame, const HeightMap& map) {
    for (std::size_t i = 0; i < paths.size(); ++i)
      paths[i].go_to(frame, series.shape, options.robots[i]);
    options.title = session.info().experiment_name + ": frame " + std::to_string(frame);
    const std::string name = numbered("picture", frame);
    const HeightField terrain = field_of(map);
    write_height_map_picture(partial.partial() / name,
                             series.surface ? series.surface(terrain) : terrain, options, painter);
    files.push_back(folder / name);
  });
  partial.commit();
  return files;
}

}  // namespace screed
