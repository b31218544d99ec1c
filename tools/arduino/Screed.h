// Screed as an Arduino library: call screed::main_loop() in setup(); it never returns.
#pragma once

#include "firmware/main_loop.h"
