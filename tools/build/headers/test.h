// What most tests include, compiled once (tools/build/host.mk). No source includes it: each names
// what it uses.
#include <gtest/gtest.h>

#include "tools/build/headers/host.h"
