// Raised and sunk volume of noisy height maps.
#include "host_sim/soil_validation/moved_volume.h"

#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

/// Adds `volume` to what was raised where `direction` points up, and takes it off what was sunk
/// where it points down.
void count(MovedVolume& moved, double direction, double volume) {
  if (direction > 0.0) moved.raised_m3 += volume;
  if (direction < 0.0) moved.sunk_m3 -= volume;
}

RiseMap sum_of(std::span<const RiseMap> maps) {
  RiseMap sum(maps.empty() ? 0 : maps.front().size(), 0.0);
  for (const RiseMap& map : maps) {
    for (size_t node = 0; node < sum.size(); ++node) sum[node] += map[node];
  }
  return sum;
}

/// Volumes of the mean of all maps but this one.
MovedVolume volume_of_others(const RiseMap& sum, const RiseMap& map, double area_m2,
                             double others) {
  MovedVolume moved;
  for (size_t node = 0; node < sum.size(); ++node) {
    const double rise = (sum[node] - map[node]) / others;
    count(moved, rise, rise * area_m2);
  }
  return moved;
}

}  // namespace

MovedVolume volume_of_means(std::span<const RiseMap> maps, double area_m2, size_t group) {
  MovedVolume moved;
  if (group == 0) return moved;
  const size_t groups = maps.size() / group;
  if (groups == 0) return moved;
  const double share = area_m2 / static_cast<double>(group * groups);
  for (size_t i = 0; i < groups; ++i) {
    for (const double sum : sum_of(maps.subspan(i * group, group))) count(moved, sum, sum * share);
  }
  return moved;
}

MovedVolume volume_without_noise(std::span<const RiseMap> maps, double area_m2) {
  MovedVolume moved;
  if (maps.size() < 2) return moved;
  const RiseMap sum = sum_of(maps);
  const double share = area_m2 / static_cast<double>(maps.size());
  for (const RiseMap& map : maps) {
    for (size_t node = 0; node < sum.size(); ++node)
      count(moved, sum[node] - map[node], map[node] * share);
  }
  return moved;
}

MovedVolume standard_error(std::span<const RiseMap> maps, double area_m2) {
  if (maps.size() < 2) return {};
  const RiseMap sum = sum_of(maps);
  const auto count_of_maps = static_cast<double>(maps.size());
  std::vector<MovedVolume> without;
  MovedVolume mean;
  for (const RiseMap& map : maps) {
    without.push_back(volume_of_others(sum, map, area_m2, count_of_maps - 1.0));
    mean.raised_m3 += without.back().raised_m3 / count_of_maps;
    mean.sunk_m3 += without.back().sunk_m3 / count_of_maps;
  }
  MovedVolume squares;
  for (const MovedVolume& one : without) {
    squares.raised_m3 += portable::pow(one.raised_m3 - mean.raised_m3, 2);
    squares.sunk_m3 += portable::pow(one.sunk_m3 - mean.sunk_m3, 2);
  }
  const double factor = (count_of_maps - 1.0) / count_of_maps;
  return {std::sqrt(factor * squares.raised_m3), std::sqrt(factor * squares.sunk_m3)};
}

}  // namespace screed
