// The C interface of many worlds at once.
#include <screed/run.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "host_sim/interface/checks.h"
#include "host_sim/interface/told_world.h"

using namespace screed;  // of a file whose own names are C's
using namespace screed::interface;

namespace {

/// Threads that wait for work on numbered things. Which of them does what decides nothing.
class Crew {
 public:
  explicit Crew(int threads) {
    try {
      for (int i = 1; i < threads; ++i) threads_.emplace_back([this] { serve(); });
    } catch (...) {  // the machine has no more of them
      dismiss();
      throw;
    }
  }
  ~Crew() { dismiss(); }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Calls work(0) to work(count - 1), on the calling thread as well. Throws the first of what they
  /// threw, after all of them.
  void run(size_t count, const std::function<void(size_t)>& work) {
    {
      const std::lock_guard lock(mutex_);
      work_ = &work;
      count_ = count;
      next_ = 0;
      working_ = threads_.size();
      failure_ = nullptr;
      ++call_;
    }
    called_.notify_all();
    take_part();
    std::unique_lock lock(mutex_);
    done_.wait(lock, [this] { return working_ == 0; });
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void dismiss() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    called_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  void take_part() {
    for (size_t i = next_++; i < count_; i = next_++) {
      try {
        (*work_)(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::current_exception();
      }
    }
  }
  void serve() {
    for (uint64_t seen = 0;;) {
      {
        std::unique_lock lock(mutex_);
        called_.wait(lock, [&] { return over_ || call_ != seen; });
        if (over_) return;
        seen = call_;
      }
      take_part();
      const std::lock_guard lock(mutex_);
      if (--working_ == 0) done_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable called_;
  std::condition_variable done_;
  const std::function<void(size_t)>* work_ = nullptr;
  std::atomic<size_t> next_ = 0;
  size_t count_ = 0;
  size_t working_ = 0;
  uint64_t call_ = 0;
  bool over_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

}  // namespace

struct screed_worlds : Handle {
  screed_worlds(std::shared_ptr<const PreparedWorld> prepared, std::span<const uint64_t> seeds,
                int threads)
      : crew(threads), worlds(seeds.size()) {
    crew.run(seeds.size(),
             [&](size_t i) { worlds[i] = std::make_unique<ToldWorld>(prepared, seeds[i]); });
  }
  size_t robots() const { return worlds.front()->world().robots(); }

  Crew crew;
  std::vector<std::unique_ptr<ToldWorld>> worlds;
};

screed_worlds* screed_worlds_create(const void* prepared, size_t size, const uint64_t* seeds,
                                    size_t count, int threads, screed_error* error) {
  screed_worlds* worlds = nullptr;
  attempt(error, [&] {
    require_pointer(prepared, "prepared");
    require_pointer(seeds, "seeds");
    require(count >= 1 && count <= 65536, "count", static_cast<double>(count), "1 to 65536");
    require(threads >= 1 && threads <= 256, "threads", threads, "1 to 256");
    worlds = new screed_worlds(std::make_shared<const PreparedWorld>(prepared_from(
                                   std::string_view(static_cast<const char*>(prepared), size))),
                               {seeds, count}, threads);
  });
  return worlds;
}

void screed_worlds_destroy(screed_worlds* worlds) {
  destroy(worlds);
}

int screed_worlds_robots(const screed_worlds* worlds) {
  return worlds == nullptr ? 0 : static_cast<int>(worlds->robots());
}

screed_status screed_worlds_reset(screed_worlds* worlds, const uint8_t* which,
                                  const uint64_t* seeds, int ticks, screed_error* error) {
  return attempt(error, [&] {
    const Use use(worlds, "worlds");
    require_pointer(which, "which");
    require_pointer(seeds, "seeds");
    if (ticks != 0) check_ticks(ticks);
    for (size_t i = 0; i < worlds->worlds.size(); ++i)
      if (which[i] != 0) check_seed(seeds[i], worlds->worlds[i]->prepared());
    worlds->crew.run(worlds->worlds.size(), [&](size_t i) {
      if (which[i] == 0) return;
      worlds->worlds[i]->reset(seeds[i]);
      if (ticks > 0) worlds->worlds[i]->advance(ticks, {});
    });
  });
}

screed_status screed_worlds_advance(screed_worlds* worlds, int ticks, const screed_action* actions,
                                    screed_error* error) {
  return attempt(error, [&] {
    const Use use(worlds, "worlds");
    check_ticks(ticks);
    const size_t robots = worlds->robots();
    if (actions != nullptr) {
      for (size_t i = 0; i < worlds->worlds.size(); ++i)
        worlds->worlds[i]->check_actions({actions + i * robots, robots});
    }
    worlds->crew.run(worlds->worlds.size(), [&](size_t i) {
      std::span<const screed_action> its;
      if (actions != nullptr) its = {actions + i * robots, robots};
      worlds->worlds[i]->advance(ticks, its);
    });
  });
}

screed_status screed_worlds_rows(screed_worlds* worlds, int table, void* rows,
                                 screed_error* error) {
  return attempt(error, [&] {
    const Use use(worlds, "worlds");
    check_table(table);
    require_pointer(rows, "rows");
    const size_t robots = worlds->robots();
    const size_t bytes = row_bytes(columns_of(table));
    auto* row = static_cast<uint8_t*>(rows);
    for (const std::unique_ptr<ToldWorld>& world : worlds->worlds) {
      for (size_t i = 0; i < robots; ++i, row += bytes) world->copy_row(i, table, row);
    }
  });
}

screed_status screed_worlds_level(screed_worlds* worlds, int with_transport, screed_level* levels,
                                  screed_error* error) {
  return attempt(error, [&] {
    const Use use(worlds, "worlds");
    require_pointer(levels, "levels");
    worlds->crew.run(worlds->worlds.size(),
                     [&](size_t i) { levels[i] = worlds->worlds[i]->level(with_transport != 0); });
  });
}
