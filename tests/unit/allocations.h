// How often the unit tests' program has allocated memory, to show that steady stepping does not.
#pragma once

namespace screed::testing {

long allocations();

}  // namespace screed::testing
