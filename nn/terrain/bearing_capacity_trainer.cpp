// Segments, and an evolution strategy.
#include "nn/terrain/bearing_capacity_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/terrain/sinkage_replay.h"
#include "nn/terrain/terrain_comparison.h"

namespace screed::nn {
namespace {

constexpr double kMargin_m = 0.3;       // margin round a path
constexpr double kStandstill_s = 10.0;  // a session begins with the robot at standstill
constexpr std::size_t kCandidates = 16;
constexpr double kFirstStep = 0.06;
constexpr double kMaxRelativeError =
    2.0;  // limit of one segment's error: a robot that rocks is not predictable

/// A rectangle of nodes, both ends within it.
struct NodeRectangle {
  int west;
  int south;
  int east;
  int north;
};

HeightField crop(const HeightField& from, const NodeRectangle& nodes) {
  HeightField to(nodes.east - nodes.west + 1, nodes.north - nodes.south + 1, from.spacing_m(),
                 false);
  for (int iy = 0; iy < to.ny(); ++iy) {
    for (int ix = 0; ix < to.nx(); ++ix) {
      to.set_node(ix, iy, from.node(nodes.west + ix, nodes.south + iy));
    }
  }
  return to;
}

/// The nodes round a path; nothing when they reach beyond the bed.
std::optional<NodeRectangle> nodes_around(const DriveStrides& drive, std::size_t begin,
                                          std::size_t end, const HeightField& bed) {
  double west = bed.x_max();
  double east = bed.x_min();
  double south = bed.y_max();
  double north = bed.y_min();
  for (std::size_t i = begin; i < end; ++i) {
    west = std::min(west, drive[i].x_m);
    east = std::max(east, drive[i].x_m);
    south = std::min(south, drive[i].y_m);
    north = std::max(north, drive[i].y_m);
  }
  const auto node = [&](double at, double first) {
    return static_cast<int>(std::floor((at - first) / bed.spacing_m()));
  };
  const NodeRectangle nodes{
      node(west - kMargin_m, bed.x_min()), node(south - kMargin_m, bed.y_min()),
      node(east + kMargin_m, bed.x_min()), node(north + kMargin_m, bed.y_min())};
  if (nodes.west < 0 || nodes.south < 0 || nodes.east >= bed.nx() || nodes.north >= bed.ny()) {
    return std::nullopt;
  }
  return nodes;
}

}  // namespace

std::vector<DriveSegment> segments_of(const DriveStrides& drive, std::size_t most, double seconds) {
  if (!drive.tracks() || !drive.on_soil()) {
    throw InputError(drive.name() + ": a bearing-capacity network learns from tracks on soil");
  }
  const auto length = static_cast<std::size_t>(seconds * kStrideRate_hz);
  const auto first = static_cast<std::size_t>(kStandstill_s * kStrideRate_hz);
  HeightField bed = drive.terrain_after(0);
  std::vector<std::size_t> begins;
  for (std::size_t begin = first; begin + length <= drive.size(); begin += length) {
    if (nodes_around(drive, begin, begin + length, bed).has_value()) begins.push_back(begin);
  }
  std::vector<DriveSegment> segments;
  SinkageReplay pressed(drive);
  for (std::size_t i = 0; i < std::min(most, begins.size()); ++i) {
    const std::size_t begin = begins[i * begins.size() / std::min(most, begins.size())];
    const NodeRectangle nodes = *nodes_around(drive, begin, begin + length, bed);
    const TrackSoilModel& ground = pressed.after(begin);
    const HeightField before = crop(ground.surface(), nodes);
    DriveSegment segment{before,
                         crop(ground.sinkage(), nodes),
                         crop(drive.terrain_after(begin + length), nodes),
                         {},
                         drive.soil(),
                         track_geometry(drive.robot())};
    for (std::size_t stride = begin; stride < begin + length; ++stride) {
      Stride moved = drive[stride];
      moved.x_m -= bed.node_x(nodes.west) - before.x_min();
      moved.y_m -= bed.node_y(nodes.south) - before.y_min();
      segment.path.push_back(moved);
    }
    segment.change_mm = compare(before, segment.after, before).error_mm;
    segments.push_back(std::move(segment));
  }
  return segments;
}

double relative_error(const DriveSegment& segment, const BearingCapacityNetwork* network) {
  TrackSoilModel ground(segment.before, segment.sinkage, segment.soil, segment.tracks);
  for (const Stride& stride : segment.path) ground.step(stride, network);
  const double error = compare(segment.before, segment.after, ground.surface()).error_mm;
  return error * error / (segment.change_mm * segment.change_mm);
}

void train(BearingCapacityNetwork& network, const std::vector<std::vector<DriveSegment>>& drives,
           std::size_t generations, std::uint64_t seed,
           const std::function<void(std::size_t, double)>& progress) {
  constexpr std::size_t kParents = kCandidates / 2;
  const std::size_t count = network.weights().size();
  const auto n = static_cast<double>(count);
  WorldRandom random(seed, "bearing trainer");
  std::vector<double> mean(network.weights().begin(), network.weights().end());
  std::vector<double> variance(count, 1.0);
  std::vector<double> path_step(count, 0.0);
  std::vector<double> path(count, 0.0);
  double step = kFirstStep;

  // Hansen's defaults; the covariance learns faster by (n + 2) / 3, being a diagonal.
  std::array<double, kParents> weight{};
  double all = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < kParents; ++i) {
    weight.at(i) = std::log(kParents + 0.5) - std::log(static_cast<double>(i) + 1.0);
    all += weight.at(i);
  }
  for (double& w : weight) {
    w /= all;
    squares += w * w;
  }
  const double effective = 1.0 / squares;
  const double c_step = (effective + 2.0) / (n + effective + 5.0);
  const double damping =
      1.0 + 2.0 * std::max(0.0, std::sqrt((effective - 1.0) / (n + 1.0)) - 1.0) + c_step;
  const double c_path = (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n);
  const double faster = (n + 2.0) / 3.0;
  const double c_one = faster * 2.0 / ((n + 1.3) * (n + 1.3) + effective);
  const double c_many = std::min(1.0 - c_one, faster * 2.0 * (effective - 2.0 + 1.0 / effective) /
                                                  ((n + 2.0) * (n + 2.0) + effective));
  const double expected = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));

  struct Candidate {
    std::vector<double> z;
    double error = 0.0;
  };
  std::array<Candidate, kCandidates> candidates;
  for (std::size_t generation = 0; generation < generations; ++generation) {
    double sum = 0.0;
    for (Candidate& one : candidates) {
      one.z.resize(count);
      for (std::size_t i = 0; i < count; ++i) {
        one.z[i] = random.normal();
        network.weights()[i] =
            static_cast<float>(mean[i] + step * std::sqrt(variance[i]) * one.z[i]);
      }
      one.error = 0.0;
      for (const std::vector<DriveSegment>& segments : drives) {
        if (segments.empty()) continue;
        one.error += std::min(kMaxRelativeError,
                              relative_error(segments[generation % segments.size()], &network));
      }
      sum += one.error;
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
    double length = 0.0;
    std::vector<double> moved(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < kParents; ++k) moved[i] += weight.at(k) * candidates.at(k).z[i];
      path_step[i] =
          (1.0 - c_step) * path_step[i] + std::sqrt(c_step * (2.0 - c_step) * effective) * moved[i];
      length += path_step[i] * path_step[i];
    }
    length = std::sqrt(length);
    const double steady =
        std::sqrt(1.0 - std::pow(1.0 - c_step, 2.0 * static_cast<double>(generation + 1)));
    const bool stalls = length / steady < (1.4 + 2.0 / (n + 1.0)) * expected;
    for (std::size_t i = 0; i < count; ++i) {
      const double root = std::sqrt(variance[i]);
      mean[i] += step * root * moved[i];
      path[i] = (1.0 - c_path) * path[i];
      if (stalls) path[i] += std::sqrt(c_path * (2.0 - c_path) * effective) * root * moved[i];
      double many = 0.0;
      for (std::size_t k = 0; k < kParents; ++k) {
        many += weight.at(k) * variance[i] * candidates.at(k).z[i] * candidates.at(k).z[i];
      }
      variance[i] =
          (1.0 - c_one - c_many) * variance[i] + c_one * path[i] * path[i] + c_many * many;
    }
    step *= std::exp(c_step / damping * (length / expected - 1.0));
    for (std::size_t i = 0; i < count; ++i) network.weights()[i] = static_cast<float>(mean[i]);
    if (progress) progress(generation, sum / static_cast<double>(kCandidates * drives.size()));
  }
}

}  // namespace screed::nn
