// CSV by std::to_chars: exact, independent of the locale, and several times faster than streams.
#include "host_sim/run/session/csv_export.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/core/atomic_file.h"
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

}  // namespace screed
