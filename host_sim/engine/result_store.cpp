// Result files: lines with a check, written by one process, read by any.
#include "host_sim/engine/result_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/engine/task_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kSyncInterval(500);
constexpr size_t kMaxNotes = 5;
constexpr const char* kSuffix = ".jsonl";
constexpr const char* kDoneWord = "done";
constexpr const char* kFailedWord = "failed";
constexpr size_t kHashDigits = 32;
constexpr std::string_view kResultKey = "{\"result\":";
constexpr std::string_view kProvenanceKey = ",\"provenance\":";

std::string hash_of(std::string_view text) {
  ContentHash hash;
  hash.add_bytes({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  return hash.hex();
}

[[noreturn]] void cannot_write(const fs::path& path, int reason) {
  throw RunError(path.string() + ": cannot be written: " + std::strerror(reason));
}

/// A new file's name reaches the disk with its folder alone.
void sync_folder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  static_cast<void>(fsync(descriptor));  // some file systems refuse; then there is nothing to do
  static_cast<void>(close(descriptor));
}

/// The text up to the next blank, which is taken away with it.
std::string_view take_word(std::string_view& text) {
  const size_t blank = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, blank);
  text.remove_prefix(std::min(blank + 1, text.size()));
  return word;
}

/// The words of a line in front of its JSON.
struct Head {
  std::string id;
  ResultStatus status;
  std::string hash;
  std::string_view json;
};

/// Nothing for a line that is damaged.
std::optional<Head> parse_line(std::string_view line) {
  const std::string_view check = take_word(line);
  if (check.size() != kHashDigits || hash_of(line) != check) return std::nullopt;
  Head head;
  head.id = take_word(line);
  const std::string_view status = take_word(line);
  head.status = status == kDoneWord ? ResultStatus::kDone : ResultStatus::kFailed;
  head.hash = take_word(line);
  head.json = line;
  return head;
}

}  // namespace

// ---- writing -----------------------------------------------------------------------------------

ResultWriter::ResultWriter(const fs::path& folder) {
  make_folder(folder);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::string host = host_name();
  const std::string stem =
      (host.empty() ? "host" : host) + "-" + std::to_string(getpid()) + "-" +
      std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
  path_ = folder / (stem + kSuffix);
  descriptor_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) cannot_write(path_, errno);
  sync_folder(folder);
}

ResultWriter::~ResultWriter() {
  static_cast<void>(fdatasync(descriptor_));
  static_cast<void>(close(descriptor_));
  std::error_code ignored;
  if (size_ == 0) fs::remove(path_, ignored);
}

void ResultWriter::append(const StoredResult& result) {
  std::string rest = result.id + " " +
                     (result.status == ResultStatus::kDone ? kDoneWord : kFailedWord) + " " +
                     hash_of(result.result) + " ";
  rest.append(kResultKey).append(result.result);
  rest.append(kProvenanceKey).append(result.provenance).append("}");
  const std::string line = hash_of(rest) + " " + rest + "\n";
  const ssize_t written = write(descriptor_, line.data(), line.size());
  if (written != static_cast<ssize_t>(line.size())) {
    const int reason = written < 0 ? errno : ENOSPC;
    // Half a line would spoil the next one. Where even this fails, reading finds it out.
    static_cast<void>(ftruncate(descriptor_, size_));
    cannot_write(path_, reason);
  }
  size_ += written;
  if (Clock::now() - synced_ < kSyncInterval) return;
  if (fdatasync(descriptor_) != 0) cannot_write(path_, errno);
  synced_ = Clock::now();
}

// ---- reading -----------------------------------------------------------------------------------

ResultIndex::ResultIndex(const fs::path& folder) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == kSuffix) files_.push_back(entry.path());
  if (error && fs::exists(folder))
    throw RunError(folder.string() + ": cannot be read: " + error.message());
  std::sort(files_.begin(), files_.end());
  for (size_t file = 0; file < files_.size(); ++file) read_file(file);
}

void ResultIndex::read_file(size_t file) {
  std::ifstream stream(files_[file], std::ios::binary);
  if (!stream) throw RunError(files_[file].string() + ": cannot be read");
  ResultPlace place;
  place.file = file;
  for (std::string line; std::getline(stream, line);) {
    // A line without an end is what a killed writer left, or what a live one is writing.
    if (stream.eof()) break;
    place.length = line.size();
    ++place.line;
    const std::optional<Head> head = parse_line(line);
    if (head.has_value()) {
      place.status = head->status;
      place.hash = head->hash;
      take(head->id, place);
    } else {
      damaged_.push_back(name(place) + ": the line is damaged");
    }
    place.offset += line.size() + 1;
  }
  if (stream.bad()) throw RunError(files_[file].string() + ": cannot be read completely");
}

void ResultIndex::take(const std::string& id, const ResultPlace& place) {
  if (place.status == ResultStatus::kFailed) ++failures_[id];
  const auto [known, is_new] = places_.emplace(id, place);
  if (is_new || place.status == ResultStatus::kFailed) return;
  ResultPlace& first = known->second;
  if (first.status == ResultStatus::kFailed) {
    first = place;
  } else if (first.hash != place.hash) {
    throw InputError("run " + id + " has two different results: " + name(first) + " and " +
                     name(place) + "; remove the file with the wrong one");
  }
}

std::string ResultIndex::name(const ResultPlace& place) const {
  return files_[place.file].string() + ":" + std::to_string(place.line);
}

bool ResultIndex::done(const std::string& id) const {
  const auto place = places_.find(id);
  return place != places_.end() && place->second.status == ResultStatus::kDone;
}

bool ResultIndex::failed(const std::string& id) const {
  const auto place = places_.find(id);
  return place != places_.end() && place->second.status == ResultStatus::kFailed;
}

size_t ResultIndex::failures(const std::string& id) const {
  const auto failures = failures_.find(id);
  return failures == failures_.end() ? 0 : failures->second;
}

StoredResult ResultIndex::read(const std::string& id) const {
  const ResultPlace& place = places_.at(id);
  if (open_ != place.file || !stream_.is_open()) {
    stream_.close();
    stream_.clear();
    stream_.open(files_[place.file], std::ios::binary);
    open_ = place.file;
  }
  stream_.seekg(static_cast<std::streamoff>(place.offset));
  std::string line(place.length, '\0');
  stream_.read(line.data(), static_cast<std::streamsize>(line.size()));
  const std::optional<Head> head = stream_ ? parse_line(line) : std::nullopt;
  if (!head.has_value()) throw RunError(name(place) + ": has changed while it was read");
  // Within texts of JSON no quotes stand by themselves, so this is the key; and the last one.
  const size_t key = head->json.rfind(kProvenanceKey);
  const std::string_view result = head->json.substr(kResultKey.size(), key - kResultKey.size());
  std::string_view provenance = head->json.substr(key + kProvenanceKey.size());
  provenance.remove_suffix(1);
  return {id, place.status, std::string(result), std::string(provenance)};
}

std::vector<std::string> ResultIndex::oddities(
    const std::function<bool(const std::string&)>& is_known) const {
  std::vector<std::string> notes;
  for (const std::string& damage : damaged_) {
    if (notes.size() == kMaxNotes) {
      notes.push_back("and " + std::to_string(damaged_.size() - kMaxNotes) + " damaged lines more");
      break;
    }
    notes.push_back(damage + "; its run counts as not done");
  }
  size_t others = 0;
  for (const auto& [id, place] : places_)
    if (place.status == ResultStatus::kDone && !is_known(id)) ++others;
  if (others > 0)
    notes.push_back(std::to_string(others) +
                    " results are of other values, seeds or versions of Screed; they stay and do "
                    "not count");
  return notes;
}

}  // namespace screed
