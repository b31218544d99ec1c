// Threads that share one piece of work after the other. They look for the next one for some
// microseconds before they sleep: a step of a bed has two pieces of work, of a millisecond each.
#include "host_sim/physics/particles/thread_team.h"

#include <system_error>
#include <utility>

namespace screed {
namespace {

constexpr int kLooks = 20000;

/// Gives the core's other thread its turn, where it has one.
void relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

}  // namespace

ThreadTeam::ThreadTeam(int threads) {
  others_.reserve(static_cast<size_t>(threads) - 1);
  try {
    for (int i = 1; i < threads; ++i)
      others_.emplace_back([this, i] { serve(static_cast<size_t>(i)); });
  } catch (const std::system_error&) {  // the system has no more: those that there are do the work
  }
}

ThreadTeam::~ThreadTeam() {
  over_ = true;
  ++opened_;
  opened_.notify_all();
  for (std::thread& thread : others_) thread.join();
}

void ThreadTeam::share(size_t count, Call call, const void* work) {
  count_ = count;
  call_ = call;
  work_ = work;
  next_ = 0;
  open_ = true;
  ++opened_;
  opened_.notify_all();
  take_parts(0);
  // All parts are taken. Who comes now finds it closed; who is inside has a part in hand.
  open_ = false;
  for (int looks = 0; inside_ != 0; ++looks) {
    if (looks < kLooks) {
      relax();
    } else {
      std::this_thread::yield();
    }
  }
  if (!failed_.test()) return;
  failed_.clear();
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

void ThreadTeam::serve(size_t member) {
  uint32_t seen = 0;
  while (true) {
    for (int looks = 0; opened_ == seen && looks < kLooks; ++looks) relax();
    opened_.wait(seen);
    seen = opened_;
    if (over_) return;
    ++inside_;
    if (open_) take_parts(member);
    --inside_;
  }
}

void ThreadTeam::take_parts(size_t member) {
  try {
    for (size_t i = next_++; i < count_; i = next_++) call_(work_, i, member);
  } catch (...) {
    next_ = count_;
    if (!failed_.test_and_set()) failure_ = std::current_exception();
  }
}

}  // namespace screed
