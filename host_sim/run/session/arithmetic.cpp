#include "host_sim/run/session/arithmetic.h"

#include <ode/ode.h>

namespace screed {
namespace {

/// Whether ODE was compiled with fused multiply-add, as Debian's is for arm64: then the product
/// below keeps what its rounding would drop.
bool ode_fuses() {
  const dReal a[] = {1.0 + 0x1p-30, 1.0};
  const dReal b[] = {1.0 + 0x1p-30, -(1.0 + 0x1p-29)};
  const dReal turned_a[] = {a[1], a[0]};
  const dReal turned_b[] = {b[1], b[0]};
  dReal sum = 0.0;
  dReal other = 0.0;
  dMultiply0(&sum, a, b, 1, 2, 1);
  dMultiply0(&other, turned_a, turned_b, 1, 2, 1);
  return sum != 0.0 || other != 0.0;
}

}  // namespace

std::string arithmetic() {
  return ode_fuses() ? "portable 1, ODE with fused multiply-add" : "portable 1";
}

}  // namespace screed
