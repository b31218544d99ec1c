// One contact after the other, for every processor.
#include <math.h>

#include "host_sim/physics/particles/bed_kernel.h"

#define SCREED_BED_TARGET

namespace screed {

namespace {

struct Row {
  double v[4];
};
using Number = float;
constexpr size_t kLanes = 1;

#include "host_sim/physics/particles/contact_alone.inc"

inline Row operator+(const Row& a, const Row& b) {
  return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline Row operator-(const Row& a, const Row& b) {
  return {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2], a.v[3] - b.v[3]}};
}
inline Row operator*(const Row& a, const Row& b) {
  return {{a.v[0] * b.v[0], a.v[1] * b.v[1], a.v[2] * b.v[2], a.v[3] * b.v[3]}};
}
inline Row row(const double* from) {
  return {{from[0], from[1], from[2], from[3]}};
}
inline Row row(double value) {
  return {{value, value, value, value}};
}
inline Row row_of_floats(const float* from) {
  return {{from[0], from[1], from[2], from[3]}};
}
inline void store(const Row& from, double* to) {
  for (int i = 0; i < 4; ++i) to[i] = from.v[i];
}
inline void store_floats(const Row& from, float* to) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<float>(from.v[i]);
}
inline Row down(const Row& a) {
  return {{floor(a.v[0]), floor(a.v[1]), floor(a.v[2]), floor(a.v[3])}};
}
inline Row larger(const Row& a, const Row& b) {
  Row result = b;
  for (int i = 0; i < 4; ++i) {
    if (a.v[i] > b.v[i]) result.v[i] = a.v[i];
  }
  return result;
}
inline Row turned(const Row& a) {
  return {{a.v[1], a.v[2], a.v[0], a.v[3]}};
}
inline Number lanes(const float* from) {
  return *from;
}
inline void store_lanes(Number from, float* to) {
  *to = from;
}
inline void transpose(const float (&rows)[kLanes][4], Number (&columns)[4]) {
  for (int i = 0; i < 4; ++i) columns[i] = rows[0][i];
}
inline void transpose_back(const Number (&columns)[4], float (&rows)[kLanes][4]) {
  for (int i = 0; i < 4; ++i) rows[0][i] = columns[i];
}

#include "host_sim/physics/particles/bed_kernel.inc"

}  // namespace

const BedFunctions kScalarBedFunctions = {collide_pairs, collide_walls, move};

}  // namespace screed
