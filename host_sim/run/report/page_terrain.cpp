// Sparse differences of quantised maps.
#include "host_sim/run/report/page_terrain.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/report/page_file.h"
#include "host_sim/run/comparison/comparison_picture.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/simulation/outcome.h"

namespace screed {

namespace {

constexpr double kFinestUnit_m = 1e-4;
constexpr double kUnits = 65535.0;

void append_leb128(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  while (value >= 0x80U) {
    bytes.push_back(static_cast<std::uint8_t>(value | 0x80U));
    value >>= 7U;
  }
  bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint32_t zigzag(std::int32_t value) {
  return value < 0 ? 2U * static_cast<std::uint32_t>(-(value + 1)) + 1U
                   : 2U * static_cast<std::uint32_t>(value);
}

/// One after the other as one.
CoarseChanges joined(const CoarseChanges& a, const CoarseChanges& b) {
  CoarseChanges both;
  auto ia = a.begin();
  auto ib = b.begin();
  while (ia != a.end() || ib != b.end()) {
    if (ib == b.end() || (ia != a.end() && ia->node < ib->node)) {
      both.push_back(*ia++);
    } else if (ia == a.end() || ib->node < ia->node) {
      both.push_back(*ib++);
    } else {
      if (ia->by + ib->by != 0) both.push_back({ia->node, ia->by + ib->by});
      ++ia;
      ++ib;
    }
  }
  return both;
}

/// Places of the merged nodes along one side: the middle of those that each stands for.
std::vector<double> places(double origin_m, double spacing_m, int nodes, int merged) {
  std::vector<double> result;
  for (int first = 0; first < nodes; first += merged) {
    const int last = std::min(first + merged, nodes) - 1;
    result.push_back(origin_m + 0.5 * (first + last) * spacing_m);
  }
  return result;
}

int merged_nodes(const HeightMapGeometry& g, int max_side) {
  return (static_cast<int>(std::max(g.nx, g.ny)) + max_side - 1) / max_side;
}

}  // namespace

CoarseGrid::CoarseGrid(const HeightMapGeometry& g, int max_side)
    : merged(merged_nodes(g, max_side)),
      x_m(places(g.origin_x_m, g.spacing_m, static_cast<int>(g.nx), merged)),
      y_m(places(g.origin_y_m, g.spacing_m, static_cast<int>(g.ny), merged)) {}

std::vector<double> CoarseGrid::heights_m(const HeightField& field) const {
  std::vector<double> heights;
  heights.reserve(nodes());
  for (int south = 0; south < field.ny(); south += merged) {
    for (int west = 0; west < field.nx(); west += merged) {
      std::int64_t sum = 0;
      const int north = std::min(south + merged, field.ny());
      const int east = std::min(west + merged, field.nx());
      for (int iy = south; iy < north; ++iy) {
        for (int ix = west; ix < east; ++ix) sum += field.node(ix, iy);
      }
      heights.push_back(kHeightUnit_m * static_cast<double>(sum) /
                        ((north - south) * (east - west)));
    }
  }
  return heights;
}

HeightSteps::HeightSteps(const CoarseGrid& grid, const HeightField& first, double low_m,
                         double high_m)
    : grid_(grid),
      scale_{low_m, std::max(kFinestUnit_m, (high_m - low_m) / kUnits)},
      start_(quantised(first)),
      now_(start_) {}

std::vector<std::uint16_t> HeightSteps::quantised(const HeightField& field) const {
  std::vector<std::uint16_t> units;
  units.reserve(grid_.nodes());
  for (const double height_m : grid_.heights_m(field)) {
    const double unit = std::round((height_m - scale_.low_m) / scale_.unit_m);
    units.push_back(static_cast<std::uint16_t>(std::clamp(unit, 0.0, kUnits)));
  }
  return units;
}

void HeightSteps::add(const HeightField& field) {
  const std::vector<std::uint16_t> next = quantised(field);
  CoarseChanges changes;
  for (std::size_t i = 0; i < next.size(); ++i) {
    if (next[i] != now_[i]) {
      changes.push_back({static_cast<std::uint32_t>(i), std::int32_t{next[i]} - now_[i]});
    }
  }
  steps_.push_back(std::move(changes));
  now_ = next;
}

std::uint32_t HeightSteps::fit(std::size_t max_bytes) {
  std::uint32_t moments = 1;
  while (steps_.size() > 1 && deflated(packed_steps()).size() > max_bytes) {
    std::vector<CoarseChanges> fewer;
    for (std::size_t i = 0; i < steps_.size(); i += 2) {
      fewer.push_back(i + 1 < steps_.size() ? joined(steps_[i], steps_[i + 1]) : steps_[i]);
    }
    steps_ = std::move(fewer);
    moments *= 2;
  }
  return moments;
}

std::vector<std::uint8_t> HeightSteps::packed_start() const {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * start_.size());
  const std::size_t columns = grid_.x_m.size();
  for (std::size_t i = 0; i < start_.size(); ++i) {
    const std::uint32_t left = i % columns == 0 ? 0U : start_[i - 1];
    const std::uint32_t difference = std::uint32_t{start_[i]} - left;
    bytes.push_back(static_cast<std::uint8_t>(difference));
    bytes.push_back(static_cast<std::uint8_t>(difference >> 8U));
  }
  return bytes;
}

std::vector<std::uint8_t> HeightSteps::packed_steps() const {
  std::vector<std::uint8_t> bytes;
  for (const CoarseChanges& changes : steps_) {
    append_leb128(bytes, static_cast<std::uint32_t>(changes.size()));
    std::uint32_t next = 0;
    for (const CoarseChange& change : changes) {
      append_leb128(bytes, change.node - next);
      append_leb128(bytes, zigzag(change.by));
      next = change.node + 1;
    }
  }
  return bytes;
}

// Goes through the recorded heights once.

namespace {

// What the changes of the terrain may take, deflated: 2.7 MB as text.
constexpr std::size_t kMaxStepBytes = 2'000'000;
// Work for one page: nodes of all maps that are looked at, and of those that are measured.
constexpr std::uint64_t kMaxMapNodes = 200'000'000;
constexpr std::uint64_t kMaxMeasuredNodes = 20'000'000;

/// Every n-th of `count` things, so that they have no more than `max_nodes` nodes together, but the
/// first and the last in any case.
std::uint64_t stride(std::uint64_t count, std::uint64_t nodes, std::uint64_t max_nodes) {
  const std::uint64_t most =
      std::max<std::uint64_t>(20, max_nodes / std::max<std::uint64_t>(1, nodes));
  return (count + most - 1) / most;
}

/// A figure of the terrain as it is on the page, in the unit of TerrainRow.
struct TerrainRow {
  const char* name;
  const char* unit;
  double factor;  ///< from that of TerrainFigures
  double (*value)(const TerrainFigures&);
};

constexpr TerrainRow kTerrainRows[] = {
    {"Height about level (rms)", "mm", kMmPerM,
     [](const TerrainFigures& it) { return it.robot_scale.level_deviation_m; }},
    {"Lowest height", "mm", kMmPerM, [](const TerrainFigures& it) { return it.heights.lowest_m; }},
    {"Highest height", "mm", kMmPerM,
     [](const TerrainFigures& it) { return it.heights.highest_m; }},
    {"Height deviation (standard)", "mm", kMmPerM,
     [](const TerrainFigures& it) { return it.heights.height_deviation_m; }},
    {"Relief at robot scale (rms)", "mm", kMmPerM,
     [](const TerrainFigures& it) { return it.robot_scale.relief_m; }},
    {"Roughness at robot scale (rms)", "mm", kMmPerM,
     [](const TerrainFigures& it) { return it.robot_scale.roughness_m; }},
    {"Mean slope", "deg", 1.0, [](const TerrainFigures& it) { return it.heights.mean_slope_deg; }},
    {"Slope that 95 % of the cells do not exceed", "deg", 1.0,
     [](const TerrainFigures& it) { return it.heights.p95_slope_deg; }},
    {"Flat cells", "%", 100.0, [](const TerrainFigures& it) { return it.flatness; }},
};

Json before_and_after(const TerrainOutcome& outcome) {
  Json rows = Json::array();
  for (const TerrainRow& row : kTerrainRows) {
    rows.push_back({{"name", row.name},
                    {"unit", row.unit},
                    {"before", row.factor * row.value(outcome.before)},
                    {"after", row.factor * row.value(outcome.after)}});
  }
  return rows;
}

Json change_figures(const TerrainChange& change) {
  const auto figure = [](const char* name, const char* unit, double value) {
    return Json{{"name", name}, {"unit", unit}, {"value", value}};
  };
  return {figure("Ground moved", "L", kLitresPerM3 * change.moved_m3()),
          figure("Cut", "L", kLitresPerM3 * change.cut_m3),
          figure("Fill", "L", kLitresPerM3 * change.fill_m3),
          figure("Deepest cut", "mm", kMmPerM * change.deepest_cut_m),
          figure("Highest fill", "mm", kMmPerM * change.deepest_fill_m)};
}

/// Curves of the figures that lengths and shares are the unit of.
class TerrainCurves {
 public:
  void add(double time_s, const TerrainFigures& figures) {
    times_s_.push_back(time_s);
    level_mm_.push_back(kMmPerM * figures.robot_scale.level_deviation_m);
    relief_mm_.push_back(kMmPerM * figures.robot_scale.relief_m);
    roughness_mm_.push_back(kMmPerM * figures.robot_scale.roughness_m);
    flat_percent_.push_back(100.0 * figures.flatness);
  }
  Json finish(PageFile& page) const {
    page.add_numbers("terrain-times", std::span(times_s_));
    Json panels = Json::array();
    const auto series = [&](const char* label, const char* block,
                            const std::vector<double>& values) {
      page.add_numbers(block, std::span(values));
      return Json{{"label", label}, {"block", block}};
    };
    panels.push_back(
        {{"title", "Terrain, whole bed"},
         {"unit", "mm"},
         {"times", "terrain-times"},
         {"series",
          Json::array({series("height about level", "terrain-level", level_mm_),
                       series("relief (robot scale)", "terrain-relief", relief_mm_),
                       series("roughness (robot scale)", "terrain-roughness", roughness_mm_)})}});
    panels.push_back({{"title", "Flat cells"},
                      {"unit", "%"},
                      {"times", "terrain-times"},
                      {"series", Json::array({series("flat", "terrain-flat", flat_percent_)})}});
    return panels;
  }

 private:
  std::vector<double> times_s_;
  std::vector<double> level_mm_;
  std::vector<double> relief_mm_;
  std::vector<double> roughness_mm_;
  std::vector<double> flat_percent_;
};

Json colors(Color (*color)(double), double low, double high) {
  constexpr int kColors = 64;
  Json list = Json::array();
  for (int i = 0; i <= kColors; ++i) {
    const Color c = color(low + (high - low) * i / kColors);
    list.push_back(
        {std::lround(255.0 * c.red), std::lround(255.0 * c.green), std::lround(255.0 * c.blue)});
  }
  return list;
}

/// Makes the range hold all of the heights.
void widen(std::vector<double>& range_m, const std::vector<double>& heights_m) {
  const auto [low, high] = std::minmax_element(heights_m.begin(), heights_m.end());
  range_m[0] = std::min(range_m[0], *low);
  range_m[1] = std::max(range_m[1], *high);
}

}  // namespace

Json add_terrain(PageFile& page, const SessionReader& session, std::span<const std::uint64_t> stops,
                 const TaskProgress& progress) {
  const std::optional<HeightMap> before_map = session.terrain_before();
  if (!before_map) return nullptr;
  const HeightMapGeometry& geometry = before_map->geometry;
  const TerrainMeasure measure(setup_of(session.info(), {}).experiment);
  const HeightField before = measure.surface(field_of(*before_map));
  std::optional<HeightField> after;
  if (const std::optional<HeightMap> map = session.terrain_after();
      map && map->geometry == geometry) {
    after = measure.surface(field_of(*map));
  }
  const CoarseGrid grid(geometry);
  std::vector<double> range_m = {1e9, -1e9};
  widen(range_m, grid.heights_m(before));
  if (after) widen(range_m, grid.heights_m(*after));
  double low_m = range_m[0];
  double high_m = range_m[1];
  if (session.has_heights() && !measure.is_filtered()) {
    const HeightExtremes extremes = session.height_extremes();
    low_m = std::min(low_m, extremes.lowest * geometry.unit_m);
    high_m = std::max(high_m, extremes.highest * geometry.unit_m);
  } else {
    // Between the two ends a filtered surface may go a little beyond both.
    const double margin_m = 0.1 * (high_m - low_m) + 0.01;
    low_m -= margin_m;
    high_m += margin_m;
  }

  HeightSteps steps(grid, before, low_m, high_m);
  TerrainCurves curves;
  const auto figures = [&](const HeightField& field) {
    return measure.outcome(field, field).after;
  };
  std::vector<std::uint64_t> step_stops;  // indices of `stops`
  curves.add(0.0, figures(before));
  const double tick_s = 1.0 / session.info().tick_rate_hz;
  const auto time_after = [&](std::uint64_t row) { return static_cast<double>(row + 1) * tick_s; };
  if (session.has_heights()) {
    const std::uint64_t nodes = before_map->heights.size();
    const std::uint64_t every = stride(stops.size(), nodes, kMaxMapNodes);
    const std::uint64_t measured = stride(stops.size(), nodes, kMaxMeasuredNodes);
    for (std::uint64_t i = 0; i < stops.size(); ++i) {
      const bool last = i + 1 == stops.size();
      report_progress(progress, "reading the terrain", i, stops.size());
      const bool shown = i % every == 0 || last;
      const bool counted = i % measured == 0 || last;
      if (!shown && !counted) continue;
      const HeightField field = measure.surface(field_of(session.heights_after(stops[i] + 1)));
      if (shown) {
        steps.add(field);
        step_stops.push_back(i);
      }
      if (counted) curves.add(time_after(stops[i]), figures(field));
    }
  } else if (after) {
    steps.add(*after);
    step_stops.push_back(stops.size() - 1);
    curves.add(time_after(stops.back()), figures(*after));
  }

  // Of joined moments the last is where the terrain is known.
  const std::uint32_t joined = steps.fit(kMaxStepBytes);
  std::vector<std::uint64_t> kept;
  for (std::size_t i = 0; i < steps.steps(); ++i) {
    kept.push_back(step_stops[std::min<std::size_t>((i + 1) * joined, step_stops.size()) - 1]);
  }
  page.add_block("terrain-start", steps.packed_start());
  page.add_block("terrain-steps", steps.packed_steps());

  Json json;
  json["x_m"] = grid.x_m;
  json["y_m"] = grid.y_m;
  json["merged"] = grid.merged;
  json["spacing_m"] = geometry.spacing_m;
  json["wrap"] = geometry.wrap;
  json["walls"] = geometry.walls;
  json["low_m"] = steps.scale().low_m;
  json["unit_m"] = steps.scale().unit_m;
  json["color_range_m"] = range_m;
  json["step_stops"] = kept;
  json["recorded"] = session.has_heights();
  json["filtered"] = measure.is_filtered();
  json["flat_deg"] = measure.flat_deg();
  json["height_colors"] = colors(height_color, 0.0, 1.0);
  json["change_colors"] = colors(difference_color, -1.0, 1.0);
  json["curves"] = curves.finish(page);
  json["change_limit_m"] = 1e-3;
  if (after) {
    const std::vector<double> from = grid.heights_m(before);
    std::vector<double> change = grid.heights_m(*after);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] -= from[i];
    json["change_limit_m"] = difference_limit_m(change);
    const TerrainOutcome outcome = measure.outcome(before, *after);
    json["figures"] = before_and_after(outcome);
    json["change"] = change_figures(outcome.change);
  }
  return json;
}

}  // namespace screed
