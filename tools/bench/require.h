// What a benchmark asserts of its own run, so that a figure is of what its name says.
#pragma once

#include <benchmark/benchmark.h>

namespace screed {

/// `holds` must be true of what was timed. If it is not, the benchmark's row shows `error` in place
/// of a time, and the program ends with 1 after the other benchmarks. Returns `holds`; a caller
/// that is still in its loop leaves it.
bool require(benchmark::State& state, bool holds, const char* error);

}  // namespace screed
