// What ODE and other foreign libraries compute with.
#include "host_sim/physics/vehicle/ode_world.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

/// The function that a shared library of this program gets by this name.
template <typename Call>
Call for_libraries(const char* name) {
  return reinterpret_cast<Call>(dlsym(RTLD_DEFAULT, name));
}

TEST(OdeWorld, LibrariesComputeWithOurFunctions) {
  using Unary = double (*)(double);
  struct Function {
    const char* name;
    Unary ours;
  };
  const Function functions[] = {{"sin", portable::sin},
                                {"cos", portable::cos},
                                {"asin", portable::asin},
                                {"acos", portable::acos}};
  const OdeWorld world;
  WorldRandom random(1, "arguments");
  for (int i = 0; i < 2000; ++i) {
    const double x = random.uniform(-1.0, 1.0);
    for (const Function& function : functions) {
      ASSERT_EQ(for_libraries<Unary>(function.name)(x), function.ours(x)) << function.name << x;
    }
    const double y = random.uniform(-1.0, 1.0);
    ASSERT_EQ(for_libraries<double (*)(double, double)>("atan2")(y, x), portable::atan2(y, x));
    double sine = 0.0;
    double cosine = 0.0;
    for_libraries<void (*)(double, double*, double*)>("sincos")(x, &sine, &cosine);
    ASSERT_EQ(sine, portable::sin(x));
    ASSERT_EQ(cosine, portable::cos(x));
  }
}

}  // namespace
}  // namespace screed
