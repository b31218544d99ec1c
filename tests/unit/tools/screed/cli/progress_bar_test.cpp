// The line of a progress bar.
#include "tools/screed/cli/progress_bar.h"

#include <gtest/gtest.h>

#include <sstream>

namespace screed {
namespace {

TEST(ProgressBar, ASlowRunHasAFactor) {
  // Less than a nanosecond of the run: whatever the machine does, that is slower than a tenth of
  // real time, and no 0.
  std::ostringstream out;
  ProgressBar bar(out);
  bar.show(0.0, 10.0, "");
  bar.show(1e-10, 10.0, "");
  bar.finish();
  EXPECT_NE(out.str().find("  x0.0"), std::string::npos) << out.str();
  EXPECT_EQ(out.str().find("  x0 "), std::string::npos) << out.str();
}

}  // namespace
}  // namespace screed
