// Rows of a session are messages of ROS 1 as they are: little endian, field by field, no padding
// (wiki.ros.org/msg). What viewers draw is in Foxglove's schemas, as JSON.
#include "host_sim/run/report/run_mcap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/base64.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/json.h"
#include "host_sim/core/mcap_file.h"
#include "host_sim/core/record.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/report/foxglove.h"
#include "host_sim/run/report/page_curves.h"
#include "host_sim/run/report/page_terrain.h"
#include "host_sim/run/session/run_folder.h"

namespace screed {
namespace {

using foxglove::color_of;
using foxglove::entity;
using foxglove::pose_at;
using foxglove::quaternion_of;
using foxglove::scene_of;
using foxglove::timestamp;
using foxglove::vector_of;

constexpr std::uint64_t kBlockRows = 256;
constexpr std::uint64_t kTicksOfPose = 5;
/// Nodes of the drawn terrain along its longer side. Its heights are in full beside it.
constexpr int kDrawnSide = 100;
constexpr char kWorldFrame[] = "world";

// ---- tables ----

const char* ros_type(ColumnType type) {
  switch (type) {
    case ColumnType::kUint8:
      return "uint8";
    case ColumnType::kInt16:
      return "int16";
    case ColumnType::kUint16:
      return "uint16";
    case ColumnType::kInt32:
      return "int32";
    case ColumnType::kUint32:
      return "uint32";
    case ColumnType::kDouble:
      return "float64";
  }
  return "";
}

std::string ros_definition(std::span<const Column> columns) {
  std::string text;
  for (const Column& column : columns) {
    text += ros_type(column.type);
    if (column.array) text += "[" + std::to_string(column.count) + "]";
    text += std::string(" ") + column.name + "  #";
    if (column.unit[0] != '\0') text += std::string(" ") + column.unit + ";";
    text += std::string(" ") + column.meaning + "\n";
  }
  return text;
}

/// Schemas of the tables, each in the file once, whatever robots there are.
class TableSchemas {
 public:
  explicit TableSchemas(McapFile& file)
      : frame(add(file, "Frame", kFrameColumns)),
        sample(add(file, "Sample", kSampleColumns)),
        output(add(file, "Output", kOutputColumns)),
        leveling(add(file, "Leveling", kLevelingColumns)) {}

  McapFile::Id frame;
  McapFile::Id sample;
  McapFile::Id output;
  McapFile::Id leveling;

 private:
  static McapFile::Id add(McapFile& file, const char* name, std::span<const Column> columns) {
    return file.add_schema(std::string("screed/") + name, "ros1msg", ros_definition(columns));
  }
};

McapFile::Id add_json_channel(McapFile& file, const char* topic, const char* schema,
                              const Json& definition) {
  return file.add_channel(topic, "json", file.add_schema(schema, "jsonschema", definition.dump()));
}

// ---- robots ----

Json cube_of(const RobotBox& box, const Color& color) {
  const RobotPlate& plate = box.plate;
  return {{"pose", pose_at({0.5 * (plate.back + plate.front), 0.5 * (plate.left + plate.right),
                            0.5 * (box.bottom + box.top)})},
          {"size",
           vector_of({plate.front - plate.back, plate.left - plate.right, box.top - box.bottom})},
          {"color", color_of(color)}};
}

Json body_of(const RobotBoxes& boxes, std::size_t number, const std::string& frame) {
  constexpr Color kGear{0.2, 0.2, 0.2};
  Json body = entity(0, frame, frame);
  for (const RobotBox& gear : boxes.running_gear) body["cubes"].push_back(cube_of(gear, kGear));
  body["cubes"].push_back(cube_of(boxes.hull, category_color(number)));
  return body;
}

/// What one robot recorded, row by row.
class RobotTopics {
 public:
  RobotTopics(McapFile& file, const TableSchemas& schemas, const SessionReader& session,
              std::size_t number)
      : file_(file), session_(session), name_("robot_" + std::to_string(number)) {
    frames_ = file.add_channel("/" + name_ + "/frames", "ros1", schemas.frame);
    samples_ = file.add_channel("/" + name_ + "/samples", "ros1", schemas.sample);
    outputs_ = file.add_channel("/" + name_ + "/outputs", "ros1", schemas.output);
  }

  const std::string& name() const { return name_; }

  /// Reads rows [first, first + count), less at the end of the session.
  void read(std::uint64_t first, std::uint64_t count) {
    const std::uint64_t end = std::min(first + count, session_.frames());
    const std::size_t rows = first < end ? end - first : 0;
    frame_rows_.resize(rows);
    sample_rows_.resize(rows);
    output_rows_.resize(rows);
    if (rows == 0) return;
    session_.read(first, std::span(frame_rows_));
    session_.read(first, std::span(sample_rows_));
    session_.read(first, std::span(output_rows_));
  }

  /// Row i of those that were read; null behind the end of the session.
  const SimFrame* frame(std::size_t i) const {
    return i < frame_rows_.size() ? &frame_rows_[i] : nullptr;
  }

  void write(std::size_t i, std::uint64_t time_ns) {
    write_row<kFrameBytes>(frames_, time_ns, frame_rows_[i]);
    write_row<kSampleBytes>(samples_, time_ns, sample_rows_[i]);
    write_row<kOutputBytes>(outputs_, time_ns, output_rows_[i]);
    events_.add(frame_rows_[i]);
  }

  /// Takes up the events where the row before this one left them.
  void begin_events_at(std::uint64_t first) {
    if (first == 0 || first > session_.frames()) return;
    std::array<SimFrame, 1> before{};
    session_.read(first - 1, std::span(before));
    events_.add(before[0]);
    told_ = events_.events().size();
  }

  /// The events that have come since the last call.
  template <class Use>
  void for_each_new_event(Use use) {
    for (; told_ < events_.events().size(); ++told_) use(events_.events()[told_]);
  }

 private:
  template <std::size_t kBytes, class Row>
  void write_row(McapFile::Id channel, std::uint64_t time_ns, const Row& row) {
    std::array<std::uint8_t, kBytes> bytes{};
    pack(row, bytes);
    file_.add_message(channel, time_ns, bytes);
  }

  McapFile& file_;
  const SessionReader& session_;
  std::string name_;
  McapFile::Id frames_ = 0;
  McapFile::Id samples_ = 0;
  McapFile::Id outputs_ = 0;
  std::vector<SimFrame> frame_rows_;
  std::vector<SensorSample> sample_rows_;
  std::vector<RobotOutput> output_rows_;
  PageEvents events_;
  std::size_t told_ = 0;
};

Json transform_of(const RobotTopics& robot, const SimFrame& frame, std::uint64_t time_ns) {
  const Eigen::Quaterniond rotation(rotation_from({frame.roll, frame.pitch, frame.yaw}));
  return {{"timestamp", timestamp(time_ns)},
          {"parent_frame_id", kWorldFrame},
          {"child_frame_id", robot.name()},
          {"translation", vector_of({frame.x, frame.y, frame.z})},
          {"rotation", quaternion_of(rotation)}};
}

bool has_pose(const SimFrame& frame) {
  return std::isfinite(frame.x + frame.y + frame.z + frame.roll + frame.pitch + frame.yaw);
}

// ---- terrain ----

class TerrainTopics {
 public:
  TerrainTopics(McapFile& file, McapFile::Id scene, const SessionReader& session)
      : file_(file),
        session_(session),
        before_(session.terrain_before()),
        after_(session.terrain_after()) {
    if (session.has_heights()) {
      extremes_ = session.height_extremes();
    } else if (before_.has_value()) {
      std::vector<std::int32_t> heights = before_->heights;
      if (after_.has_value()) {
        heights.insert(heights.end(), after_->heights.begin(), after_->heights.end());
      }
      const auto [low, high] = std::ranges::minmax(heights);
      extremes_ = {low, high};
    }
    scene_ = file.add_channel("/terrain", "json", scene);
    grid_ = add_json_channel(file, "/heights", "foxglove.Grid", foxglove::grid_schema());
  }

  /// The ground after so many ticks, as far as the session knows: without recorded heights it is
  /// that before the run up to the last tick.
  void write(std::uint64_t tick, std::uint64_t time_ns) {
    if (session_.has_heights()) {
      write(session_.heights_after(tick), time_ns);
    } else if (const auto& known = tick == session_.frames() ? after_ : before_;
               known.has_value()) {
      write(*known, time_ns);
    }
  }

 private:
  void write(const HeightMap& map, std::uint64_t time_ns) {
    file_.add_message(grid_, time_ns, grid_of(map.geometry, map.heights, time_ns).dump());
    file_.add_message(scene_, time_ns, drawn(map, time_ns).dump());
  }

  static Json grid_of(const HeightMapGeometry& g, std::span<const std::int32_t> units,
                      std::uint64_t time_ns) {
    constexpr int kFloat32 = 7;
    std::vector<float> heights_m;
    heights_m.reserve(units.size());
    for (const std::int32_t unit : units) {
      heights_m.push_back(static_cast<float>(unit * g.unit_m));
    }
    const std::span<const std::uint8_t> data(
        reinterpret_cast<const std::uint8_t*>(heights_m.data()), sizeof(float) * heights_m.size());
    // A cell of the grid lies about its node.
    const double half_m = 0.5 * g.spacing_m;
    return {{"timestamp", timestamp(time_ns)},
            {"frame_id", kWorldFrame},
            {"pose", pose_at({g.origin_x_m - half_m, g.origin_y_m - half_m, 0.0})},
            {"column_count", g.nx},
            {"cell_size", {{"x", g.spacing_m}, {"y", g.spacing_m}}},
            {"row_stride", sizeof(float) * g.nx},
            {"cell_stride", sizeof(float)},
            {"fields", Json::array({{{"name", "height"}, {"offset", 0}, {"type", kFloat32}}})},
            {"data", base64(data)}};
  }

  Json drawn(const HeightMap& map, std::uint64_t time_ns) const {
    const CoarseGrid grid(map.geometry, kDrawnSide);
    const std::vector<double> heights_m = grid.heights_m(field_of(map));
    const double low_m = extremes_.lowest * map.geometry.unit_m;
    const double span_m = std::max(1e-9, extremes_.highest * map.geometry.unit_m - low_m);
    Json points = Json::array();
    Json colors = Json::array();
    Json corners = Json::array();
    const std::size_t nx = grid.x_m.size();
    for (std::size_t i = 0; i < heights_m.size(); ++i) {
      points.push_back({{"x", rounded(grid.x_m[i % nx])},
                        {"y", rounded(grid.y_m[i / nx])},
                        {"z", rounded(heights_m[i])}});
      const Color shade = height_color((heights_m[i] - low_m) / span_m);
      colors.push_back({{"r", percent(shade.red)},
                        {"g", percent(shade.green)},
                        {"b", percent(shade.blue)},
                        {"a", 1}});
      if (i % nx + 1 == nx || i / nx + 1 == grid.y_m.size()) continue;
      for (const std::size_t corner : {i, i + 1, i + nx, i + nx, i + 1, i + nx + 1}) {
        corners.push_back(corner);
      }
    }
    Json terrain = entity(time_ns, kWorldFrame, "terrain");
    terrain["triangles"].push_back({{"pose", pose_at(Eigen::Vector3d::Zero())},
                                    {"points", std::move(points)},
                                    {"color", color_of({})},
                                    {"colors", std::move(colors)},
                                    {"indices", std::move(corners)}});
    return scene_of(Json::array({std::move(terrain)}));
  }

  /// A picture needs no more than a hundredth of a millimetre, and the file less room.
  static double rounded(double length_m) { return std::round(length_m * 1e5) / 1e5; }
  static double percent(double share) { return std::round(share * 100.0) / 100.0; }

  McapFile& file_;
  const SessionReader& session_;
  std::optional<HeightMap> before_;
  std::optional<HeightMap> after_;
  HeightExtremes extremes_{};
  McapFile::Id scene_ = 0;
  McapFile::Id grid_ = 0;
};

// ---- what the run was made of ----

std::string experiment_without_key(const SessionInfo& info) {
  std::string text;
  std::string section;
  for (const IniEntry& it : read_ini_text(info.experiment_text, "the experiment")) {
    if (it.section != section) text += "[" + it.section + "]\n";
    section = it.section;
    text += it.key + " = " + (is_secret(it) ? kSecretText : it.value) + "\n";
  }
  return text;
}

void add_identity(McapFile& file, std::span<const SessionReader> sessions,
                  const std::string& summary) {
  const SessionInfo& info = sessions.front().info();
  const std::vector<std::string>& missing = sessions.front().missing_parameters();
  std::map<std::string, std::string> parameters;
  for (const ParameterInfo& it : kParameterTable) {
    if (std::ranges::find(missing, it.name) != missing.end()) continue;
    parameters[it.name] = std::to_string(info.parameters.values[it.number]);
  }
  file.add_metadata("run", {{"experiment", info.experiment_name},
                            {"seed", std::to_string(info.seed)},
                            {"board", info.board_name},
                            {"program", info.program_version},
                            {"arithmetic", info.arithmetic},
                            {"content_hash", hash_of_run(sessions)}});
  file.add_metadata("parameters", parameters);
  file.add_attachment("experiment.ini", "text/plain", experiment_without_key(info));
  if (!summary.empty()) file.add_attachment("summary.json", "application/json", summary);
}

}  // namespace

void export_mcap(std::span<const SessionReader> sessions, const std::filesystem::path& mcap,
                 const RunMcapOptions& options) {
  const SessionReader& first = sessions.front();
  const FrameRange range = options.range.value_or(FrameRange{0, first.frames()});
  const std::uint64_t end = range.first + range.count;
  const std::uint64_t tick_ns = 1000000000U / first.info().tick_rate_hz;
  McapFile file(mcap);
  add_identity(file, sessions, options.summary);
  const TableSchemas schemas(file);
  std::vector<RobotTopics> robots;
  for (const SessionReader& session : sessions) {
    robots.emplace_back(file, schemas, session, robots.size());
  }
  const auto poses =
      add_json_channel(file, "/tf", "foxglove.FrameTransforms", foxglove::transforms_schema());
  const auto events = add_json_channel(file, "/events", "foxglove.Log", foxglove::log_schema());
  const auto curve = file.add_channel("/leveling", "ros1", schemas.leveling);
  const auto scene =
      file.add_schema("foxglove.SceneUpdate", "jsonschema", foxglove::scene_schema().dump());
  TerrainTopics terrain(file, scene, first);

  if (options.robot.has_value()) {
    const bool tracks = setup_of(first.info(), {}).experiment.vehicle.tracks;
    const RobotBoxes boxes = boxes_of(*options.robot, tracks);
    Json bodies = Json::array();
    for (std::size_t i = 0; i < robots.size(); ++i) {
      bodies.push_back(body_of(boxes, i, robots[i].name()));
    }
    const auto channel = file.add_channel("/robots", "json", scene);
    file.add_message(channel, range.first * tick_ns, scene_of(std::move(bodies)).dump());
  }
  terrain.write(range.first, range.first * tick_ns);
  for (RobotTopics& robot : robots) robot.begin_events_at(range.first);

  const std::vector<LevelingPoint> points = first.leveling();
  auto point = points.begin();
  const auto write_curve = [&](std::uint64_t from_ns, std::uint64_t to_ns) {
    for (; point != points.end(); ++point) {
      const auto time_ns = static_cast<std::uint64_t>(std::llround(point->time * 1e9));
      if (time_ns > to_ns) break;
      if (time_ns < from_ns) continue;
      file.add_message(curve, time_ns,
                       std::span(reinterpret_cast<const std::uint8_t*>(&*point), kLevelingBytes));
    }
  };

  for (std::uint64_t block = range.first; block < end; block += kBlockRows) {
    report_progress(options.progress, "exporting the run", block - range.first, range.count);
    const std::uint64_t rows = std::min(kBlockRows, end - block);
    for (RobotTopics& robot : robots) robot.read(block, rows);
    for (std::uint64_t i = 0; i < rows; ++i) {
      const std::uint64_t tick = block + i + 1;
      const std::uint64_t time_ns = tick * tick_ns;
      Json transforms = Json::array();
      for (RobotTopics& robot : robots) {
        const SimFrame* const frame = robot.frame(i);
        if (frame == nullptr) continue;
        robot.write(i, time_ns);
        if (has_pose(*frame)) transforms.push_back(transform_of(robot, *frame, time_ns));
        robot.for_each_new_event([&](const PageEvents::Event& event) {
          constexpr int kInfo = 2;
          constexpr int kWarning = 3;
          file.add_message(events, time_ns,
                           Json{{"timestamp", timestamp(time_ns)},
                                {"level", event.fault ? kWarning : kInfo},
                                {"message", event.text},
                                {"name", robot.name()},
                                {"file", ""},
                                {"line", 0}}
                               .dump());
        });
      }
      if ((tick - 1) % kTicksOfPose == 0 || tick == end) {
        file.add_message(poses, time_ns, Json{{"transforms", std::move(transforms)}}.dump());
      }
      write_curve(range.first * tick_ns, time_ns);
      if (tick == end || (first.has_heights() && tick % options.terrain_every == 0)) {
        terrain.write(tick, time_ns);
      }
    }
  }
  file.finish();
}

}  // namespace screed
