// What a fuzz target says when a property does not hold: it dies, so that the fuzzer keeps the
// input.
#pragma once

#include <cstdio>
#include <cstdlib>

#define SCREED_REQUIRE(condition)                                                  \
  do {                                                                             \
    if (!(condition)) {                                                            \
      std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                \
    }                                                                              \
  } while (false)
