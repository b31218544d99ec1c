// What the grid world looks like at one moment, and a whole run of such moments in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/grid/grid_run.h"
#include "host_sim/grid/grid_world.h"

namespace screed {

class GridRun;

struct FrameAgent {
  int x;
  int y;
  bool carries;
};

/// One moment: the live view and the ray-traced picture draw it; it comes from a run or from a
/// recording.
struct GridFrame {
  GridTerrain terrain;
  std::vector<FrameAgent> agents;
  uint64_t cycle = 0;
  uint64_t units = 0;

  [[nodiscard]] uint64_t carried() const;
};

GridFrame frame_of(const GridRun& run);

// A run of the grid world in an HDF5 file: the terrain before and after, and where every agent
// stood and what it did in every cycle. It replays without the program that made it.
//
//   attributes           format = "screed grid run", format_version, program_version, and every
//                        value of describe(); cycles, units
//   heights_before/_after  uint16 [rows, columns], row 0 = least y
//   places               uint32 [cycles + 1, agents], y * columns + x; row 0 is the start
//   operations           uint8 [cycles, agents]: 0 none, 1 pick-up, 2 deposit; row i happened on
//                        the cells of places[i], then the agents stepped to places[i + 1]

/// Records a run while it goes on. The file has its name only when finish() has returned.
class GridRecorder {
 public:
  /// Throws InputError when the file exists already, RunError when it cannot be created.
  GridRecorder(const std::filesystem::path& path, const GridRun& run,
               const std::string& program_version);
  GridRecorder(const GridRecorder&) = delete;
  GridRecorder& operator=(const GridRecorder&) = delete;
  /// Without finish() nothing stays.
  ~GridRecorder();

  /// After each cycle.
  void add_cycle(const GridRun& run);
  void finish(const GridRun& run);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// A recording in memory, played cycle by cycle.
class GridReplay {
 public:
  /// Throws InputError, one line with the path, for anything that is not a whole recording.
  explicit GridReplay(const std::filesystem::path& path);

  [[nodiscard]] const GridFrame& frame() const { return frame_; }
  [[nodiscard]] uint64_t cycles() const { return cycles_; }
  [[nodiscard]] bool finished() const { return frame_.cycle == cycles_; }
  /// Plays the next cycle. Throws InputError for an operation that the terrain does not allow.
  void cycle();
  /// Whether the terrain after the last cycle is the recorded one.
  [[nodiscard]] bool matches() const { return frame_.terrain.heights == after_; }
  /// A recorded value of describe().
  [[nodiscard]] const std::string& value(const std::string& name) const;

 private:
  void place_agents();

  std::filesystem::path path_;
  uint64_t cycles_ = 0;
  size_t agents_ = 0;
  std::vector<uint32_t> places_;
  std::vector<uint8_t> operations_;
  std::vector<uint16_t> after_;
  std::vector<std::pair<std::string, std::string>> values_;
  GridFrame frame_;
};

}  // namespace screed
