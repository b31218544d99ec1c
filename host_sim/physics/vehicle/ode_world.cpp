// Ownership of an ODE world.
#include "host_sim/physics/vehicle/ode_world.h"

#include <cstdio>
#include <mutex>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

// ODE and the reader of URDF call these: defined in the program, they come before the C library's,
// whose bits depend on the processor.
#pragma GCC visibility push(default)
extern "C" {
double sin(double x) noexcept {
  return screed::portable::sin(x);
}
double cos(double x) noexcept {
  return screed::portable::cos(x);
}
void sincos(double x, double* sine, double* cosine) noexcept {
  const auto both = screed::portable::sine_cosine(x);
  *sine = both.sine;
  *cosine = both.cosine;
}
double asin(double x) noexcept {
  return screed::portable::asin(x);
}
double acos(double x) noexcept {
  return screed::portable::acos(x);
}
double atan2(double y, double x) noexcept {
  return screed::portable::atan2(y, x);
}
}
#pragma GCC visibility pop

// What ODE within libscreed writes its messages to (interface.mk).
extern "C" {
std::FILE* screed_stdout = stdout;
std::FILE* screed_stderr = stderr;
}

namespace screed {
namespace {

// ODE is initialised once a process and never closed: worlds of several threads come and go.
void initialise_ode() {
  static std::once_flag once;
  std::call_once(once, [] { dInitODE2(0); });
  dAllocateODEDataForThread(dAllocateMaskAll);
}

dWorldID create_world() {
  initialise_ode();
  return dWorldCreate();
}

}  // namespace

// Without an implementation of its own a world steps on one that all worlds share: two that step at
// the same time then end the program.
OdeWorld::OdeWorld()
    : world_(create_world()), threading_(dThreadingAllocateSelfThreadedImplementation()) {
  dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_),
                                       threading_);
  dWorldSetGravity(world_, 0.0, 0.0, -kGravity_m_per_s2);
}

OdeWorld::~OdeWorld() {
  dWorldDestroy(world_);
  dThreadingFreeImplementation(threading_);
}

}  // namespace screed
