// How every host program ends: 0 done, 1 the run failed, 2 the input was wrong, and then one line
// on standard error says what.
#pragma once

#include <functional>

#include "tools/command_line/command.h"

namespace screed {

/// Parses the command line, then runs `body`, which returns the exit code. The program must carry
/// its name. `PROGRAM help sim` is `PROGRAM sim --help`.
int run_program(Command& program, int argc, char** argv, const std::function<int()>& body);

}  // namespace screed
