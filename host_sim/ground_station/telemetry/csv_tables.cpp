// Decoded messages as CSV tables.
#include "host_sim/ground_station/telemetry/csv_tables.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>

#include "host_sim/core/errors.h"

namespace screed {

namespace {

constexpr size_t kBufferBytes = 1U << 16U;
// Sign, 19 digits, point, comma.
constexpr size_t kLongestNumber = 24;

/// Writes a number of at least `least` digits; returns the place behind it.
char* put_digits(char* at, uint64_t value, unsigned least) {
  char digits[24];
  unsigned count = 0;
  do {
    digits[count++] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value > 0);
  while (count < least) digits[count++] = '0';
  while (count > 0) *at++ = digits[--count];
  return at;
}

/// value / 10^decimals.
char* put_decimal(char* at, int64_t value, unsigned decimals) {
  uint64_t size = static_cast<uint64_t>(value);
  if (value < 0) {
    *at++ = '-';
    size = 0 - size;
  }
  if (decimals == 0) return put_digits(at, size, 1);
  char* const end = put_digits(at, size, decimals + 1);
  std::memmove(end - decimals + 1, end - decimals, decimals);
  *(end - decimals) = '.';
  return end + 1;
}

char* put_text(char* at, const char* text) {
  while (*text != '\0') *at++ = *text++;
  return at;
}

}  // namespace

CsvTables::CsvTables(const std::filesystem::path& folder, bool numbers)
    : folder_(folder), numbers_(numbers), tables_(messages().size()) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw RunError(folder.string() + ": cannot be made: " + error.message());
}

void CsvTables::open(Table& table, const MessageInfo& message) const {
  table.path = (folder_ / (std::string(message.title) + ".csv")).string();
  table.file = std::make_unique<AtomicFile>(table.path);
  table.buffer.resize(kBufferBytes);
  std::string header = "time [s],robot";
  table.longest_row = 2 * kLongestNumber;
  for (const SignalInfo& signal : message.signals) {
    if (signal.role != SignalRole::kData) continue;
    table.columns.push_back(&signal);
    header += std::string(",") + signal.name;
    if (signal.unit[0] != '\0') header += std::string(" [") + signal.unit + "]";
    size_t longest = kLongestNumber;
    for (const ValueInfo& value : signal.values) {
      longest = std::max(longest, std::strlen(value.name) + 1);
    }
    table.longest_row += longest;
  }
  header += '\n';
  std::memcpy(table.buffer.data(), header.data(), header.size());
  table.used = header.size();
}

void CsvTables::flush(Table& table) {
  table.file->write(std::string_view(table.buffer.data(), table.used));
  table.used = 0;
}

void CsvTables::add(const DecodedFrame& frame) {
  Table& table = tables_[static_cast<size_t>(frame.message - messages().data())];
  if (table.file == nullptr) open(table, *frame.message);
  if (table.used + table.longest_row > table.buffer.size()) flush(table);
  char* const begin = table.buffer.data() + table.used;
  char* at = put_digits(begin, frame.time_us / 1000000U, 1);
  *at++ = '.';
  at = put_digits(at, frame.time_us % 1000000U, 6);
  *at++ = ',';
  at = put_digits(at, frame.node, 1);
  for (const SignalInfo* signal : table.columns) {
    *at++ = ',';
    const int64_t raw = signal->raw(frame.bits);
    const char* const name = numbers_ ? nullptr : signal->value_name(raw);
    at = name != nullptr ? put_text(at, name)
                         : put_decimal(at, raw * signal->scale + signal->offset, signal->decimals);
  }
  *at++ = '\n';
  table.used += static_cast<size_t>(at - begin);
}

std::vector<std::string> CsvTables::finish() {
  std::vector<std::string> names;
  for (Table& table : tables_) {
    if (table.file == nullptr) continue;
    flush(table);
    names.push_back(table.path);
  }
  for (const Table& table : tables_) {
    if (table.file != nullptr) table.file->commit();
  }
  return names;
}

namespace {

std::string cell(const std::optional<double>& slip) {
  if (!slip.has_value()) return ",";
  char text[16];
  std::snprintf(text, sizeof text, ",%.3f", *slip);
  return text;
}

}  // namespace

TrackSlipTable::TrackSlipTable(const std::filesystem::path& folder, const BoardConstants& board)
    : path_(folder / "track_slip.csv"), board_(board) {}

void TrackSlipTable::add(const DecodedFrame& frame) {
  const auto robot = robots_.try_emplace(frame.node, board_).first;
  const auto slip = robot->second.add(frame.time_us, *frame.message, frame.bits);
  if (!slip.has_value()) return;
  if (file_ == nullptr) {
    file_ = std::make_unique<AtomicFile>(path_.string());
    file_->write("time [s],robot,slip_left [1],slip_right [1]\n");
  }
  char begin[48];
  std::snprintf(begin, sizeof begin, "%" PRIu64 ".%06" PRIu64 ",%d", frame.time_us / 1'000'000,
                frame.time_us % 1'000'000, frame.node);
  file_->write(begin + cell(slip->left) + cell(slip->right) + "\n");
}

std::optional<std::string> TrackSlipTable::finish() {
  if (file_ == nullptr) return std::nullopt;
  file_->commit();
  return path_.string();
}

}  // namespace screed
