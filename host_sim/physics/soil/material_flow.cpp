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

}  // namespace

MaterialFlow::MaterialFlow(HeightField surface, double repose_deg, const Compaction& compaction)
    : surface_(std::move(surface)), compaction_(compaction) {
  const double slope =
      std::tan(repose_deg * std::numbers::pi / 180.0) * surface_.spacing_m() / kHeightUnit_m;
  limit_straight_ = static_cast<Height>(std::floor(slope));
  limit_diagonal_ = static_cast<Height>(std::floor(slope * std::numbers::sqrt2));
  const size_t count = static_cast<size_t>(surface_.nx()) * static_cast<size_t>(surface_.ny());
  sunk_.assign(count, 0);
  if (compaction.most_m > 0.0) {
    loose_.assign(count, static_cast<Height>(std::lround(compaction.most_m / kHeightUnit_m)));
  }
  flags_.assign(count, 0);
  queue_.resize(count);
  const int nx = surface_.nx();
  const int ny = surface_.ny();
  for (int ix = 0; ix < nx; ++ix) flags_[index(ix, 0)] = flags_[index(ix, ny - 1)] = kBorder;
  for (int iy = 0; iy < ny; ++iy) flags_[index(0, iy)] = flags_[index(nx - 1, iy)] = kBorder;
  flags_[index(nx - 2, ny - 2)] = kBorder;
}

void MaterialFlow::enqueue_all() {
  for (size_t node = 0; node < nodes(); ++node) {
    if ((flags_[node] & kQueued) == 0) push(node);
  }
}

void MaterialFlow::change(const GridNode& place, Height units) {
  const Height changed = height(place.node) + units;
  if (on_field(place.ix, place.iy)) {  // quicker than finding column and row by division
    surface_.set_node(place.ix, place.iy, changed);
  } else {
    set_height(place.node, changed);
  }
  if (units > 0) sunk_[place.node] -= std::min(units, sunk_[place.node]);
  enqueue(place.node);
}

size_t MaterialFlow::begin_footprint(double velocity_x, double velocity_y) {
  const double speed = std::sqrt(velocity_x * velocity_x + velocity_y * velocity_y);
  const double scale = speed > kStanding_m_per_s ? 1.0 / speed : 0.0;
  footprints_.push_back({covered_list_.size(), velocity_x * scale, velocity_y * scale, 0});
  return footprints_.size() - 1;
}

void MaterialFlow::dig(const DugPatch& patch, int64_t units) {
  double total = 0.0;
  for (const Sheared& here : sheared_) total += here.weight;
  if (total > 0.0 && units > 0) {
    const double per_weight = static_cast<double>(units) / total;
    double passed = 0.0;
    int64_t taken = 0;
    int64_t moved = 0;
    for (size_t i = 0; i < sheared_.size(); ++i) {
      passed += sheared_[i].weight;
      const bool last = i + 1 == sheared_.size();
      const int64_t until =
          last ? units : std::min(units, static_cast<int64_t>(passed * per_weight));
      if (until > taken) {
        const auto here = static_cast<Height>(until - taken);
        change(sheared_[i].node, -here);
        moved += here - compact(sheared_[i].node, here);
      }
      taken = until;
    }
    in_transit_ += moved;
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
    const size_t end = i + 1 < footprints_.size() ? footprints_[i + 1].begin : covered_list_.size();
    left_over_ = footprint.units - spread(footprint, end);
    footprint.units = 0;
  }
}

/// On some nodes around the footprint, other ones each time, so that in a few steps all have got
/// the same: a low-discrepancy sequence over the rectangle and its band. What is carried past the
/// footprint is added in proportion to how far a node lies on its way, and taken on the other side.
/// Returns the units deposited: all or none.
int64_t MaterialFlow::spread_dug(const Dug& dug) {
  // R2 sequence (Roberts 2018): 2^32 / p and 2^32 / p^2, p = 1.3247, the plastic number.
  constexpr uint32_t kAlong = 3242174889U;
  constexpr uint32_t kAcross = 2447445414U;
  constexpr double kPerTurn = 1.0 / 4294967296.0;
  const DugPatch& patch = dug.patch;
  const double length = patch.half_length + patch.band;
  const double width = patch.half_width + patch.band;
  const double per_spacing = 1.0 / surface_.spacing_m();
  const double weight_along = patch.carried.dot(patch.forward) /
                              mean_square(patch.half_length, patch.half_width, length, width);
  const double weight_across =
      (patch.forward.x() * patch.carried.y() - patch.forward.y() * patch.carried.x()) /
      mean_square(patch.half_width, patch.half_length, width, length);
  double weights = 0.0;
  deposit_nodes_.clear();
  for (int i = 0; i < kTriesPerStep; ++i) {
    ++sequence_index_;
    const double along = length * (2.0 * (sequence_index_ * kAlong) * kPerTurn - 1.0);
    const double across = width * (2.0 * (sequence_index_ * kAcross) * kPerTurn - 1.0);
    if (std::abs(along) < patch.half_length && std::abs(across) < patch.half_width) continue;
    const double x = patch.centre.x() + along * patch.forward.x() - across * patch.forward.y();
    const double y = patch.centre.y() + along * patch.forward.y() + across * patch.forward.x();
    GridNode place{0, static_cast<int>(std::floor((x - surface_.x_min()) * per_spacing + 0.5)),
                   static_cast<int>(std::floor((y - surface_.y_min()) * per_spacing + 0.5))};
    const int64_t node = node_at(place.ix, place.iy);
    if (node < 0 || (flags_[static_cast<size_t>(node)] & kCovered) != 0) continue;
    place.node = static_cast<size_t>(node);
    deposit_nodes_.push_back({place, along * weight_along + across * weight_across});
    weights += deposit_nodes_.back().weight;
  }
  if (deposit_nodes_.empty()) return 0;
  const auto count = static_cast<double>(deposit_nodes_.size());
  const double each = (static_cast<double>(dug.units) - weights / count) / count;
  double sum = 0.0;
  int64_t done = 0;
  for (size_t i = 0; i < deposit_nodes_.size(); ++i) {
    const DepositNode& node = deposit_nodes_[i];
    sum += each + node.weight / count;
    const int64_t until = i + 1 < deposit_nodes_.size() ? std::llround(sum) : dug.units;
    if (until != done) change(node.place, static_cast<Height>(until - done));
    done = until;
  }
  in_transit_ -= dug.units;
  return dug.units;
}

/// The free neighbours of a footprint's nodes, row by row: its outline seen from above as bits,
/// grown by one to all sides, less the outline.
void MaterialFlow::find_ring(const ActiveFootprint& footprint, size_t end) {
  ring_.clear();
  if (footprint.begin == end) return;
  int first_x = covered_list_[footprint.begin].ix;
  int first_y = covered_list_[footprint.begin].iy;
  int last_x = first_x;
  int last_y = first_y;
  for (size_t i = footprint.begin; i < end; ++i) {
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
  for (size_t i = footprint.begin; i < end; ++i) {
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
        const int64_t node = node_at(neighbour.ix, neighbour.iy);
        if (node < 0 || (flags_[static_cast<size_t>(node)] & kCovered) != 0) continue;
        neighbour.node = static_cast<size_t>(node);
        ring_.push_back(neighbour);
      }
    }
  }
}

/// Returns the units deposited: all or none.
int64_t MaterialFlow::spread(const ActiveFootprint& footprint, size_t end) {
  find_ring(footprint, end);
  if (ring_.empty()) return 0;
  const auto ahead = [&](const GridNode& neighbour) {
    return neighbour.ix * footprint.direction_x + neighbour.iy * footprint.direction_y;
  };
  double rear = std::numeric_limits<double>::infinity();
  for (size_t i = footprint.begin; i < end; ++i) rear = std::min(rear, ahead(covered_list_[i]));
  // Behind the footprint lies its rut.
  constexpr double kRounding = 1e-6;
  const auto behind = [&](const GridNode& neighbour) {
    return ahead(neighbour) < rear - kRounding;
  };
  const auto open = static_cast<size_t>(
      std::count_if(ring_.begin(), ring_.end(), [&](const GridNode& p) { return !behind(p); }));
  if (open > 0 && open < ring_.size()) {
    ring_.erase(std::remove_if(ring_.begin(), ring_.end(), behind), ring_.end());
  }
  const auto count = static_cast<int64_t>(ring_.size());
  const int64_t each = footprint.units / count;
  const int64_t remainder = footprint.units % count;
  // The remainder goes to a few nodes, each step to others.
  const auto first = static_cast<int64_t>(turn_ % ring_.size());
  turn_ += static_cast<uint64_t>(remainder);
  for (int64_t i = 0; i < count; ++i) {
    const int64_t after = i >= first ? i - first : i - first + count;
    const int64_t units = each + (after < remainder ? 1 : 0);
    if (units != 0) change(ring_[static_cast<size_t>(i)], static_cast<Height>(units));
  }
  in_transit_ -= footprint.units;
  return footprint.units;
}

/// What a body has left may slide.
void MaterialFlow::release_held() {
  for (const GridNode& here : held_list_) {
    uint8_t& flags = flags_[here.node];
    if ((flags & (kHeld | kCovered)) != kHeld) continue;
    flags &= static_cast<uint8_t>(~kHeld);
    enqueue(here.node);
  }
}

/// Whether a slope beside a node that is not at the border is too steep.
bool MaterialFlow::may_slide(size_t node) const {
  // Four nodes of a row, of which the last is not looked at.
  using Four __attribute__((vector_size(16))) = Height;
  constexpr Height kNever = std::numeric_limits<Height>::max();
  const Height* const here = surface_.heights() + node;
  const auto nx = static_cast<std::ptrdiff_t>(surface_.nx());
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
  Height here = height(place.node);
  const bool inside = (flags_[place.node] & kBorder) == 0;
  const auto nx = static_cast<std::ptrdiff_t>(surface_.nx());
  for (int k = 0; k < 8; ++k) {
    const auto [dx, dy] = kNeighbours[k];
    GridNode beside{place.node + static_cast<size_t>(dy * nx + dx), place.ix + dx, place.iy + dy};
    if (!inside) {
      const int64_t node = node_at(beside.ix, beside.iy);
      if (node < 0) continue;
      beside.node = static_cast<size_t>(node);
    }
    const Height difference = here - height(beside.node);
    const Height excess = std::abs(difference) - (k < 4 ? limit_straight_ : limit_diagonal_);
    if (excess <= 1) continue;  // half of 1 is 0 units: nothing to move
    if ((flags_[beside.node] & kCovered) != 0) continue;
    const Height units = difference > 0 ? excess / 2 : -(excess / 2);
    here -= units;
    change(beside, units);
    ++moves;
  }
  if (moves > 0) change(place, here - height(place.node));
  return moves;
}

int64_t MaterialFlow::slide(int64_t max_moves) {
  release_held();
  int64_t moves = 0;
  while (queue_size_ > 0 && moves < max_moves) {
    const size_t node = queue_[queue_begin_];
    queue_begin_ = queue_begin_ + 1 == queue_.size() ? 0 : queue_begin_ + 1;
    --queue_size_;
    uint8_t& flags = flags_[node];
    flags &= static_cast<uint8_t>(~kQueued);
    if ((flags & kCovered) != 0) continue;
    if ((flags & kBorder) == 0 && !may_slide(node)) continue;
    moves += slide_around({node, column(node), row(node)});
  }
  if (queue_size_ == 0) queue_begin_ = 0;  // in memory that was used lately
  return moves;
}

void MaterialFlow::uncover() {
  release_held();
  for (const GridNode& here : covered_list_) {
    uint8_t& flags = flags_[here.node];
    flags = static_cast<uint8_t>((flags & ~kCovered) | kHeld);
  }
  held_list_.swap(covered_list_);
  covered_list_.clear();
  covered_list_.reserve(held_list_.capacity());
  // What was neither deposited nor compacted waits for the next step.
  for (const ActiveFootprint& footprint : footprints_) left_over_ += footprint.units;
  footprints_.clear();
  dug_.clear();
}

}  // namespace screed
