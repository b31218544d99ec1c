// How much a height map rose and sank, told from several runs whose single heights are noisy.
//
// Noise adds to both volumes: what truly stays level counts as raised in one place and sunk in the
// next. So the volume of the mean of N maps falls as N grows, to the true one: it is too great,
// on average. In turn, asking the other N - 1 maps where the ground rose and counting there what
// the one map says is too small, on average: a place whose direction the others take wrongly
// counts against it. Between the two lies the volume without noise.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace screed {

struct MovedVolume {
  double raised_m3 = 0.0;
  double sunk_m3 = 0.0;
};

/// Rise of each node in one run, m; all of one size, of nodes that stand for this area each.
using RiseMap = std::vector<double>;

/// Of the mean of so many maps, averaged over all groups of neighbours in the row that are full.
/// 0 when no group is.
MovedVolume volume_of_means(std::span<const RiseMap> maps, double area_m2, size_t group);

/// Counted where the other maps say so, averaged over the maps. 0 for fewer than two maps.
MovedVolume volume_without_noise(std::span<const RiseMap> maps, double area_m2);

/// Standard error of the volume of the mean of all maps, by the jackknife (B. Efron, C. Stein, The
/// jackknife estimate of variance, Annals of Statistics 9(3), 1981). 0 for fewer than two maps.
MovedVolume standard_error(std::span<const RiseMap> maps, double area_m2);

}  // namespace screed
