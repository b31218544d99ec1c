// A file: "SCRSLIP1", u32 ticks, u32 length of the failure's text, the text, then the ticks, 42
// bytes each, fields in the order of SlipTick, little endian.
#include "nn/slip/slip_archive.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"

namespace screed::nn {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little endian");
constexpr std::string_view kMagic = "SCRSLIP1";

class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }
  void text(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Reader {
 public:
  Reader(std::vector<char> bytes, std::string file)
      : bytes_(std::move(bytes)), file_(std::move(file)) {}
  template <class T>
  void operator()(T& value) {
    std::memcpy(&value, take(sizeof value), sizeof value);
  }
  std::string text(std::size_t length) { return {take(length), length}; }
  bool at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail() const {
    throw InputError(file_ + ": no recorded drive of this version; remove it");
  }

 private:
  const char* take(std::size_t length) {
    if (bytes_.size() - at_ < length) fail();
    at_ += length;
    return bytes_.data() + at_ - length;
  }

  std::vector<char> bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

template <class Tick, class Visitor>
void visit(Tick& tick, Visitor& field) {
  field(tick.speed_left);
  field(tick.effort_left);
  field(tick.speed_right);
  field(tick.effort_right);
  field(tick.gyro);
  field(tick.accel);
  field(tick.sin_pitch_q14);
  field(tick.yaw_rate);
  field(tick.running);
  field(tick.speed);
  field(tick.turn);
  field(tick.track_left);
  field(tick.track_right);
}

}  // namespace

std::string archive_name(const StuckScenario& scenario) {
  ContentHash hash;
  hash.add(scenario.experiment.text());
  return std::string(name_of(scenario.kind)) + "-" +
         std::to_string(scenario.experiment.experiment.seed) + "-" + hash.hex().substr(0, 12) +
         ".drive";
}

std::optional<SlipDrive> read_drive(const std::filesystem::path& file,
                                    const StuckScenario& scenario) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  Reader reader({std::istreambuf_iterator<char>(stream), {}}, file.string());
  if (reader.text(kMagic.size()) != kMagic) reader.fail();
  SlipDrive drive = drive_of(scenario);
  std::uint32_t ticks = 0;
  std::uint32_t failure = 0;
  reader(ticks);
  reader(failure);
  drive.failure = reader.text(failure);
  for (std::uint32_t i = 0; i < ticks; ++i) visit(drive.ticks.emplace_back(), reader);
  if (!reader.at_end()) reader.fail();
  return drive;
}

void write_drive(const std::filesystem::path& file, const SlipDrive& drive) {
  Writer writer;
  writer.text(kMagic);
  writer(static_cast<std::uint32_t>(drive.ticks.size()));
  writer(static_cast<std::uint32_t>(drive.failure.size()));
  writer.text(drive.failure);
  for (const SlipTick& tick : drive.ticks) visit(tick, writer);
  AtomicFile out(file);
  out.write(writer.bytes());
  out.commit();
}

}  // namespace screed::nn
