// Material in whole units.
#include "host_sim/soil/material_flow.h"

#include <cmath>
#include <numbers>

namespace screed {
namespace {

struct Step {
  int dx;
  int dy;
};
constexpr Step kNeighbours[8] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                 {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};

}  // namespace

MaterialFlow::MaterialFlow(HeightField surface, double repose_deg) : surface_(std::move(surface)) {
  const double slope =
      std::tan(repose_deg * std::numbers::pi / 180.0) * surface_.spacing_m() / kHeightUnit_m;
  limit_straight_ = static_cast<Height>(std::floor(slope));
  limit_diagonal_ = static_cast<Height>(std::floor(slope * std::numbers::sqrt2));
  const size_t count = static_cast<size_t>(surface_.nx()) * static_cast<size_t>(surface_.ny());
  reference_.resize(count);
  for (size_t node = 0; node < count; ++node) reference_[node] = height(node);
  covered_.assign(count, 0);
  in_ring_.assign(count, 0);
  awake_.assign(count, 0);
  queue_.resize(count);
}

int64_t MaterialFlow::node_at(int ix, int iy) const {
  const int nx = surface_.nx();
  const int ny = surface_.ny();
  if (!surface_.wrap())
    return ix < 0 || iy < 0 || ix >= nx || iy >= ny ? -1 : static_cast<int64_t>(index(ix, iy));
  return static_cast<int64_t>(index(((ix % nx) + nx) % nx, ((iy % ny) + ny) % ny));
}

void MaterialFlow::wake(size_t node) {
  if (awake_[node] != 0) return;
  awake_[node] = 1;
  size_t end = queue_begin_ + queue_size_;
  if (end >= queue_.size()) end -= queue_.size();
  queue_[end] = node;
  ++queue_size_;
}

void MaterialFlow::wake_all() {
  for (size_t node = 0; node < nodes(); ++node) wake(node);
}

void MaterialFlow::change(size_t node, Height units) {
  set_height(node, height(node) + units);
  reference_[node] += units;
  wake(node);
}

void MaterialFlow::sink(size_t node, Height units) {
  set_height(node, height(node) - units);
  in_hand_ += units;
  wake(node);
}

void MaterialFlow::move(size_t from, size_t to, Height units) {
  change(from, -units);
  change(to, units);
}

void MaterialFlow::cover(int ix, int iy) {
  const int64_t node = node_at(ix, iy);
  if (node < 0 || covered_[static_cast<size_t>(node)] != 0) return;
  covered_[static_cast<size_t>(node)] = 1;
  covered_list_.push_back(static_cast<size_t>(node));
}

void MaterialFlow::set_down() {
  if (in_hand_ == 0) return;
  ring_.clear();
  for (const size_t node : covered_list_) {
    for (const Step& step : kNeighbours) {
      const int64_t beside = node_at(column(node) + step.dx, row(node) + step.dy);
      if (beside < 0) continue;
      const auto place = static_cast<size_t>(beside);
      if (covered_[place] != 0 || in_ring_[place] != 0) continue;
      in_ring_[place] = 1;
      ring_.push_back(place);
    }
  }
  for (const size_t place : ring_) in_ring_[place] = 0;
  if (ring_.empty()) return;
  const auto places = static_cast<int64_t>(ring_.size());
  const int64_t each = in_hand_ / places;
  const int64_t rest = in_hand_ % places;
  // What does not divide goes to a few places, each step to others.
  const auto first = static_cast<int64_t>(turn_ % ring_.size());
  turn_ += static_cast<uint64_t>(rest);
  for (int64_t i = 0; i < places; ++i) {
    const int64_t behind = i >= first ? i - first : i - first + places;
    const int64_t units = each + (behind < rest ? 1 : 0);
    if (units != 0) change(ring_[static_cast<size_t>(i)], static_cast<Height>(units));
  }
  in_hand_ = 0;
}

int64_t MaterialFlow::slide(int64_t most) {
  int64_t moves = 0;
  while (queue_size_ > 0 && moves < most) {
    const size_t node = queue_[queue_begin_];
    queue_begin_ = queue_begin_ + 1 == queue_.size() ? 0 : queue_begin_ + 1;
    --queue_size_;
    awake_[node] = 0;
    if (covered_[node] != 0) continue;
    const int x = column(node);
    const int y = row(node);
    for (int k = 0; k < 8; ++k) {
      const int64_t beside = node_at(x + kNeighbours[k].dx, y + kNeighbours[k].dy);
      if (beside < 0 || covered_[static_cast<size_t>(beside)] != 0) continue;
      const auto other = static_cast<size_t>(beside);
      const Height limit = k < 4 ? limit_straight_ : limit_diagonal_;
      const Height difference = height(node) - height(other);
      const Height excess = (difference < 0 ? -difference : difference) - limit;
      if (excess <= 1) continue;
      const Height units = excess / 2;
      if (difference > 0) {
        move(node, other, units);
      } else {
        move(other, node, units);
      }
      ++moves;
    }
  }
  return moves;
}

void MaterialFlow::uncover() {
  // What a body stood on may slide now.
  for (const size_t node : covered_list_) {
    covered_[node] = 0;
    wake(node);
  }
  covered_list_.clear();
}

}  // namespace screed
