// Which particles are near a point: a uniform grid of cubes a little wider than a particle, each
// with a chain of the particles whose centres are in it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace screed {

class SphereGrid {
 public:
  static constexpr int32_t kNone = -1;

  /// Cubes of at least `edge` over a box of width x depth round (0, 0) and from height 0 to
  /// `height`; beyond the box the outermost cubes go on, or with `periodic` the box repeats in x
  /// and y. A particle is in the cube in which it was put, and at most `slack` away from there.
  SphereGrid(double width, double depth, double height, double edge, bool periodic,
             double slack = 0.0)
      : width_(width),
        depth_(depth),
        slack_(slack),
        columns_x_(std::max(1, static_cast<int>(width / edge))),
        columns_y_(std::max(1, static_cast<int>(depth / edge))),
        layers_(std::max(1, static_cast<int>(height / edge) + 1)),
        edge_x_(width / columns_x_),
        edge_y_(depth / columns_y_),
        edge_z_(edge),
        periodic_(periodic),
        first_(static_cast<size_t>(columns_x_) * static_cast<size_t>(columns_y_) *
                   static_cast<size_t>(layers_),
               kNone) {}

  int columns_x() const { return columns_x_; }
  int columns_y() const { return columns_y_; }
  int layers() const { return layers_; }
  double edge_x() const { return edge_x_; }
  double edge_y() const { return edge_y_; }
  /// No particle of a layer is higher, m; of the highest one there is no limit.
  double layer_top(int layer) const { return (layer + 1) * edge_z_ + slack_; }

  int column_x(double x) const { return inside((x + 0.5 * width_) / edge_x_, columns_x_); }
  int column_y(double y) const { return inside((y + 0.5 * depth_) / edge_y_, columns_y_); }
  int layer(double z) const { return inside(z / edge_z_, layers_); }
  size_t column(int ix, int iy) const {
    return static_cast<size_t>(iy) * static_cast<size_t>(columns_x_) + static_cast<size_t>(ix);
  }
  int32_t cell(int ix, int iy, int layer) const {
    return static_cast<int32_t>(column(ix, iy) * static_cast<size_t>(layers_)) + layer;
  }
  int32_t cell_at(const Eigen::Vector3d& position) const {
    return cell(column_x(position.x()), column_y(position.y()), layer(position.z()));
  }
  size_t column_of_cell(int32_t cell) const {
    return static_cast<size_t>(cell) / static_cast<size_t>(layers_);
  }

  /// The column that (ix, iy) is with the box repeated; false outside a box with walls.
  bool wrap(int& ix, int& iy) const {
    if (!periodic_) return ix >= 0 && ix < columns_x_ && iy >= 0 && iy < columns_y_;
    ix = modulo(ix, columns_x_);
    iy = modulo(iy, columns_y_);
    return true;
  }

  void resize(size_t particles) {
    next_.resize(particles, kNone);
    cell_of_.resize(particles, kNone);
  }
  int32_t first(int32_t cell) const { return first_[static_cast<size_t>(cell)]; }
  int32_t next(int32_t particle) const { return next_[static_cast<size_t>(particle)]; }
  int32_t cell_of(int32_t particle) const { return cell_of_[static_cast<size_t>(particle)]; }

  void insert(int32_t particle, int32_t cell) {
    next_[static_cast<size_t>(particle)] = first_[static_cast<size_t>(cell)];
    first_[static_cast<size_t>(cell)] = particle;
    cell_of_[static_cast<size_t>(particle)] = cell;
  }
  void remove(int32_t particle) {
    int32_t* link = &first_[static_cast<size_t>(cell_of(particle))];
    while (*link != particle) link = &next_[static_cast<size_t>(*link)];
    *link = next(particle);
  }

  /// Calls visit(particle) for all nearer to `position` than `radius`, and others. With `periodic`
  /// on a very small box a particle can come twice.
  template <class Visit>
  void visit_near(const Eigen::Vector3d& position, double radius, const Visit& visit) const {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
    visit_box(position - reach, position + reach, visit);
  }

  /// Calls visit(particle) for all in a box, and others.
  template <class Visit>
  void visit_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                 const Visit& visit) const {
    visit_cells(low, high, [&](int32_t begin, int32_t end) {
      for (int32_t c = begin; c < end; ++c) {
        for (int32_t particle = first(c); particle != kNone; particle = next(particle)) {
          visit(particle);
        }
      }
    });
  }

  /// Calls visit(begin, end) for the cubes with all particles in a box: those that lie one above
  /// the other have numbers that follow each other.
  template <class Visit>
  void visit_cells(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                   const Visit& visit) const {
    const Span x = span(low.x() - slack_, high.x() + slack_, width_, edge_x_, columns_x_);
    const Span y = span(low.y() - slack_, high.y() + slack_, depth_, edge_y_, columns_y_);
    const int bottom = layer(low.z() - slack_);
    const int top = layer(high.z() + slack_);
    for (int iy = y.first; iy <= y.last; ++iy) {
      for (int ix = x.first; ix <= x.last; ++ix) {
        const int32_t begin = cell(modulo(ix, columns_x_), modulo(iy, columns_y_), 0);
        visit(begin + bottom, begin + top + 1);
      }
    }
  }
  size_t cells() const { return first_.size(); }

 private:
  struct Span {
    int first;
    int last;
  };

  static int modulo(int i, int count) {
    if (i >= 0 && i < count) return i;
    const int remainder = i % count;
    return remainder < 0 ? remainder + count : remainder;
  }
  static int inside(double at, int count) {
    // The comparisons also catch what is no number, or too large for an int.
    if (!(at > 0.0)) return 0;
    return at < count ? static_cast<int>(at) : count - 1;
  }
  Span span(double low, double high, double size, double edge, int count) const {
    const double begin = std::floor((low + 0.5 * size) / edge);
    const double end = std::floor((high + 0.5 * size) / edge);
    if (!periodic_) {
      return {static_cast<int>(std::clamp(begin, 0.0, count - 1.0)),
              static_cast<int>(std::clamp(end, 0.0, count - 1.0))};
    }
    if (!(end - begin < count - 1.0) || !(std::abs(begin) < 1e9)) return {0, count - 1};
    return {static_cast<int>(begin), static_cast<int>(end)};
  }

  double width_;
  double depth_;
  double slack_;
  int columns_x_;
  int columns_y_;
  int layers_;
  double edge_x_;
  double edge_y_;
  double edge_z_;
  bool periodic_;
  std::vector<int32_t> first_;  // of each cube
  std::vector<int32_t> next_;   // of each particle
  std::vector<int32_t> cell_of_;
};

}  // namespace screed
