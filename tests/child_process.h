// Part of a test in a process of its own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <string>

namespace screed {

inline constexpr char kNotPossibleHere[] = "not possible here";

/// Runs in a child process, which may limit and drop what it wants. The action returns what is
/// wrong, "" for nothing. False when it returned kNotPossibleHere.
inline bool succeeds_in_child(const std::function<std::string()>& action) {
  constexpr int kSkip = 77;
  const pid_t child = fork();
  if (child == 0) {
    const std::string wrong = action();
    if (wrong == kNotPossibleHere) _exit(kSkip);
    if (!wrong.empty()) std::fprintf(stderr, "%s\n", wrong.c_str());
    _exit(wrong.empty() ? 0 : 1);
  }
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kSkip) return false;
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status;
  return true;
}

}  // namespace screed
