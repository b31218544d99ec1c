// Runs another program and reads what it says; never waits for it without end.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace screed::flash {

struct ChildOutcome {
  int exit_code = 0;
  bool killed = false;  ///< by us, for silence or by `listen`; exit_code means nothing then
  std::string said;     ///< standard output and standard error, as they came
};

/// Runs `command` (found through PATH) with an empty standard input. `listen` gets all that was
/// said so far whenever there is more. The program is killed when `listen` returns false, and when
/// it says nothing for `idle_timeout`. Throws RunError when the program cannot be started.
ChildOutcome run_child(const std::vector<std::string>& command,
                       std::chrono::milliseconds idle_timeout,
                       const std::function<bool(std::string_view)>& listen);

}  // namespace screed::flash
