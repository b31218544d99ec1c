// Where a robot is, seen by a camera above its bed: an example of a source of position fixes.
//
//   site_camera markers markers.png                                  five markers to print
//   site_camera calibrate chessboard.mp4 --out camera.yml            once for a camera
//   site_camera track 0 --camera camera.yml --site 2.4x1.8 | screed fix --port /dev/ttyUSB0
//
// Markers are OpenCV's ArUco, 4x4: number 0 on the robot, its upper edge to the front; 1 to 4 at
// the corners of the site, south-west, south-east, north-east, north-west. Their four centres tell
// where the camera is, the robot's own four corners where its marker is in front of it, at any
// height of the ground.
//
// Exit codes: 0 the source has ended, 1 it or a marker fails, 2 wrong input.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/command_line/program.h"

namespace {

constexpr int kRobot = 0;
constexpr int kCorners = 4;

using screed::InputError;
using screed::RunError;

/// Of a marker in a picture: clockwise from the upper left corner as it was printed.
using Quad = std::vector<cv::Point2f>;

cv::Ptr<cv::aruco::Dictionary> dictionary() {
  return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
}

/// A camera by its number, a film, or pictures by a pattern such as frame_%03d.png.
cv::VideoCapture open_source(const std::string& source) {
  const bool is_number = source.find_first_not_of("0123456789") == std::string::npos;
  cv::VideoCapture capture;
  if (is_number) {
    capture.open(std::stoi(source));
  } else {
    capture.open(source);
  }
  if (!capture.isOpened())
    throw InputError(source + ": is no camera, film or series of pictures that can be read");
  return capture;
}

/// Tiles side by side. The white round a marker is part of it: what refines the corners to parts of
/// a pixel must not meet another edge.
int write_markers(const std::string& out) {
  constexpr int kBlack_px = 600;
  constexpr int kWhite_px = 150;
  constexpr int kTile_px = kBlack_px + 2 * kWhite_px;
  cv::Mat sheet(kTile_px, (kCorners + 1) * kTile_px, CV_8U, cv::Scalar(255));
  for (int id = 0; id <= kCorners; ++id) {
    cv::Mat marker;
    cv::aruco::drawMarker(dictionary(), id, kBlack_px, marker);
    marker.copyTo(sheet(cv::Rect(id * kTile_px + kWhite_px, kWhite_px, kBlack_px, kBlack_px)));
  }
  if (!cv::imwrite(out, sheet)) throw InputError(out + ": cannot be written");
  return 0;
}

// --- the camera itself ---

struct Lens {
  cv::Mat matrix;
  cv::Mat distortion;
  cv::Size size_px;
};

struct CalibrateArguments {
  std::string source;
  std::string out = "camera.yml";
  int columns = 9;
  int rows = 6;
  double square_m = 0.025;
};

int calibrate(const CalibrateArguments& arguments) {
  constexpr size_t kMaxViews = 30;
  constexpr size_t kMinViews = 8;
  const cv::Size inner(arguments.columns, arguments.rows);
  std::vector<cv::Point3f> board;
  for (int row = 0; row < inner.height; ++row) {
    for (int column = 0; column < inner.width; ++column)
      board.emplace_back(column * arguments.square_m, row * arguments.square_m, 0.0F);
  }
  cv::VideoCapture capture = open_source(arguments.source);
  std::vector<Quad> seen;
  cv::Mat picture;
  cv::Mat grey;
  cv::Size size_px;
  while (seen.size() < kMaxViews && capture.read(picture)) {
    cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    size_px = grey.size();
    Quad corners;
    if (!cv::findChessboardCorners(grey, inner, corners)) continue;
    // A board that has hardly moved tells nothing new.
    const bool is_new = std::none_of(seen.begin(), seen.end(), [&](const Quad& before) {
      return cv::norm(corners.front() - before.front()) + cv::norm(corners.back() - before.back()) <
             0.05 * size_px.width;
    });
    if (!is_new) continue;
    cv::cornerSubPix(grey, corners, {5, 5}, {-1, -1},
                     {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 30, 0.01});
    seen.push_back(corners);
    std::cerr << "\r" << seen.size() << " of " << kMaxViews << " views of the chessboard"
              << std::flush;
  }
  if (!seen.empty()) std::cerr << "\n";
  if (seen.size() < kMinViews) {
    throw InputError(arguments.source + ": " + std::to_string(seen.size()) +
                     " different views of a chessboard of " + std::to_string(inner.width) + " x " +
                     std::to_string(inner.height) + " inner corners; needed are " +
                     std::to_string(kMinViews));
  }
  Lens lens;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  const double error_px =
      cv::calibrateCamera(std::vector<std::vector<cv::Point3f>>(seen.size(), board), seen, size_px,
                          lens.matrix, lens.distortion, turns, shifts);
  cv::FileStorage file(arguments.out, cv::FileStorage::WRITE);
  if (!file.isOpened()) throw InputError(arguments.out + ": cannot be written");
  file << "size_px" << size_px << "camera_matrix" << lens.matrix << "distortion_coefficients"
       << lens.distortion << "reprojection_error_px" << error_px;
  std::printf("%s: focal length %.1f px, error %.2f px over %zu views\n", arguments.out.c_str(),
              lens.matrix.at<double>(0, 0), error_px, seen.size());
  return 0;
}

Lens read_lens(const std::string& path) {
  Lens lens;
  cv::FileStorage file;
  try {
    file.open(path, cv::FileStorage::READ);
  } catch (const cv::Exception&) {
  }
  if (!file.isOpened()) throw InputError(path + ": cannot be read; site_camera calibrate makes it");
  file["size_px"] >> lens.size_px;
  file["camera_matrix"] >> lens.matrix;
  file["distortion_coefficients"] >> lens.distortion;
  if (lens.matrix.size() != cv::Size(3, 3) || lens.distortion.empty() || lens.size_px.empty())
    throw InputError(path + ": is no calibration; site_camera calibrate makes one");
  return lens;
}

// --- the robot ---

struct TrackArguments {
  std::string source;
  std::string camera = "camera.yml";
  std::string site;
  double side_m = 0.12;
  double height_m = 0.1;
  double ahead_m = 0.0;
};

struct Fix {
  double x_m;
  double y_m;
  double sigma_m;
};

cv::Point2f centre_of(const Quad& quad) {
  // Of a square in perspective it is where the diagonals meet.
  const cv::Point2f a = quad[2] - quad[0];
  const cv::Point2f b = quad[3] - quad[1];
  const cv::Point2f between = quad[1] - quad[0];
  const float share = (between.x * b.y - between.y * b.x) / (a.x * b.y - a.y * b.x);
  return quad[0] + share * a;
}

class Tracker {
 public:
  Tracker(const TrackArguments& arguments, Lens lens)
      : arguments_(arguments), lens_(std::move(lens)) {
    double width_m = 0.0;
    double depth_m = 0.0;
    char rest = 0;
    if (std::sscanf(arguments.site.c_str(), "%lfx%lf%c", &width_m, &depth_m, &rest) != 2 ||
        !(width_m > 0.0) || !(depth_m > 0.0))
      throw InputError("--site " + arguments.site +
                       ": from marker centre to marker centre, east and north, e.g. 2.4x1.8 [m]");
    const auto x = static_cast<float>(0.5 * width_m);
    const auto y = static_cast<float>(0.5 * depth_m);
    corners_ = {{-x, -y, 0.0F}, {x, -y, 0.0F}, {x, y, 0.0F}, {-x, y, 0.0F}};
  }

  /// Nothing where the robot's marker is not seen, or the corners never were.
  std::optional<Fix> look(const cv::Mat& picture) {
    if (picture.size() != lens_.size_px)
      throw InputError("the source has pictures of another size than the calibration");
    const std::map<int, Quad> markers = find(picture);
    place_camera(markers);
    const auto robot = markers.find(kRobot);
    missing_ = robot == markers.end() ? "the robot's marker, number 0" : "";
    if (!placed_) missing_ = "all four corner markers at a time, numbers 1 to 4";
    if (!missing_.empty()) return std::nullopt;
    return fix_of(robot->second);
  }
  const std::string& missing() const { return missing_; }

 private:
  std::map<int, Quad> find(const cv::Mat& picture) const {
    auto parameters = cv::aruco::DetectorParameters::create();
    parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
    std::vector<Quad> quads;
    std::vector<int> ids;
    cv::aruco::detectMarkers(picture, dictionary(), quads, ids, parameters);
    std::map<int, Quad> markers;
    for (size_t i = 0; i < ids.size(); ++i) markers[ids[i]] = quads[i];
    return markers;
  }

  /// From the corners, when all are seen. A camera that nobody moves stays where it is.
  void place_camera(const std::map<int, Quad>& markers) {
    std::vector<cv::Point2f> seen;
    for (int id = 1; id <= kCorners; ++id) {
      const auto marker = markers.find(id);
      if (marker == markers.end()) return;
      seen.push_back(centre_of(marker->second));
    }
    cv::Vec3d turn;
    if (!cv::solvePnP(corners_, seen, lens_.matrix, lens_.distortion, turn, shift_, false,
                      cv::SOLVEPNP_IPPE))
      return;
    cv::solvePnPRefineLM(corners_, seen, lens_.matrix, lens_.distortion, turn, shift_);
    cv::Rodrigues(turn, world_to_camera_);
    placed_ = true;
  }

  /// By least squares over the marker's corners and the ground's slope. Corners alone are
  /// ambiguous: seen from far above, a square that leans one way looks like one that leans the
  /// other way, and `height` turns the wrong one into centimetres.
  Fix fix_of(const Quad& quad) const {
    constexpr double kCorner_px = 0.3;
    constexpr double kSlope_rad = 0.1;
    const auto half = static_cast<float>(0.5 * arguments_.side_m);
    const std::vector<cv::Point3f> square = {
        {-half, half, 0.0F}, {half, half, 0.0F}, {half, -half, 0.0F}, {-half, -half, 0.0F}};
    // The robot's middle, in the axes of its marker: y to the front, z up.
    const cv::Vec3d middle(0.0, -arguments_.ahead_m, -arguments_.height_m);
    const cv::Matx33d to_world = world_to_camera_.t();

    cv::Vec3d turn;
    cv::Vec3d shift;
    start_upright(square, quad, turn, shift);
    for (int round = 0;; ++round) {
      cv::Matx33d rotation;
      cv::Matx<double, 3, 9> rotation_by_turn;
      cv::Rodrigues(turn, rotation, rotation_by_turn);
      const cv::Vec3d at = to_world * (rotation * middle + shift - shift_);
      const cv::Vec3d up = to_world * rotation * cv::Vec3d(0.0, 0.0, 1.0);
      std::vector<cv::Point2f> seen;
      cv::Mat seen_by_pose;
      cv::projectPoints(square, turn, shift, lens_.matrix, lens_.distortion, seen, seen_by_pose);

      // Eight coordinates of corners, two slopes; turn and shift.
      cv::Matx<double, 10, 1> off;
      cv::Matx<double, 10, 6> by_pose;
      cv::Matx<double, 2, 6> at_by_pose;
      for (int corner = 0; corner < 4; ++corner) {
        const cv::Point2d away = cv::Point2d(seen[corner]) - cv::Point2d(quad[corner]);
        off(2 * corner) = away.x / kCorner_px;
        off(2 * corner + 1) = away.y / kCorner_px;
      }
      for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < 8; ++k) by_pose(k, i) = seen_by_pose.at<double>(k, i) / kCorner_px;
      }
      for (int i = 0; i < 3; ++i) {
        const cv::Matx33d rotation_by_i = rotation_by_turn.row(i).reshape<3, 3>();
        const cv::Vec3d up_by_i = to_world * rotation_by_i * cv::Vec3d(0.0, 0.0, 1.0);
        const cv::Vec3d at_by_i = to_world * rotation_by_i * middle;
        for (int axis = 0; axis < 2; ++axis) {
          off(8 + axis) = up[axis] / kSlope_rad;
          by_pose(8 + axis, i) = up_by_i[axis] / kSlope_rad;
          at_by_pose(axis, i) = at_by_i[axis];
          at_by_pose(axis, 3 + i) = to_world(axis, i);
        }
      }
      const cv::Matx66d covariance = (by_pose.t() * by_pose).inv(cv::DECOMP_CHOLESKY);
      constexpr int kRounds = 10;
      if (round == kRounds) {
        const cv::Matx22d of_position = at_by_pose * covariance * at_by_pose.t();
        return {at[0], at[1], std::sqrt(0.5 * cv::trace(of_position))};
      }
      const cv::Matx<double, 6, 1> step = covariance * (by_pose.t() * off);
      for (int i = 0; i < 3; ++i) {
        turn[i] -= step(i);
        shift[i] -= step(3 + i);
      }
    }
  }

  /// Of the two ways in which a square can lean, the one that is nearer to upright.
  void start_upright(const std::vector<cv::Point3f>& square, const Quad& quad, cv::Vec3d& turn,
                     cv::Vec3d& shift) const {
    std::vector<cv::Vec3d> turns;
    std::vector<cv::Vec3d> shifts;
    cv::solvePnPGeneric(square, quad, lens_.matrix, lens_.distortion, turns, shifts, false,
                        cv::SOLVEPNP_IPPE_SQUARE);
    double greatest = -2.0;
    for (size_t i = 0; i < turns.size(); ++i) {
      cv::Matx33d rotation;
      cv::Rodrigues(turns[i], rotation);
      const double upright = (world_to_camera_.t() * rotation)(2, 2);
      if (upright <= greatest) continue;
      greatest = upright;
      turn = turns[i];
      shift = shifts[i];
    }
  }

  const TrackArguments& arguments_;
  Lens lens_;
  std::vector<cv::Point3f> corners_;
  bool placed_ = false;
  cv::Matx33d world_to_camera_;
  cv::Vec3d shift_;
  std::string missing_;
};

int track(const TrackArguments& arguments) {
  Tracker tracker(arguments, read_lens(arguments.camera));
  cv::VideoCapture capture = open_source(arguments.source);
  cv::Mat picture;
  std::string said;
  long fixes = 0;
  while (capture.read(picture)) {
    const std::optional<Fix> fix = tracker.look(picture);
    if (tracker.missing() != said && !tracker.missing().empty())
      std::cerr << "not seen: " << tracker.missing() << "\n";
    said = tracker.missing();
    if (!fix.has_value()) continue;
    ++fixes;
    std::printf("%.4f %.4f %.4f\n", fix->x_m, fix->y_m, fix->sigma_m);
    if (std::fflush(stdout) != 0) return 0;  // whoever read it has ended
  }
  if (fixes == 0) throw RunError(arguments.source + ": no fix; not seen: " + said);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // What goes wrong is said below, in one line.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  screed::Command app("Position fixes of a robot, from a camera above its bed", "site_camera");
  const char* const source = "Number of a camera, a film, or pictures: frame_%03d.png";

  std::string sheet;
  screed::Command* markers = app.add_subcommand("markers", "Write the five markers, to print");
  markers->add_option("FILE", sheet, "PNG")->required();

  CalibrateArguments lens;
  screed::Command* calibration =
      app.add_subcommand("calibrate", "Measure a camera by views of a chessboard");
  calibration->add_option("SOURCE", lens.source, source)->required();
  calibration->add_option("--out", lens.out, "What to write")->type_name("FILE")->show_default();
  calibration->add_option("--columns", lens.columns, "Inner corners of the chessboard, across")
      ->range(3, 50)
      ->show_default();
  calibration->add_option("--rows", lens.rows, "Inner corners, down")->range(3, 50)->show_default();
  calibration->add_option("--square", lens.square_m, "Side of a square [m]")
      ->range(0.001, 1.0)
      ->show_default();

  TrackArguments bed;
  screed::Command* tracking = app.add_subcommand("track", "Print a fix a picture: x y sigma [m]");
  tracking->add_option("SOURCE", bed.source, source)->required();
  tracking->add_option("--camera", bed.camera, "As calibrate wrote it")
      ->type_name("FILE")
      ->show_default();
  tracking
      ->add_option("--site", bed.site,
                   "Between the centres of the corner markers, WIDTHxDEPTH, east and north [m]")
      ->required();
  tracking->add_option("--side", bed.side_m, "Black side of the robot's marker [m]")
      ->range(0.01, 1.0)
      ->show_default();
  tracking->add_option("--height", bed.height_m, "Of the marker over the robot's middle [m]")
      ->range(0.0, 1.0)
      ->show_default();
  tracking->add_option("--ahead", bed.ahead_m, "Of the marker before the robot's middle [m]")
      ->range(-0.5, 0.5)
      ->show_default();

  std::function<int()> action;
  markers->callback([&] { action = [&] { return write_markers(sheet); }; });
  calibration->callback([&] { action = [&] { return calibrate(lens); }; });
  tracking->callback([&] { action = [&] { return track(bed); }; });
  return screed::run_program(app, argc, argv, [&] { return action(); });
}
