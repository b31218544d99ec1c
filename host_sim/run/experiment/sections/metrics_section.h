// [metrics] of an experiment file: how often a run is measured. Decides nothing of what happens in
// it.
#pragma once

namespace screed {

struct MetricsSection {
  double interval_s = 30.0;
  double transport_interval_s = 120.0;

  template <class Keys>
  static void list(Keys& keys) {
    using M = MetricsSection;
    keys.real("interval", "s", 0.1, 1e6,
              "time between two points of the leveling curve; start and end are points as well",
              &M::interval_s)
        .default_not_written();
    keys.real("transport_interval", "s", 0, 1e6,
              "least time between two of these points with transport, on terrain that deforms; 0: "
              "start and end alone",
              &M::transport_interval_s)
        .default_not_written();
  }
};

}  // namespace screed
