// The program beside a simulated robot that answers at a virtual serial port in real time.
#pragma once

#include <string>

#include "tests/sitl/program.h"

namespace screed::testing {

class RobotAtPort : public Program {
 protected:
  /// Runs shell lines beside a simulated robot at the port `radio`, disarmed: it takes parameters.
  /// $screed is the program. The exit code is that of the last line.
  /// The robot's run lies in the folder `robot` afterwards; `more`: arguments of its simulation.
  Result with_robot(const std::string& lines, const std::string& more = "") const {
    write("lines.sh",
          "screed=$1\n"
          "mkfifo said\n"
          "\"$screed\" sim first_drive --pty radio --duration 600 --out robot --quiet "
          "--no-pictures " +
              more +
              " > /dev/null 2> said &\n"
              "sim=$!\n"
              "exec 3< said\n"
              "read -r line <&3\n"  // said when the port is there
              "\"$screed\" send --pty radio disarm > /dev/null || exit 99\n" +
              lines + "status=$?\nkill -INT $sim\nwait $sim\nexit $status\n");
    return run("", "bash lines.sh");
  }
};

}  // namespace screed::testing
