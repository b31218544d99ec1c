// POV-Ray as a child process.
#include "host_sim/render/scene/povray.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallest_px = 16;
constexpr int kLargest_px = 8000;

/// What POV-Ray says while it runs.
class PovrayMessages {
 public:
  /// Lines end with a line feed, those of progress with a carriage return.
  void add(const std::string& text) {
    for (const char c : text) {
      if (c != '\n' && c != '\r') {
        line_ += c;
        continue;
      }
      end_line();
      line_.clear();
    }
  }
  /// Share of the pixels that are done.
  double share() const { return share_; }
  /// The first line that speaks of an error; empty when there is none.
  const std::string& complaint() const { return complaint_; }

 private:
  void end_line() {
    unsigned long long done = 0;
    unsigned long long all = 0;
    if (complaint_.empty() && line_.find("rror:") != std::string::npos) complaint_ = line_;
    if (std::sscanf(line_.c_str(), "Rendered %llu of %llu pixels", &done, &all) == 2 && all > 0)
      share_ = std::max(share_, static_cast<double>(done) / static_cast<double>(all));
  }

  std::string line_;
  std::string complaint_;
  double share_ = 0.0;
};

}  // namespace

void check_picture_name(const fs::path& picture) {
  const std::string extension = picture.extension().string();
  if (extension == ".png" || extension == ".jpg") return;
  throw InputError(picture.string() + ": a picture's name ends in .png or .jpg");
}

PovrayJob::PovrayJob(fs::path picture) : picture_(std::move(picture)) {
  check_picture_name(picture_);
  std::error_code error;
  if (fs::is_directory(picture_, error)) throw InputError(picture_.string() + ": is a folder");
  std::string name = picture_.string() + ".XXXXXX";
  if (mkdtemp(name.data()) == nullptr) {
    throw RunError(picture_.string() + ": cannot be written: " + std::strerror(errno));
  }
  folder_ = fs::absolute(name);
}

PovrayJob::~PovrayJob() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path PovrayJob::scene() const {
  fs::path scene = picture_;
  return scene.replace_extension(".pov");
}

std::string PovrayJob::name_with(const std::string& ending) const {
  return picture_.stem().string() + ending;
}

void PovrayJob::write_scene(const std::string& text) {
  std::ofstream file(in_the_making(name_with(".pov")), std::ios::binary);
  file << text;
  file.close();
  if (!file.good()) {
    throw RunError(scene().string() + ": cannot be written completely; is the disk full?");
  }
}

bool PovrayJob::render(int width_px, int height_px, const TaskProgress& progress) {
  for (const int side : {width_px, height_px}) {
    if (side >= kSmallest_px && side <= kLargest_px) continue;
    throw InputError("a picture of " + std::to_string(width_px) + " x " +
                     std::to_string(height_px) + " pixels; allowed is " +
                     std::to_string(kSmallest_px) + " to " + std::to_string(kLargest_px) +
                     " a side");
  }
  constexpr int kWait_ms = 20;
  // In the scene's own folder: POV-Ray may be set up to touch no files elsewhere. +V: it tells the
  // pixels that are done.
  ChildProcess povray(
      {.words = {"povray", "+I" + name_with(".pov"), "+O" + picture_.filename().string(),
                 "+W" + std::to_string(width_px), "+H" + std::to_string(height_px),
                 picture_.extension() == ".jpg" ? "+FJ" : "+FN", "+A0.1", "+AM2", "+R3", "-D",
                 "-GA", "+GF", "+V"},
       .folder = folder_,
       .errors_are_read = true});
  if (!povray.found()) return false;
  PovrayMessages messages;
  const std::string task = "rendering " + picture_.filename().string();
  std::optional<int> status;
  while (!status.has_value()) {
    report_progress(progress, task, messages.share());
    std::string text;
    povray.receive(text, kWait_ms);
    messages.add(text);
    status = povray.ended();
  }
  std::string rest;
  povray.receive(rest);
  messages.add(rest + "\n");
  if (*status != 0) {
    throw RunError("povray could not render " + scene().string() +
                   (messages.complaint().empty() ? "" : ": " + messages.complaint()));
  }
  return true;
}

void PovrayJob::publish() {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    const fs::path place = picture_.parent_path() / entry.path().filename();
    std::error_code error;
    fs::rename(entry.path(), place, error);
    if (error) throw RunError(place.string() + ": cannot be written: " + error.message());
  }
}

}  // namespace screed
