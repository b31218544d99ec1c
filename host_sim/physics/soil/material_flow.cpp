// Material in whole units.
#include "host_sim/physics/soil/material_flow.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numbers>

#include "host_sim/core/elementary.h"

namespace screed {
namespace {

struct Step {
  int dx;
  int dy;
};
constexpr int kTriesPerStep = 48;           // places tried for what a footprint dug in one step
constexpr double kStanding_m_per_s = 1e-3;  // below it a footprint has no direction
constexpr Step kNeighbours[8] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                 {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};

/// Mean square of x over the band between the rectangles |x| < `inner_x`, |y| < `inner_y` and
/// |x| < `outer_x`, |y| < `outer_y`.
double mean_square(double inner_x, double inner_y, double outer_x, double outer_y) {
  const auto cube = [](double x) { return x * x * x; };
  return (cube(outer_x) * outer_y - cube(inner_x) * inner_y) /
         (3.0 * (outer_x * outer_y - inner_x * inner_y));
}

/// Anything but in step with its argument (the last steps of MurmurHash3, A. Appleby).
uint32_t mixed(uint32_t x) {
  x = (x ^ (x >> 16)) * 0x85EBCA6BU;
  x = (x ^ (x >> 13)) * 0xC2B2AE35U;
  return x ^ (x >> 16);
}

}  // namespace

MaterialFlow::MaterialFlow(HeightField surface, double repose_deg, const Compaction& compaction)
    : grid_(std::move(surface),
            compaction.most_m > 0.0
                ? static_cast<Height>(std::lround(compaction.most_m / kHeightUnit_m))
                : std::numeric_limits<Height>::max()),
      volume_before_(grid_.surface().height_sum()),
      compaction_(compaction),
      queue_(grid_.size()) {
  const double slope = portable::tan(repose_deg * std::numbers::pi / 180.0) *
                       grid_.surface().spacing_m() / kHeightUnit_m;
  limit_straight_ = static_cast<Height>(std::floor(slope));
  limit_diagonal_ = static_cast<Height>(std::floor(slope * std::numbers::sqrt2));
}

void MaterialFlow::enqueue_all() {
  for (size_t node = 0; node < grid_.size(); ++node) {
    if (!grid_[node].queued) push(node);
  }
}

void MaterialFlow::change(const GridNode& place, Height units) {
  grid_.set_height(place, grid_.height(place.node) + units);
  Height& sunk = grid_[place.node].sunk;
  if (units > 0) sunk -= std::min(units, sunk);
  enqueue(place.node);
}

void MaterialFlow::begin_footprint(const PressedPatch& patch) {
  footprints_.push_back({patch, covered_list_.size(), pressed_.size(), 0});
}

void MaterialFlow::dig(const DugPatch& patch, int64_t units, double share_of_pressed) {
  int64_t moved = 0;
  if (share_of_pressed > 0.0) {
    int64_t& pressed = footprints_.back().units;
    taken_remainder_ += share_of_pressed * static_cast<double>(pressed);
    moved = std::min(pressed, static_cast<int64_t>(taken_remainder_));
    taken_remainder_ -= static_cast<double>(moved);
    pressed -= moved;
  }
  const int64_t pressed_moved = moved;
  double total = 0.0;
  if (units > 0) {
    for (const Sheared& here : sheared_) total += here.weight;
  }
  if (total > 0.0) {
    const double per_weight = static_cast<double>(units) / total;
    double passed = 0.0;
    int64_t taken = 0;
    for (size_t i = 0; i < sheared_.size(); ++i) {
      passed += sheared_[i].weight;
      const bool last = i + 1 == sheared_.size();
      const int64_t until =
          last ? units : std::min(units, static_cast<int64_t>(passed * per_weight));
      if (until > taken) {
        const auto here = static_cast<Height>(until - taken);
        const size_t node = sheared_[i].node;
        change(grid_.place(node), -here);
        moved += here - compact(grid_[node], here);
      }
      taken = until;
    }
    in_transit_ += moved - pressed_moved;
    dug_.push_back({patch, moved});
  } else if (moved > 0) {
    dug_.push_back({patch, moved});
  }
  sheared_.clear();
}

// What one footprint cannot deposit goes to the next; what the last cannot waits for the next step.
void MaterialFlow::deposit() {
  for (const Dug& dug : dug_) left_over_ += dug.units - spread_dug(dug);
  dug_.clear();
  for (size_t i = 0; i < footprints_.size(); ++i) {
    ActiveFootprint& footprint = footprints_[i];
    footprint.units += left_over_;
    left_over_ = 0;
    if (footprint.units == 0) continue;
    const bool last = i + 1 == footprints_.size();
    const size_t end = last ? covered_list_.size() : footprints_[i + 1].begin;
    const size_t end_pressed = last ? pressed_.size() : footprints_[i + 1].begin_pressed;
    if (!spread(footprint, end, end_pressed)) left_over_ = footprint.units;
    footprint.units = 0;
  }
}

/// On some nodes around the footprint, other ones each time, so that in a few steps all have got
/// the same: a low-discrepancy sequence over the rectangle and its band. What is carried past the
/// footprint is added in proportion to how far a node lies on its way, and taken on the other side:
/// by the spread of these very nodes, so that it comes as far however much of the band is covered.
/// Returns the units deposited: all or none.
int64_t MaterialFlow::spread_dug(const Dug& dug) {
  // R2 sequence (Roberts 2018): 2^32 / p and 2^32 / p^2, p = 1.3247, the plastic number.
  constexpr uint32_t kAlong = 3242174889U;
  constexpr uint32_t kAcross = 2447445414U;
  constexpr double kPerTurn = 1.0 / 4294967296.0;
  const HeightField& field = grid_.surface();
  const DugPatch& patch = dug.patch;
  const double length = patch.half_length + patch.band;
  const double width = patch.half_width + patch.band;
  const double per_spacing = 1.0 / field.spacing_m();
  double sum_along = 0.0;
  double sum_across = 0.0;
  double squares_along = 0.0;
  double squares_across = 0.0;
  deposit_nodes_.clear();
  for (int i = 0; i < kTriesPerStep; ++i) {
    ++sequence_index_;
    const double along = length * (2.0 * (sequence_index_ * kAlong) * kPerTurn - 1.0);
    const double across = width * (2.0 * (sequence_index_ * kAcross) * kPerTurn - 1.0);
    if (std::abs(along) < patch.half_length && std::abs(across) < patch.half_width) continue;
    const double x = patch.centre.x() + along * patch.forward.x() - across * patch.forward.y();
    const double y = patch.centre.y() + along * patch.forward.y() + across * patch.forward.x();
    GridNode place{0, static_cast<int>(std::floor((x - field.x_min()) * per_spacing + 0.5)),
                   static_cast<int>(std::floor((y - field.y_min()) * per_spacing + 0.5))};
    if (!grid_.find(place) || grid_[place.node].covered) continue;
    deposit_nodes_.push_back({place, along, across});
    sum_along += along;
    sum_across += across;
    squares_along += along * along;
    squares_across += across * across;
  }
  if (deposit_nodes_.empty()) return 0;
  const auto count = static_cast<double>(deposit_nodes_.size());
  const double mean_along = sum_along / count;
  const double mean_across = sum_across / count;
  // Not much less than of the whole band: a few nodes side by side would get all too much.
  const auto variance = [count](double squares, double mean, double whole) {
    return std::max(squares / count - mean * mean, 0.25 * whole);
  };
  const double per_along =
      patch.carried.dot(patch.forward) /
      variance(squares_along, mean_along,
               mean_square(patch.half_length, patch.half_width, length, width));
  const double per_across =
      (patch.forward.x() * patch.carried.y() - patch.forward.y() * patch.carried.x()) /
      variance(squares_across, mean_across,
               mean_square(patch.half_width, patch.half_length, width, length));
  const double each = static_cast<double>(dug.units);
  double sum = 0.0;
  int64_t done = 0;
  for (size_t i = 0; i < deposit_nodes_.size(); ++i) {
    const DepositNode& node = deposit_nodes_[i];
    sum +=
        (each + (node.along - mean_along) * per_along + (node.across - mean_across) * per_across) /
        count;
    const int64_t until = i + 1 < deposit_nodes_.size() ? std::llround(sum) : dug.units;
    if (until != done) change(node.place, static_cast<Height>(until - done));
    done = until;
  }
  in_transit_ -= dug.units;
  return dug.units;
}

/// The free neighbours of a footprint's nodes, row by row: its outline seen from above as bits,
/// grown by one to all sides, less the outline.
void MaterialFlow::find_ring(size_t begin, size_t end) {
  ring_.clear();
  if (begin == end) return;
  int first_x = covered_list_[begin].ix;
  int first_y = covered_list_[begin].iy;
  int last_x = first_x;
  int last_y = first_y;
  for (size_t i = begin; i < end; ++i) {
    const GridNode& here = covered_list_[i];
    first_x = std::min(first_x, here.ix);
    last_x = std::max(last_x, here.ix);
    first_y = std::min(first_y, here.iy);
    last_y = std::max(last_y, here.iy);
  }
  // A margin of one node in bits, and of two rows.
  constexpr size_t kBits = 64;
  const size_t words = (static_cast<size_t>(last_x - first_x) + 3 + kBits - 1) / kBits;
  const size_t rows = static_cast<size_t>(last_y - first_y) + 5;
  if (below_bits_.size() < rows * words) below_bits_.resize(2 * rows * words);
  std::fill(below_bits_.begin(), below_bits_.begin() + static_cast<std::ptrdiff_t>(rows * words),
            uint64_t{0});
  for (size_t i = begin; i < end; ++i) {
    const auto x = static_cast<size_t>(covered_list_[i].ix - first_x) + 1;
    const auto y = static_cast<size_t>(covered_list_[i].iy - first_y) + 2;
    below_bits_[y * words + x / kBits] |= uint64_t{1} << (x % kBits);
  }
  const auto grown = [&](size_t row, size_t word) {  // to the west and east
    const uint64_t* bits = &below_bits_[row * words];
    const uint64_t from_west = word > 0 ? bits[word - 1] >> (kBits - 1) : 0;
    const uint64_t from_east = word + 1 < words ? bits[word + 1] << (kBits - 1) : 0;
    return bits[word] | bits[word] << 1 | bits[word] >> 1 | from_west | from_east;
  };
  for (size_t row = 1; row + 1 < rows; ++row) {
    for (size_t word = 0; word < words; ++word) {
      uint64_t ring = (grown(row - 1, word) | grown(row, word) | grown(row + 1, word)) &
                      ~below_bits_[row * words + word];
      for (; ring != 0; ring &= ring - 1) {
        const auto bit = static_cast<size_t>(std::countr_zero(ring));
        GridNode neighbour{0, first_x - 1 + static_cast<int>(word * kBits + bit),
                           first_y - 2 + static_cast<int>(row)};
        if (!grid_.find(neighbour) || grid_[neighbour.node].covered) continue;
        ring_.push_back({neighbour, 0.0, 0.0});
      }
    }
  }
}

/// Leaves out what lies behind the footprint, where its rut is, and what lies ahead, which it would
/// only press again; if nothing else is there, what lies behind; if nothing is left, nothing.
void MaterialFlow::drop_path(const ActiveFootprint& footprint, size_t end) {
  const Eigen::Vector2d& velocity = footprint.patch.velocity;
  const double speed = std::sqrt(velocity.x() * velocity.x() + velocity.y() * velocity.y());
  if (speed <= kStanding_m_per_s) return;
  const Eigen::Vector2d direction = velocity / speed;
  const auto ahead = [&](const GridNode& place) {
    return place.ix * direction.x() + place.iy * direction.y();
  };
  double rear = std::numeric_limits<double>::infinity();
  double front = -rear;
  for (size_t i = footprint.begin; i < end; ++i) {
    rear = std::min(rear, ahead(covered_list_[i]));
    front = std::max(front, ahead(covered_list_[i]));
  }
  constexpr double kRounding = 1e-6;
  for (const bool ahead_too : {true, false}) {
    const auto on_path = [&](const RingNode& node) {
      const double here = ahead(node.place);
      return here < rear - kRounding || (ahead_too && here > front + kRounding);
    };
    const auto end_kept = std::remove_if(ring_.begin(), ring_.end(), on_path);
    if (end_kept == ring_.begin()) continue;
    ring_.erase(end_kept, ring_.end());
    return;
  }
}

/// Each node's share of what the footprint lays down. By slices of a spacing along the footprint:
/// what is pressed in slice p goes to the ring's nodes in all slices s, with weights
/// exp(-|s - p| spacing / reach) that sum up to one over them. Sums with such weights are two
/// recursions, from either end.
void MaterialFlow::weigh_ring(const ActiveFootprint& footprint, size_t end_pressed) {
  const double spacing = grid_.surface().spacing_m();
  const double decay = portable::exp(-spacing / std::max(spacing, footprint.patch.reach));
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  // From one of the ring's nodes on: the same bits wherever on the grid a footprint stands.
  const GridNode origin = ring_.front().place;
  const Eigen::Vector2d& forward = footprint.patch.forward;
  const auto along = [&](int ix, int iy) {
    return (ix - origin.ix) * forward.x() + (iy - origin.iy) * forward.y();
  };
  for (RingNode& node : ring_) {
    node.along = along(node.place.ix, node.place.iy);
    first = std::min(first, node.along);
    last = std::max(last, node.along);
  }
  // What is pressed lies between the ring's ends, but for a rut that is left out.
  const auto slice = [&](double at) {
    return static_cast<size_t>(std::clamp(at, first, last) - first);
  };
  const size_t slices = slice(last) + 1;
  const auto smooth = [&](std::vector<double>& values) {
    double from_below = 0.0;
    double from_above = 0.0;
    smoothed_.assign(slices, 0.0);
    for (size_t i = 0; i < slices; ++i) {
      smoothed_[i] += from_below;
      from_below = decay * (from_below + values[i]);
    }
    for (size_t i = slices; i-- > 0;) {
      from_above += values[i];
      smoothed_[i] += from_above;
      from_above *= decay;
    }
    values.swap(smoothed_);
  };
  nearby_.assign(slices, 0.0);
  for (const RingNode& node : ring_) nearby_[slice(node.along)] += 1.0;
  smooth(nearby_);
  laid_.assign(slices, 0.0);
  double pressed = 0.0;
  for (size_t i = footprint.begin_pressed; i < end_pressed; ++i) {
    const size_t at = slice(along(pressed_[i].ix, pressed_[i].iy));
    laid_[at] += pressed_[i].units / nearby_[at];
    pressed += pressed_[i].units;
  }
  smooth(laid_);
  for (RingNode& node : ring_) {
    node.share = pressed > 0.0 ? laid_[slice(node.along)] / pressed
                               : 1.0 / static_cast<double>(ring_.size());
  }
}

/// Returns whether it was deposited: all or nothing.
bool MaterialFlow::spread(const ActiveFootprint& footprint, size_t end, size_t end_pressed) {
  find_ring(footprint.begin, end);
  if (ring_.empty()) return false;
  drop_path(footprint, end);
  weigh_ring(footprint, end_pressed);
  // In whole units, and over many steps no place gets more than its share: the sums of shares are
  // rounded down from a threshold, another one each step. Of equal shares each gets one unit more
  // in turn.
  const auto count = static_cast<uint64_t>(ring_.size());
  const bool equal = !std::isfinite(footprint.patch.reach);
  const double threshold =
      equal ? (static_cast<double>(turn_ % count) + 0.5) / static_cast<double>(count)
            : mixed(static_cast<uint32_t>(turn_)) * 0x1p-32;
  turn_ += equal ? static_cast<uint64_t>(footprint.units) % count : 1;
  const auto units = static_cast<double>(footprint.units);
  double sum = threshold;
  int64_t done = 0;
  for (size_t i = 0; i < ring_.size(); ++i) {
    sum += units * ring_[i].share;
    const int64_t until = i + 1 < ring_.size()
                              ? std::min(static_cast<int64_t>(sum), footprint.units)
                              : footprint.units;
    if (until != done) change(ring_[i].place, static_cast<Height>(until - done));
    done = until;
  }
  in_transit_ -= footprint.units;
  return true;
}

/// What a body has left may slide.
void MaterialFlow::release_held() {
  for (const GridNode& here : held_list_) {
    SoilCell& cell = grid_[here.node];
    if (!cell.held || cell.covered) continue;
    cell.held = false;
    enqueue(here.node);
  }
  held_list_.clear();
}

/// Whether a slope beside a node that is not at the border is too steep.
bool MaterialFlow::may_slide(size_t node) const {
  // Four nodes of a row, of which the last is not looked at.
  using Four __attribute__((vector_size(16))) = Height;
  constexpr Height kNever = std::numeric_limits<Height>::max();
  const Height* const here = grid_.surface().heights() + node;
  const auto nx = static_cast<std::ptrdiff_t>(grid_.surface().nx());
  // Half of 1 is 0 units: nothing to move.
  const Height straight = limit_straight_ + 1;
  const Height diagonal = limit_diagonal_ + 1;
  const auto is_steep = [&](std::ptrdiff_t row, const Four& limits) {
    Four beside;
    std::memcpy(&beside, here + row - 1, sizeof beside);
    const Four fall = *here - beside;
    return (fall > limits) | (-fall > limits);
  };
  const Four far_rows = {diagonal, straight, diagonal, kNever};
  const Four steep = is_steep(-nx, far_rows) | is_steep(nx, far_rows) |
                     is_steep(0, Four{straight, straight, straight, kNever});
  std::array<uint64_t, 2> halves{};
  std::memcpy(halves.data(), &steep, sizeof steep);
  return (halves[0] | halves[1]) != 0;
}

/// Slides what is too steep beside a node, neighbour by neighbour; returns the moves made.
int64_t MaterialFlow::slide_around(const GridNode& place) {
  int64_t moves = 0;
  Height here = grid_.height(place.node);
  const bool inside = !grid_[place.node].at_border;
  const auto nx = static_cast<std::ptrdiff_t>(grid_.surface().nx());
  for (int k = 0; k < 8; ++k) {
    const auto [dx, dy] = kNeighbours[k];
    GridNode beside{place.node + static_cast<size_t>(dy * nx + dx), place.ix + dx, place.iy + dy};
    if (!inside && !grid_.find(beside)) continue;
    const Height difference = here - grid_.height(beside.node);
    const Height excess = std::abs(difference) - (k < 4 ? limit_straight_ : limit_diagonal_);
    if (excess <= 1) continue;  // half of 1 is 0 units: nothing to move
    if (grid_[beside.node].covered) continue;
    const Height units = difference > 0 ? excess / 2 : -(excess / 2);
    here -= units;
    change(beside, units);
    ++moves;
  }
  if (moves > 0) change(place, here - grid_.height(place.node));
  return moves;
}

int64_t MaterialFlow::slide(int64_t max_moves) {
  release_held();
  int64_t moves = 0;
  while (queue_size_ > 0 && moves < max_moves) {
    const size_t node = queue_[queue_begin_];
    queue_begin_ = queue_begin_ + 1 == queue_.size() ? 0 : queue_begin_ + 1;
    --queue_size_;
    SoilCell& cell = grid_[node];
    cell.queued = false;
    if (cell.covered || (!cell.at_border && !may_slide(node))) continue;
    moves += slide_around(grid_.place(node));
  }
  if (queue_size_ == 0) queue_begin_ = 0;  // in memory that was used lately
  return moves;
}

void MaterialFlow::uncover() {
  release_held();
  for (const GridNode& here : covered_list_) {
    grid_[here.node].covered = false;
    grid_[here.node].held = true;
  }
  held_list_.swap(covered_list_);
  covered_list_.clear();
  covered_list_.reserve(held_list_.capacity());
  // What was neither deposited nor compacted waits for the next step.
  for (const ActiveFootprint& footprint : footprints_) left_over_ += footprint.units;
  footprints_.clear();
  pressed_.clear();
  dug_.clear();
}

}  // namespace screed
