// The stage.
#include "tools/screed/viewer/viewer_display.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iostream>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/terrain_statistics.h"

namespace screed::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCaptureFramesPerSecond = 25.0;
constexpr double kZoomStep = 1.18;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

MapRectangle bed_of(const HeightField& field) {
  return {field.x_min(), field.x_max(), field.y_min(), field.y_max()};
}

bool inside(const PixelBox& box, Pixel at) {
  return at.x >= box.left && at.x < box.left + box.width && at.y >= box.top &&
         at.y < box.top + box.height;
}

std::string numbered(const char* before, uint64_t number) {
  char text[64];
  std::snprintf(text, sizeof text, "%s%06llu.png", before, static_cast<unsigned long long>(number));
  return text;
}

double finite(double value) {
  return std::isfinite(value) ? value : 0.0;
}

void move_to(RobotMarker& robot, const SimFrame& frame) {
  robot.x_m = finite(frame.x);
  robot.y_m = finite(frame.y);
  robot.heading_rad = finite(frame.yaw);
}

std::string frame_name(uint64_t frame) {
  return numbered("frame_", frame);
}

}  // namespace

void check_screenshot_time(const ViewerOptions& options, double duration_s,
                           const std::string& what) {
  constexpr double kRounding_s = 1e-6;
  if (!options.screenshot_at.has_value() || *options.screenshot_at <= duration_s + kRounding_s)
    return;
  char text[128];
  std::snprintf(text, sizeof text, "--at = %g is after the end: ", *options.screenshot_at);
  std::string message = text + what;
  std::snprintf(text, sizeof text, " lasts %.2f s; allowed: 0 to %.2f", duration_s, duration_s);
  throw InputError(message + text);
}

DisplaySetup display_setup(const Experiment& experiment, const std::string& soil,
                           const Assembly& robot) {
  DisplaySetup setup;
  setup.title = experiment.experiment.name;
  setup.terrain = terrain_name(experiment.map.model, soil);
  setup.seed = experiment.experiment.seed;
  setup.duration_s = experiment.experiment.duration_s;
  setup.loose = experiment.map.is_soil() || experiment.map.of_particles();
  setup.soft = experiment.map.is_soil();
  setup.measure = TerrainMeasure(experiment);
  setup.shape = shape_of(robot, experiment.vehicle.tracks);
  return setup;
}

TrailPoint trail_point(const SimFrame& frame) {
  return {static_cast<float>(frame.x), static_cast<float>(frame.y),
          static_cast<uint8_t>(std::clamp<int32_t>(frame.leveling_state, 0, 31))};
}

std::string FrameTimes::text() const {
  if (frames < 2 || total_s <= 0.0) return "no frames";
  const auto count = static_cast<double>(frames);
  char text[160];
  std::snprintf(text, sizeof text,
                "%llu frames, %.1f a second (drawing %.2f ms, showing %.2f ms, the rest %.2f ms)",
                static_cast<unsigned long long>(frames), (count - 1.0) / total_s,
                drawing_s / count * 1e3, showing_s / count * 1e3,
                (total_s / (count - 1.0) - (drawing_s + showing_s) / count) * 1e3);
  return text;
}

ViewerDisplay::ViewerDisplay(const ViewerOptions& options, DisplaySetup setup,
                             const HeightField& before, const HeightField& ground)
    : options_(options),
      setup_(std::move(setup)),
      ground_(ground),
      image_(ground_, before),
      before_(setup_.measure.surface(before)),
      slopes_(surface(), setup_.measure.flat_deg()),
      controls_(setup_.recorded, options.pace),
      drawing_(options.width_px, options.height_px) {
  if (options_.window) {
    window_.emplace("Screed: " + setup_.title, options_.width_px, options_.height_px);
  }
  controls_.shading = options_.shading;
  controls_.follow = options_.follow;
  controls_.recording = !options_.frames_dir.empty();
  camera_.set_box(drawing_.terrain_box());
  camera_.fit(bed_of(ground_));
  if (options_.span_m.has_value()) {
    camera_.zoom(camera_.box().width / *options_.span_m / camera_.scale(), camera_.middle());
  }
  status_.title = setup_.title;
  status_.keys = controls_.key_hint();
  status_.duration_s = setup_.duration_s;
  status_.terrain.before = SlopeStatistics(before_, setup_.measure.flat_deg()).figures();
  status_.terrain.now = slopes_.figures();
  status_.terrain.flat_limit_deg = setup_.measure.flat_deg();
  status_.terrain.loose = setup_.loose;
}

void ViewerDisplay::set_driver(const Driver& driver, std::string notice) {
  status_.subtitle = subtitle_of(driver, setup_.terrain, setup_.seed);
  status_.driver = std::move(notice);
}

void ViewerDisplay::change_terrain(std::span<const HeightChange> changes) {
  for (const HeightChange& change : changes) {
    const int ix = static_cast<int>(change.node % static_cast<uint32_t>(ground_.nx()));
    const int iy = static_cast<int>(change.node / static_cast<uint32_t>(ground_.nx()));
    ground_.set_node(ix, iy, ground_.node(ix, iy) + change.by);
  }
  image_.update(ground_, changes);
  if (!setup_.measure.is_filtered()) slopes_.update(ground_, changes);
  measured_ = measured_ && changes.empty();
}

HeightField ViewerDisplay::surface() const {
  return setup_.measure.surface(ground_);
}

void ViewerDisplay::measure_terrain(bool exact) {
  Status::Terrain& shown = status_.terrain;
  const bool volume = controls_.shading == Shading::kChange;
  if (!volume) shown.volume.reset();
  const bool overdue = volume && !shown.volume.has_value();
  if (!setup_.measure.is_filtered()) {
    shown.now = slopes_.figures();
    if (!overdue && !(volume && exact)) return;
  } else if (!overdue && (measured_ || !exact)) {
    return;
  }
  measured_ = true;
  const HeightField now = surface();
  if (setup_.measure.is_filtered())
    shown.now = SlopeStatistics(now, setup_.measure.flat_deg()).figures();
  if (!volume) return;
  const TerrainChange change = terrain_change(before_, now);
  shown.volume = {change.cut_m3, change.fill_m3, change.moved_m3(), change.deepest_cut_m,
                  change.deepest_fill_m};
}

void ViewerDisplay::add_leveling(const LevelingPoint& point) {
  leveling_.push_back(point);
  show_leveling();
}

void ViewerDisplay::show_leveling() {
  status_.leveling_before.reset();
  status_.leveling_now.reset();
  std::optional<double> progress;
  for (const LevelingPoint& point : leveling_) {
    if (point.time > status_.time_s) break;
    if (std::isfinite(point.progress)) progress = point.progress;
    status_.leveling_now = {point.level_deviation, point.roughness, point.robot_scale_flatness,
                            progress};
    if (!status_.leveling_before.has_value()) status_.leveling_before = status_.leveling_now;
  }
}

void ViewerDisplay::set_frames(std::span<const SimFrame> frames) {
  robots_.resize(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) {
    move_to(robots_[i].robot, frames[i]);
    robots_[i].state = trail_point(frames[i]).state;
  }
  const SimFrame& frame = frames.front();
  status_.time_s = frame.time;
  show_leveling();
  // A training drive lasts for its frames, and some seconds before them.
  status_.duration_s = std::max(setup_.duration_s, frame.time);
  status_.state = frame.state;
  status_.leveling_state = frame.leveling_state;
  status_.faults = frame.faults;
  motion_.speed_m_per_s = finite(frame.velocity_x);
  motion_.turn_rad_per_s = finite(frame.rate_z);
  motion_.wanted_m_per_s = finite(frame.linear);
  motion_.wanted_rad_per_s = finite(frame.angular);
  motion_.pitch_rad = finite(frame.pitch);
  motion_.roll_rad = finite(frame.roll);
  motion_.heading_rad = finite(frame.yaw);
  motion_.slip_left = finite(frame.slip_left);
  motion_.slip_right = finite(frame.slip_right);
  if (setup_.soft) {
    motion_.sinkage_m = std::max(finite(frame.sinkage_left), finite(frame.sinkage_right));
  }
  motion_.battery_v = finite(frame.battery);
}

void ViewerDisplay::handle_input(double time_s, int wait_ms) {
  for (const InputEvent& event : scripted_events(options_.script, scripted_until_s_, time_s)) {
    handle_event(event);
  }
  scripted_until_s_ = std::max(scripted_until_s_, time_s);
  if (!window_.has_value()) return;
  for (const InputEvent& event : window_->events(wait_ms)) handle_event(event);
}

void ViewerDisplay::handle_event(const InputEvent& event) {
  using Kind = InputEvent::Kind;
  switch (event.kind) {
    case Kind::kClose:
      controls_.closed = true;
      break;
    case Kind::kKeyPressed:
      controls_.key_down(event.key, event.shift);
      break;
    case Kind::kKeyReleased:
      controls_.key_up(event.key);
      break;
    case Kind::kGamepadAdded:
    case Kind::kGamepadRemoved:
    case Kind::kGamepadAxis:
      controls_.gamepad_event(event);
      break;
    case Kind::kSize:
      drawing_.resize(event.width, event.height);
      camera_.set_box(drawing_.terrain_box());
      break;
    default:
      handle_mouse(event);
      break;
  }
}

void ViewerDisplay::handle_mouse(const InputEvent& event) {
  using Kind = InputEvent::Kind;
  const bool on_timeline = controls_.recorded() && inside(drawing_.timeline_box(), event.at);
  switch (event.kind) {
    case Kind::kWheel:
      camera_.zoom(std::pow(kZoomStep, event.amount),
                   controls_.follow ? camera_.middle() : event.at);
      break;
    case Kind::kPress:
      scrubbing_ = on_timeline;
      if (scrubbing_) controls_.to_share = drawing_.share_at(event.at.x);
      if (inside(drawing_.terrain_box(), event.at)) drag_ = event.at;
      break;
    case Kind::kMove:
      if (scrubbing_) controls_.to_share = drawing_.share_at(event.at.x);
      if (drag_.has_value()) {
        camera_.drag(event.at.x - drag_->x, event.at.y - drag_->y);
        controls_.follow = false;
        drag_ = event.at;
      }
      break;
    default:
      drag_.reset();
      scrubbing_ = false;
      break;
  }
}

Scene ViewerDisplay::scene() {
  if (controls_.fit) camera_.fit(bed_of(ground_));
  controls_.fit = false;
  if (controls_.follow) camera_.look_at(robots_[0].robot.x_m, robots_[0].robot.y_m);
  status_.pace = controls_.paused ? "paused" : controls_.pace_text();
  const size_t points = trail_points_.value_or(SIZE_MAX);
  status_.states_seen = 0;
  for (const ShownRobot& robot : robots_) {
    status_.states_seen |= 1U << robot.state;
    for (size_t i = 0; i < std::min(points, robot.trail.size()); ++i)
      status_.states_seen |= 1U << robot.trail[i].state;
  }

  Scene scene;
  scene.ground = &image_;
  scene.place = {ground_.x_min(), ground_.y_min(), ground_.spacing_m(), ground_.wrap(),
                 ground_.edge() == BedEdge::kWalled};
  scene.bed = bed_of(ground_);
  scene.shading = controls_.shading;
  scene.camera = camera_;
  scene.shape = &setup_.shape;
  scene.robots = robots_;
  scene.trail_points = points;
  scene.show_trail = controls_.trail;
  scene.status = status_;
  if (controls_.paused) scene.badges.emplace_back("paused");
  if (controls_.follow) scene.badges.emplace_back("follow");
  if (controls_.recording) scene.badges.emplace_back("\u25cf recording");
  if (!controls_.gamepad().empty()) scene.badges.emplace_back("gamepad");
  scene.show_timeline = controls_.recorded();
  if (controls_.help) {
    help_ = controls_.help_lines();
    scene.help = &help_;
  }
  return scene;
}

void ViewerDisplay::draw(bool exact) {
  if (exact) status_.motion = motion_;
  measure_terrain(exact);
  image_.paint(ground_, controls_.shading);
  drawing_.draw(scene());
}

void ViewerDisplay::show() {
  const Clock::time_point begin = Clock::now();
  if (times_.frames == 0) first_shown_ = begin;
  // Figures that change sixty times a second cannot be read.
  constexpr uint64_t kFramesPerReading = 6;
  draw(times_.frames % kFramesPerReading == 0 || controls_.paused);
  const double drawn_s = seconds_since(begin);
  if (window_.has_value()) window_->show(drawing_.canvas());
  ++times_.frames;
  times_.drawing_s += drawn_s;
  times_.showing_s += seconds_since(begin) - drawn_s;
  times_.total_s = std::chrono::duration<double>(begin - first_shown_).count();
  save_on_demand();
}

bool ViewerDisplay::capture_is_due() const {
  if (!controls_.recording) return false;
  if (!captured_until_s_.has_value() || status_.time_s < *captured_until_s_) return true;
  constexpr double kRounding_s = 1e-9;
  const double pace = controls_.pace > 0.0 ? controls_.pace : 1.0;
  return status_.time_s >= *captured_until_s_ + pace / kCaptureFramesPerSecond - kRounding_s;
}

bool ViewerDisplay::attempt(const std::function<void()>& write) {
  try {
    write();
    return true;
  } catch (const RunError& error) {
    if (failure_.empty()) failure_ = error.what();
    status_.notice = error.what();
    return false;
  }
}

void ViewerDisplay::save_on_demand() {
  if (controls_.screenshot) {
    controls_.screenshot = false;
    std::string name;
    std::error_code ignored;
    do {
      name = numbered("screed-", ++pictures_);
    } while (std::filesystem::exists(name, ignored));
    attempt([&] {
      drawing_.canvas().write_png(name);
      std::cerr << "picture " << name << "\n";
    });
  }
  if (!controls_.recording) captured_until_s_.reset();
  if (!capture_is_due()) return;
  if (attempt([this] { write_frame(); })) return;
  controls_.recording = false;
  discard_film();
}

void ViewerDisplay::write_frame() {
  if (captured_frames_ == 0) begin_frames();
  drawing_.canvas().write_png(frames_folder_ / frame_name(captured_frames_ + 1));
  ++captured_frames_;
  captured_until_s_ = status_.time_s;
}

void ViewerDisplay::begin_frames() {
  frames_folder_ = options_.frames_dir;
  // The R key names no folder: a new one, since frames of two films must not mix.
  if (frames_folder_.empty()) {
    frames_folder_ = "frames";
    std::error_code ignored;
    for (int next = 2; std::filesystem::exists(frames_folder_, ignored); ++next)
      frames_folder_ = "frames-" + std::to_string(next);
  }
  folders_.make(frames_folder_);
  std::cerr << "frames " << (frames_folder_ / frame_name(1)).string() << " ...\n";
}

void ViewerDisplay::discard_film() {
  if (options_.frames_dir.empty()) return;
  std::error_code ignored;
  for (; captured_frames_ > 0; --captured_frames_)
    std::filesystem::remove(frames_folder_ / frame_name(captured_frames_), ignored);
}

void ViewerDisplay::save_when_due(double time_s, bool end) {
  if (options_.screenshot.empty() || screenshot_saved_) return;
  constexpr double kRounding_s = 1e-6;
  if (!end &&
      !(options_.screenshot_at.has_value() && time_s >= *options_.screenshot_at - kRounding_s)) {
    return;
  }
  screenshot_saved_ = true;
  if (options_.screenshot_at.has_value() && time_s < *options_.screenshot_at - kRounding_s) {
    std::cerr << "note: " << options_.screenshot << " shows the end, at " << number_text(time_s, 2)
              << " s: it came before --at\n";
  }
  draw(true);
  attempt([this] { drawing_.canvas().write_png(options_.screenshot); });
}

}  // namespace screed::viewer
