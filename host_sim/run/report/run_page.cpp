// One pass through the frames, one through the terrain.
#include "host_sim/run/report/run_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/record.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/render/report/page_file.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/report/page_curves.h"
#include "host_sim/run/report/page_terrain.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/simulation/outcome.h"
#include "version.h"

namespace screed {
namespace {

constexpr std::uint64_t kReportedRows = 1024;
constexpr std::uint64_t kMaxStops = 900;

/// Rows at which the page can stop: evenly spaced, the first and the last among them.
std::vector<std::uint64_t> stops_of(std::uint64_t ticks) {
  const std::uint64_t every = std::max<std::uint64_t>(1, (ticks + kMaxStops - 2) / (kMaxStops - 1));
  std::vector<std::uint64_t> rows;
  for (std::uint64_t row = 0; row < ticks; row += every) rows.push_back(row);
  if (rows.back() != ticks - 1) rows.push_back(ticks - 1);
  return rows;
}

/// A column of frames.csv, or what is made of several, as a curve.
struct CurveInfo {
  const char* label;
  const char* column;  ///< of SCREED_FRAME_COLUMNS: without it there is no curve
  double factor;       ///< from the column's unit to that of the panel
  double (*value)(const SimFrame&);
  double jump =
      0.0;  ///< of an angle, by how much it may step from one tick to the next; 0: no angle
};

struct PanelInfo {
  const char* title;
  const char* unit;
  std::vector<CurveInfo> curves;
};

#define COLUMN(label, name, factor)                                                  \
  {                                                                                  \
    label, #name, factor, [](const SimFrame& frame) -> double { return frame.name; } \
  }

const std::vector<PanelInfo>& panels() {
  static const std::vector<PanelInfo> list = {
      {"Attitude",
       "deg",
       {COLUMN("pitch", pitch, kDegPerRad), COLUMN("roll", roll, kDegPerRad),
        COLUMN("pitch, estimated", est_pitch, kDegPerRad),
        COLUMN("roll, estimated", est_roll, kDegPerRad)}},
      {"Heading",
       "deg",
       {{"heading", "yaw", kDegPerRad, [](const SimFrame& frame) { return frame.yaw; }, 180.0},
        {"heading, estimated", "est_heading", kDegPerRad,
         [](const SimFrame& frame) { return frame.est_heading; }, 180.0}}},
      {"Speed",
       "m/s",
       {COLUMN("forward", velocity_x, 1.0), COLUMN("left track", track_left, 1.0),
        COLUMN("right track", track_right, 1.0)}},
      {"Slip", "1", {COLUMN("left", slip_left, 1.0), COLUMN("right", slip_right, 1.0)}},
      {"Sinkage",
       "mm",
       {COLUMN("left", sinkage_left, kMmPerM), COLUMN("right", sinkage_right, kMmPerM)}},
      {"Motor current",
       "A",
       {COLUMN("left", current_left, 1.0), COLUMN("right", current_right, 1.0)}},
      {"Battery", "V", {COLUMN("terminal voltage", battery, 1.0)}},
      {"Energy drawn", "J", {COLUMN("energy", energy, 1.0)}},
  };
  return list;
}

#undef COLUMN

/// The curves of one robot, on their way through the frames.
class Curves {
 public:
  explicit Curves(std::uint64_t ticks) : sampling_(ticks) {
    for (const PanelInfo& panel : panels()) {
      for (const CurveInfo& curve : panel.curves) {
        taken_.push_back({&panel, &curve, CurveSampler(sampling_)});
      }
    }
  }
  void add(const SimFrame& frame) {
    for (Taken& it : taken_) it.sampler.add(it.curve->factor * it.curve->value(frame));
  }
  Json finish(PageFile& page, const std::string& prefix, double tick_s) {
    std::vector<double> times_s;
    for (const std::uint64_t row : sampling_.rows()) {
      times_s.push_back(static_cast<double>(row + 1) * tick_s);
    }
    page.add_numbers(prefix + "times", std::span<const double>(times_s));
    Json list = Json::array();
    const PanelInfo* last = nullptr;
    for (Taken& it : taken_) {
      const std::vector<float> samples = it.sampler.samples();
      // Sessions of older programs and those of telemetry logs do not have all quantities.
      if (std::ranges::none_of(samples, [](float sample) { return std::isfinite(sample); }))
        continue;
      if (it.panel != last) {
        list.push_back({{"title", it.panel->title},
                        {"unit", it.panel->unit},
                        {"times", prefix + "times"},
                        {"series", Json::array()}});
      }
      last = it.panel;
      const std::string block = prefix + it.curve->column;
      page.add_numbers(block, std::span<const float>(samples));
      list.back()["series"].push_back({{"label", it.curve->label},
                                       {"column", it.curve->column},
                                       {"factor", it.curve->factor},
                                       {"jump", it.curve->jump},
                                       {"block", block}});
    }
    return list;
  }
  std::uint64_t bucket_ticks() const { return sampling_.bucket_ticks; }

 private:
  struct Taken {
    const PanelInfo* panel;
    const CurveInfo* curve;
    CurveSampler sampler;
  };
  CurveSampling sampling_;
  std::vector<Taken> taken_;
};

double number_in(const Column& column, const std::array<std::uint8_t, kFrameBytes>& row) {
  static_assert(std::all_of(kFrameColumns.begin(), kFrameColumns.end(),
                            [](const Column& it) {
                              return it.type == ColumnType::kDouble ||
                                     it.type == ColumnType::kInt32;
                            }),
                "no other type is read");
  // Rows are little endian, and so are our hosts.
  if (column.type == ColumnType::kDouble) {
    double value = 0.0;
    std::memcpy(&value, &row[column.offset], sizeof value);
    return value;
  }
  std::int32_t value = 0;
  std::memcpy(&value, &row[column.offset], sizeof value);
  return value;
}

/// Whole rows of frames.csv, column by column.
class StopRows {
 public:
  void add(const SimFrame& frame) {
    std::array<std::uint8_t, kFrameBytes> row{};
    pack(frame, row);
    for (std::size_t i = 0; i < kFrameColumns.size(); ++i) {
      columns_[i].push_back(number_in(kFrameColumns[i], row));
    }
  }
  Json finish(PageFile& page, const std::string& block) const {
    std::vector<double> all;
    Json list = Json::array();
    for (std::size_t i = 0; i < kFrameColumns.size(); ++i) {
      const Column& column = kFrameColumns[i];
      all.insert(all.end(), columns_[i].begin(), columns_[i].end());
      list.push_back({{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}});
    }
    page.add_numbers(block, std::span<const double>(all));
    return {{"block", block}, {"columns", list}};
  }

 private:
  std::array<std::vector<double>, kFrameColumns.size()> columns_;
};

Json json_of(const RobotBox& box) {
  return {{"back", box.plate.back}, {"front", box.plate.front}, {"right", box.plate.right},
          {"left", box.plate.left}, {"bottom", box.bottom},     {"top", box.top}};
}

/// Running gear and hull in the robot's frame.
Json json_of(const RobotBoxes& boxes) {
  Json json;
  json["gear"] = Json::array();
  for (const RobotBox& gear : boxes.running_gear) json["gear"].push_back(json_of(gear));
  json["hull"] = json_of(boxes.hull);
  return json;
}

/// What one robot did. Its blocks begin with `prefix`.
Json add_robot(PageFile& page, const SessionReader& session, std::span<const std::uint64_t> stops,
               const std::string& prefix, const TaskProgress& progress) {
  const double tick_s = 1.0 / session.info().tick_rate_hz;
  Curves curves(session.frames());
  StopRows rows;
  PageTrack track;
  PageEvents events;
  double distance_m = 0.0;
  std::size_t next_stop = 0;
  const auto add = [&](std::uint64_t row, const SimFrame& frame) {
    if (row % kReportedRows == 0) {
      report_progress(progress, "reading the run", row, session.frames());
    }
    curves.add(frame);
    track.add(row, frame);
    events.add(frame);
    if (std::isfinite(frame.delta_x) && std::isfinite(frame.delta_y)) {
      distance_m += portable::hypot(frame.delta_x, frame.delta_y);
    }
    if (next_stop < stops.size() && stops[next_stop] == row) {
      rows.add(frame);
      ++next_stop;
    }
  };
  const SimFrame last = for_each_frame(session, session.frames(), add);
  const auto figure = [](const char* name, const char* unit, double value) {
    return Json{{"name", name}, {"unit", unit}, {"value", value}};
  };
  Json json;
  json["name"] = "robot";
  json["figures"] = {figure("Simulated time", "s", static_cast<double>(session.frames()) * tick_s),
                     figure("Path on the ground", "m", distance_m),
                     figure("Energy drawn", "J", last.energy),
                     figure("Battery at the end", "V", last.battery)};
  json["state"] = state_name(static_cast<RobotState>(last.state));
  json["faults"] = fault_names(static_cast<std::uint16_t>(last.faults));
  json["bucket_ticks"] = curves.bucket_ticks();
  json["panels"] = curves.finish(page, prefix, tick_s);
  json["stops"] = rows.finish(page, prefix + "stops");
  json["track"] = track.finish(page, prefix + "track");
  events.finish(json);
  return json;
}

Json css_color(const Color& color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02lx%02lx%02lx", std::lround(255.0 * color.red),
                std::lround(255.0 * color.green), std::lround(255.0 * color.blue));
  return text;
}

Json leveling_states() {
  Json list = Json::array();
  const std::vector<std::string> names = leveling_state_names();
  for (std::size_t state = 0; state < names.size(); ++state) {
    list.push_back({{"name", names[state]}, {"color", css_color(state_color(state))}});
  }
  return list;
}

Json parameters_of(const SessionReader& session) {
  const std::vector<std::string>& missing = session.missing_parameters();
  Json list = Json::array();
  for (const ParameterInfo& it : kParameterTable) {
    const bool recorded = std::find(missing.begin(), missing.end(), it.name) == missing.end();
    list.push_back({{"name", it.name},
                    {"value", session.info().parameters.values[it.number]},
                    {"unit", it.unit},
                    {"default", it.default_value},
                    {"meaning", it.meaning},
                    {"recorded", recorded}});
  }
  return list;
}

Json configuration_of(const SessionReader& session) {
  Json list = Json::array();
  for (const IniEntry& it : read_ini_text(session.info().experiment_text, "the experiment")) {
    list.push_back({{"section", it.section},
                    {"key", it.key},
                    {"value", is_secret(it) ? kSecretText : it.value}});
  }
  return list;
}

Json identity_of(std::span<const SessionReader> sessions, const RunPageOptions& options) {
  const SessionReader& session = sessions.front();
  const SessionInfo& info = session.info();
  const RunSetup setup = setup_of(info, {});
  Json list = Json::array();
  const auto add = [&list](const char* name, Json value) {
    list.push_back({{"name", name}, {"value", std::move(value)}});
  };
  add("Run", options.name);
  add("Experiment", info.experiment_name);
  add("Algorithm", setup.experiment.experiment.algorithm);
  add("Terrain", setup.experiment.map.model);
  if (!setup.soil.empty()) add("Soil", setup.soil);
  add("Board", info.board_name);
  add("Seed of the world", std::to_string(info.seed));
  add("Seed of the drive", std::to_string(info.parameters.random_seed()));
  add("Ticks",
      std::to_string(session.frames()) + " at " + std::to_string(info.tick_rate_hz) + " Hz");
  add("Program of the run", info.program_version);
  add("Program of this page", SCREED_VERSION);
  add("Content hash", hash_of_run(sessions));
  return list;
}

}  // namespace

std::string run_page(std::span<const SessionReader> sessions, const RunPageOptions& options) {
  const SessionReader& session = sessions.front();
  if (session.frames() == 0) throw InputError("the session has no tick to report");
  const std::vector<std::uint64_t> stops = stops_of(session.frames());
  PageFile page;
  Json robots = Json::array();
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const std::string number = std::to_string(i);
    Json robot = add_robot(page, sessions[i], stops, "robot-" + number + "-", options.progress);
    if (sessions.size() > 1) robot["name"] = "robot " + number;
    if (options.robot) {
      const bool tracks = setup_of(session.info(), {}).experiment.vehicle.tracks;
      robot["boxes"] = json_of(boxes_of(*options.robot, tracks));
    }
    robots.push_back(std::move(robot));
  }
  Json facts;
  facts["kind"] = "run";
  facts["title"] = options.name;
  facts["complete"] = session.complete();
  facts["running"] = session.running();
  facts["tick_s"] = 1.0 / session.info().tick_rate_hz;
  facts["stops"] = stops;
  facts["identity"] = identity_of(sessions, options);
  facts["robots"] = std::move(robots);
  facts["leveling_states"] = leveling_states();
  facts["terrain"] = add_terrain(page, session, stops, options.progress);
  facts["parameters"] = parameters_of(session);
  facts["configuration"] = configuration_of(session);
  // A name of a folder need not be UTF-8; JSON must.
  return page.document(options.built_page, facts.dump(-1, Json::BadText::kReplace));
}

}  // namespace screed
