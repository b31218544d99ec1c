// Progress bars.
#include "tools/screed/cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <utility>

#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

constexpr int kWidth = 28;
constexpr std::chrono::milliseconds kTerminalInterval(100);
constexpr std::chrono::seconds kLogInterval(10);

/// Minutes and seconds, and hours when there are some.
std::string clock_text(double seconds) {
  const long whole = std::lround(std::max(0.0, std::min(seconds, 3.6e6)));
  char text[32];
  if (whole >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  }
  return text;
}

}  // namespace

ProgressBar::ProgressBar(std::ostream& out)
    : out_(out), terminal_(&out == &std::cerr && isatty(STDERR_FILENO) == 1) {}

void ProgressBar::show(double time_s, double duration_s, const std::string& note) {
  const auto now = std::chrono::steady_clock::now();
  time_s_ = time_s;
  duration_s_ = duration_s;
  note_ = note;
  shown_ = now;
  if (!begun_) {
    begun_ = true;
    begin_ = now;
    drawn_ = now;
    begin_time_s_ = time_s;
    return;
  }
  if (now - drawn_ <
      (terminal_ ? std::chrono::steady_clock::duration(kTerminalInterval) : kLogInterval))
    return;
  drawn_ = now;
  draw();
}

void ProgressBar::show_share(double share, const std::string& note) {
  is_share_ = true;
  show(share, 1.0, note);
}

void ProgressBar::draw() {
  const double wall = std::chrono::duration<double>(shown_ - begin_).count();
  const double share = duration_s_ > 0.0 ? std::clamp(time_s_ / duration_s_, 0.0, 1.0) : 0.0;
  const int full = static_cast<int>(share * kWidth);
  std::string bar;
  for (int i = 0; i < kWidth; ++i) bar += i < full ? "█" : "░";
  const double speed = wall > 0.0 ? (time_s_ - begin_time_s_) / wall : 0.0;
  char text[200];
  const bool known = speed > 0.0 || share >= 1.0;
  const std::string left =
      known ? clock_text(share < 1.0 ? (duration_s_ - time_s_) / speed : 0.0) : "-:--";
  if (is_share_) {
    std::snprintf(text, sizeof text, " %3.0f %%  %s left  %s", share * 100.0, left.c_str(),
                  note_.c_str());
  } else {
    std::snprintf(text, sizeof text, " %3.0f %%  %.1f / %.1f s  x%s  %s left  %s", share * 100.0,
                  time_s_, duration_s_, factor_text(speed).c_str(), left.c_str(), note_.c_str());
  }
  out_ << (terminal_ ? "\r" : "") << bar << text << (terminal_ ? "\033[K" : "\n") << std::flush;
  visible_ = true;
}

void ProgressBar::finish() {
  if (!begun_) return;
  draw();
  if (terminal_) out_ << "\n";
}

void ProgressBar::clear() {
  if (terminal_ && visible_) out_ << "\r\033[K" << std::flush;
  visible_ = false;
}

TaskBar::TaskBar(bool quiet, std::string label) : quiet_(quiet), label_(std::move(label)) {}

TaskProgress TaskBar::progress() {
  return [this](std::string_view task, double share) {
    stop_if_interrupted(task);
    if (!quiet_) show(task, share);
  };
}

void TaskBar::show(std::string_view task, double share) {
  if (!bar_.has_value() || task_ != task) {
    clear();
    task_ = task;
    bar_.emplace(std::cerr);
  }
  bar_->show_share(share, label_ + task_);
}

void TaskBar::clear() {
  if (bar_.has_value()) bar_->clear();
  bar_.reset();
}

}  // namespace screed
