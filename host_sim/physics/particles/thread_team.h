// Threads that share one piece of work after the other.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <thread>
#include <vector>

namespace screed {

/// The caller's thread and others that wait for it: fewer than asked for where no more can be
/// started. What work throws first is thrown on by run().
class ThreadTeam {
 public:
  /// `threads`: 1 or more, the caller's included.
  explicit ThreadTeam(int threads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int threads() const { return static_cast<int>(others_.size()) + 1; }

  /// Calls work(i, member) for every i below count, each once, in any thread and order; `member`,
  /// below threads(), is the number of the thread. Returns when all have returned; after one that
  /// throws, the rest may be left out. Allocates nothing.
  template <class Work>
  void run(size_t count, const Work& work) {
    if (others_.empty() || count < 2) {
      for (size_t i = 0; i < count; ++i) work(i, size_t{0});
      return;
    }
    const Call call = [](const void* what, size_t i, size_t member) {
      (*static_cast<const Work*>(what))(i, member);
    };
    share(count, call, &work);
  }

 private:
  using Call = void (*)(const void* work, size_t i, size_t member);

  void share(size_t count, Call call, const void* work);
  void serve(size_t member);
  void take_parts(size_t member);

  // The work that is open. A thread reads it only while it is counted in inside_.
  size_t count_ = 0;
  Call call_ = nullptr;
  const void* work_ = nullptr;
  std::atomic<size_t> next_{0};

  std::atomic<bool> open_{false};
  std::atomic<uint32_t> opened_{0};  // how often: what waiting threads wait for
  std::atomic<uint32_t> inside_{0};
  std::atomic<bool> over_{false};
  std::atomic_flag failed_;
  std::exception_ptr failure_;  // of who has set the flag
  std::vector<std::thread> others_;
};

}  // namespace screed
