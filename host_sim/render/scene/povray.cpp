// POV-Ray as a child process.
#include "host_sim/render/scene/povray.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr int kSmallest_px = 16;
constexpr int kLargest_px = 8000;

/// Ctrl-C reaches the child as well: it ends, and this program lives to clear up after it.
class IgnoreInterrupts {
 public:
  IgnoreInterrupts() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGINT, &ignore, &before_);
  }
  IgnoreInterrupts(const IgnoreInterrupts&) = delete;
  IgnoreInterrupts& operator=(const IgnoreInterrupts&) = delete;
  ~IgnoreInterrupts() { sigaction(SIGINT, &before_, nullptr); }

 private:
  struct sigaction before_ {};
};

/// Runs a program of the path in `folder` with its messages in `log`. Its exit status, 127 when
/// there is none of that name.
int run_quietly(std::vector<std::string> words, const fs::path& folder, const fs::path& log) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t interrupt;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  posix_spawnattr_setsigdefault(&attributes, &interrupt);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);

  const IgnoreInterrupts while_it_runs;
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, arguments.front(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return 127;
  if (error != 0) throw RunError(words.front() + ": " + std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The first line of POV-Ray's messages that speaks of an error; empty when there is none.
std::string complaint(const fs::path& log) {
  std::ifstream file(log);
  for (std::string line; std::getline(file, line);) {
    if (line.find("rror:") != std::string::npos) return line;
  }
  return "";
}

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

bool PovrayJob::render(int width_px, int height_px) {
  for (const int side : {width_px, height_px}) {
    if (side >= kSmallest_px && side <= kLargest_px) continue;
    throw InputError("a picture of " + std::to_string(width_px) + " x " +
                     std::to_string(height_px) + " pixels; allowed is " +
                     std::to_string(kSmallest_px) + " to " + std::to_string(kLargest_px) +
                     " a side");
  }
  const fs::path log = in_the_making("povray.log");
  // In the scene's own folder: POV-Ray may be set up to touch no files elsewhere.
  const int status = run_quietly(
      {"povray", "+I" + name_with(".pov"), "+O" + picture_.filename().string(),
       "+W" + std::to_string(width_px), "+H" + std::to_string(height_px),
       picture_.extension() == ".jpg" ? "+FJ" : "+FN", "+A0.1", "+AM2", "+R3", "-D", "-GA", "+GF"},
      folder_, log);
  const std::string said = complaint(log);
  std::error_code ignored;
  fs::remove(log, ignored);
  if (status == 127) return false;
  if (status != 0) {
    throw RunError("povray could not render " + scene().string() +
                   (said.empty() ? "" : ": " + said));
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
