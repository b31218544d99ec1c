// In a build without simavr (MCU=no): the one thing that is left of the co-simulation.
#include "host_sim/core/errors.h"
#include "host_sim/run/world/co_simulation.h"

namespace screed {

std::unique_ptr<CoSimulation> make_co_simulation(HeightField, const Assembly&,
                                                 const CoSimulationOptions&, std::ostream*) {
  throw InputError("this program was built without the microcontroller simulation (MCU=no)");
}

}  // namespace screed
