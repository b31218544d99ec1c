// A progress bar a task.
#include "tools/screed/cli/task_bar.h"

#include <iostream>
#include <utility>

namespace screed {

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
