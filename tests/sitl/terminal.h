// The program on a terminal of its own: what it draws there, and signals at the moment when a text
// appears.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace screed::testing {

class Terminal {
 public:
  /// Runs words[0] in `folder`, with `path` as PATH unless it is empty. Its terminal has 300
  /// columns.
  Terminal(std::vector<std::string> words, const std::filesystem::path& folder,
           const std::string& path = "") {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const winsize size{.ws_row = 25, .ws_col = 300, .ws_xpixel = 0, .ws_ypixel = 0};
    child_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (child_ < 0) throw std::runtime_error("no terminal");
    if (child_ > 0) return;
    setenv("TERM", "xterm", 1);
    if (!path.empty()) setenv("PATH", path.c_str(), 1);
    if (chdir(folder.c_str()) == 0) execv(arguments.front(), arguments.data());
    _exit(127);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    close(terminal_);
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
  }

  /// Reads until the text has appeared. False when the program ended without it.
  bool wait_for(const std::string& text) {
    while (screen_.find(text) == std::string::npos) {
      if (!read_some()) return false;
    }
    return true;
  }
  /// Presses these keys.
  void type(const std::string& keys) const {
    if (write(terminal_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size()))
      throw std::runtime_error("the terminal takes no keys");
  }
  /// Holds a key down, which then repeats itself as a keyboard's does, or none, until it holds.
  /// False when the program ended before.
  bool hold_until(const std::string& key, const std::function<bool()>& holds) {
    constexpr int kRepeat_ms = 30;
    while (!holds()) {
      type(key);
      pollfd drawn{terminal_, POLLIN, 0};
      if (poll(&drawn, 1, kRepeat_ms) > 0 && !read_some()) return false;
    }
    return true;
  }
  void signal(int number) const { kill(child_, number); }
  /// Reads to the end; the exit code, or -1 when a signal ended it.
  int exit_code() {
    while (read_some()) {
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// All that it has written, with the terminal's control characters.
  const std::string& screen() const { return screen_; }

 private:
  bool read_some() {
    std::array<char, 4096> block{};
    ssize_t got = 0;
    do {
      got = read(terminal_, block.data(), block.size());
    } while (got < 0 && errno == EINTR);
    if (got <= 0) return false;  // a terminal that the last process has closed gives EIO
    screen_.append(block.data(), static_cast<std::size_t>(got));
    return true;
  }

  int terminal_ = -1;
  pid_t child_ = 0;
  std::string screen_;
};

}  // namespace screed::testing
