// Frames out of runs.
#include "host_sim/grid/grid_frame.h"

#include <algorithm>

#include "host_sim/grid/grid_run.h"

namespace screed {

uint64_t GridFrame::carried() const {
  return static_cast<uint64_t>(std::count_if(
      agents.begin(), agents.end(), [](const FrameAgent& agent) { return agent.carries; }));
}

GridFrame frame_of(const GridRun& run) {
  GridFrame frame{run.world().terrain(), {}, run.cycles(), run.swarm().counts().units};
  for (size_t i = 0; i < run.swarm().size(); ++i) {
    const AgentView view = run.swarm().view(i);
    frame.agents.push_back({run.world().x(view.place), run.world().y(view.place), view.carries});
  }
  return frame;
}

}  // namespace screed
