// The two ways in which a host program ends badly, each with one clear line for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace screed {

/// The user's input is wrong: a file, a key, a value. The message names what is wrong, where, and
/// what is allowed. Ends a program with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input was right, but the run could not be completed: disk full, folder not writable. Ends a
/// program with exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace screed
