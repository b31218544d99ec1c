// The camera example, from a chessboard to the robot: a lens is calibrated by pictures of a board,
// a recorded run is rendered as that lens sees it, with markers on the robot and round its bed, and
// what the example finds reaches a robot as a fix.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/run/session/session_reader.h"
#include "tests/long/robot_at_port.h"

namespace screed::testing {
namespace {

constexpr int kWidth_px = 1280;
constexpr int kHeight_px = 960;
const cv::Matx33d kMatrix(1000, 0, 640, 0, 1000, 480, 0, 0, 1);
// A wide webcam: 5 % of barrel at the edge.
const std::vector<double> kDistortion = {-0.08, 0.02, 0.0, 0.0, 0.0};

constexpr double kSide_m = 0.15;
constexpr double kHeight_m = 0.1;
constexpr double kSite_x_m = 3.3;
constexpr double kSite_y_m = 2.4;

/// Where the light of each pixel of the lens comes from, on a plane at distance 1.
const cv::Mat& rays() {
  static const cv::Mat rays = [] {
    std::vector<cv::Point2f> pixels;
    for (int v = 0; v < kHeight_px; ++v) {
      for (int u = 0; u < kWidth_px; ++u) pixels.emplace_back(u, v);
    }
    cv::Mat straight;
    cv::undistortPoints(pixels, straight, kMatrix, kDistortion);
    return straight.reshape(2, kHeight_px).clone();
  }();
  return rays;
}

/// A board of 10 x 7 squares of 30 mm, white round it, on grey.
cv::Mat board_seen_from(const cv::Vec3d& turn, const cv::Vec3d& shift) {
  constexpr double kSquare_m = 0.03;
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  const cv::Matx33d back = rotation.t();
  const cv::Vec3d eye = back * -shift;
  cv::Mat picture(kHeight_px, kWidth_px, CV_8UC3, cv::Scalar(120, 120, 120));
  for (int v = 0; v < kHeight_px; ++v) {
    for (int u = 0; u < kWidth_px; ++u) {
      const auto ray = rays().at<cv::Vec2f>(v, u);
      const cv::Vec3d way = back * cv::Vec3d(ray[0], ray[1], 1.0);
      const double away = -eye[2] / way[2];
      const double x = (eye[0] + away * way[0]) / kSquare_m + 5.0;
      const double y = (eye[1] + away * way[1]) / kSquare_m + 3.5;
      if (x < -1 || x > 11 || y < -1 || y > 8) continue;
      const bool on_board = x >= 0 && x < 10 && y >= 0 && y < 7;
      const bool black = on_board && (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
      const int grey = black ? 30 : 230;
      picture.at<cv::Vec3b>(v, u) = cv::Vec3b::all(static_cast<uchar>(grey));
    }
  }
  cv::GaussianBlur(picture, picture, {3, 3}, 0.7);
  return picture;
}

/// Robot axes in those of the world: to the front, to the left, up.
cv::Matx33d axes_of(const SimFrame& frame) {
  const auto about = [](double x, double y, double z) {
    cv::Matx33d rotation;
    cv::Rodrigues(cv::Vec3d(x, y, z), rotation);
    return rotation;
  };
  return about(0, 0, frame.yaw) * about(0, -frame.pitch, 0) * about(frame.roll, 0, 0);
}

/// A marker of the sheet as a thin box. Its axes: right, up (as printed), towards the viewer.
std::string marker_in_scene(int number, double side_m, const cv::Matx33d& axes,
                            const cv::Vec3d& at) {
  char text[700];
  const double metres_per_px = side_m / 600.0;
  std::snprintf(
      text, sizeof text,
      "box { <-450,-450,-3>, <450,450,0> pigment { image_map { png \"markers.png\" } "
      "scale <4500,900,1> translate <%d,-450,0> } finish { ambient 0.1 diffuse 0.8 } scale %.8f "
      "matrix <%.8f,%.8f,%.8f, %.8f,%.8f,%.8f, %.8f,%.8f,%.8f, %.8f,%.8f,%.8f> }\n",
      -(450 + 900 * number), metres_per_px, axes(0, 0), axes(1, 0), axes(2, 0), axes(0, 1),
      axes(1, 1), axes(2, 1), axes(0, 2), axes(1, 2), axes(2, 2), at[0], at[1], at[2]);
  return text;
}

class SiteCamera : public RobotAtPort {
 protected:
  void SetUp() override {
    RobotAtPort::SetUp();
    const char* camera = std::getenv("SITE_CAMERA_PROGRAM");
    ASSERT_NE(camera, nullptr) << "`make test-camera` sets it";
    camera_ = camera;
  }

  Result camera(const std::string& arguments) const {
    return execute("'" + camera_ + "' " + arguments);
  }

  void write_boards() const {
    int number = 0;
    for (const double tilt : {-0.5, 0.0, 0.5}) {
      for (const double lean : {-0.5, 0.1, 0.5}) {
        const cv::Vec3d turn(tilt, lean, 0.1 * number);
        const cv::Vec3d shift(0.25 * lean, 0.2 * tilt, 0.45 + 0.02 * number);
        char name[32];
        std::snprintf(name, sizeof name, "board_%02d.png", number++);
        cv::imwrite((root_ / name).string(), board_seen_from(turn, shift));
      }
    }
  }

  /// The run in folder `r` at that row, as the lens sees it, to see_NN.png.
  void write_frame(const SimFrame& frame, size_t row, int number) const {
    const std::string name = "see_0" + std::to_string(number);
    ASSERT_EQ(run("render r --pov-only --no-path --quiet --frame " + std::to_string(row) +
                  " --out " + name + ".png")
                  .exit_code,
              0);
    std::string scene = read(root_ / (name + ".pov"));
    // Soft shadows take minutes, and markers do not mind.
    const size_t soft = scene.find(" area_light");
    scene.erase(soft, scene.find('}', soft) - soft);
    std::ofstream file(root_ / (name + ".pov"));
    file << scene;
    // Not quite above the middle, nor quite upright.
    file << "camera { location <0,0,0> direction <0,0,-1> up <0," << kHeight_px / 1000.0
         << ",0> right <" << kWidth_px / 1000.0
         << ",0,0> rotate <3,-2,5> translate <-0.1,-0.1,3.8> }\n";
    const cv::Matx33d upright = cv::Matx33d::eye();
    for (int corner = 1; corner <= 4; ++corner) {
      const double x = corner == 2 || corner == 3 ? 0.5 : -0.5;
      const double y = corner >= 3 ? 0.5 : -0.5;
      file << marker_in_scene(corner, 0.15, upright, {x * kSite_x_m, y * kSite_y_m, 0.12});
    }
    const cv::Matx33d axes = axes_of(frame);
    // Its upper edge to the front: right of the marker is right of the robot.
    const cv::Matx33d marker = axes * cv::Matx33d(0, 1, 0, -1, 0, 0, 0, 0, 1);
    const cv::Vec3d at = cv::Vec3d(frame.x, frame.y, frame.z) + axes * cv::Vec3d(0, 0, kHeight_m);
    file << marker_in_scene(0, kSide_m, marker, at);
    file.close();
    ASSERT_TRUE(file.good());
    const std::string povray = "cd '" + root_.string() + "' && povray +I" + name +
                               ".pov +Ostraight.png +W" + std::to_string(kWidth_px) + " +H" +
                               std::to_string(kHeight_px) + " -D +A0.3 > /dev/null 2> povray.txt";
    ASSERT_EQ(std::system(povray.c_str()), 0) << read(root_ / "povray.txt");
    const cv::Mat straight = cv::imread((root_ / "straight.png").string());
    cv::Mat at_px = rays().clone();
    at_px.forEach<cv::Vec2f>([](cv::Vec2f& ray, const int*) {
      ray = {ray[0] * 1000.0F + 640.0F, ray[1] * 1000.0F + 480.0F};
    });
    cv::Mat seen;
    cv::remap(straight, seen, at_px, cv::noArray(), cv::INTER_LINEAR);
    cv::imwrite((root_ / (name + ".png")).string(), seen);
  }

  std::string camera_;
};

TEST_F(SiteCamera, SeesTheRobotOfARenderedRunAndTellsIt) {
  write_boards();
  const Result calibrated = camera("calibrate board_%02d.png --square 0.03");
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.err;
  std::cout << calibrated.out;
  cv::Mat matrix;
  const cv::FileStorage lens((root_ / "camera.yml").string(), cv::FileStorage::READ);
  lens["camera_matrix"] >> matrix;
  EXPECT_NEAR(matrix.at<double>(0, 0), 1000.0, 5.0);
  EXPECT_NEAR(matrix.at<double>(0, 2), 640.0, 5.0);

  ASSERT_EQ(camera("markers markers.png").exit_code, 0);
  ASSERT_EQ(run("sim first_drive --duration 45 --quiet --no-pictures --out r").exit_code, 0);
  const SessionReader session(root_ / "r/session.h5");
  std::vector<SimFrame> frames(session.frames());
  session.read(0, std::span(frames));
  const std::vector<size_t> rows = {400, 1400, 2200, 3000, 3700, 4400};
  for (size_t i = 0; i < rows.size(); ++i)
    ASSERT_NO_FATAL_FAILURE(write_frame(frames[rows[i]], rows[i], static_cast<int>(i)));

  const std::string site = " --site 3.3x2.4 --side 0.15 --height 0.1";
  const Result tracked = camera("track see_%02d.png" + site);
  ASSERT_EQ(tracked.exit_code, 0) << tracked.err;
  std::istringstream lines(tracked.out);
  double squares = 0.0;
  double greatest = 0.0;
  for (const size_t row : rows) {
    double x = NAN;
    double y = NAN;
    double sigma = NAN;
    ASSERT_TRUE(lines >> x >> y >> sigma) << tracked.out << tracked.err;
    const double error = std::hypot(x - frames[row].x, y - frames[row].y);
    std::printf("row %zu: at %.3f %.3f m, error %.1f mm, said %.1f mm\n", row, frames[row].x,
                frames[row].y, 1e3 * error, 1e3 * sigma);
    EXPECT_LT(error, 4.0 * sigma) << row;
    squares += error * error;
    greatest = std::max(greatest, error);
  }
  std::printf("error of the fixes: %.1f mm (RMS), %.1f mm at most\n",
              1e3 * std::sqrt(squares / static_cast<double>(rows.size())), 1e3 * greatest);
  EXPECT_LT(greatest, 0.03) << "as the robot's parameter fix_sigma has it";

  // The last of them, to a robot that stands and believes itself elsewhere.
  const Result told = with_robot("'" + camera_ + "' track see_05.png" + site +
                                     " > fix\ncat fix fix fix fix > fixes\n"
                                     "$screed fix --pty radio fixes\n",
                                 "--set fixes.period=0");
  ASSERT_EQ(told.exit_code, 0) << told.out << told.err;
  EXPECT_NE(told.out.find("4 fixes taken by robot 1"), std::string::npos) << told.out;
  const SessionReader robot(root_ / "robot/session.h5");
  SimFrame last;
  robot.read(robot.frames() - 1, std::span(&last, 1));
  EXPECT_NEAR(last.odometry_x, frames[rows.back()].x, 0.035);
  EXPECT_NEAR(last.odometry_y, frames[rows.back()].y, 0.035);
}

TEST_F(SiteCamera, SaysWhatItDoesNotSeeAndWhatIsWrong) {
  cv::imwrite((root_ / "grey.png").string(),
              cv::Mat(kHeight_px, kWidth_px, CV_8UC3, cv::Scalar(90, 90, 90)));
  expect_refused(camera("calibrate grey.png"), 2, {"0 different views of a chessboard"});
  expect_refused(camera("track grey.png --site 3x2"), 2, {"camera.yml: cannot be read"});
  write("camera.yml", "%YAML:1.0\n---\nsize_px: [ 1, 1 ]\n");
  expect_refused(camera("track grey.png --site 3x2"), 2, {"camera.yml: is no calibration"});
  expect_refused(camera("track nothing.png --site 3x2 --camera camera.yml"), 2, {});
  EXPECT_NE(camera("track grey.png --site wide").exit_code, 0);
}

}  // namespace
}  // namespace screed::testing
