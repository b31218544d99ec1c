// Lower surfaces against the bodies themselves: points that are inside or not, searched along
// vertical lines, in attitudes drawn at random.
#include "host_sim/physics/terrain/footprint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/footprint_contact.h"

namespace screed {
namespace {

constexpr double kEdge = 0.005;

/// A body as the set of its points, in its own axes; its sides (local y) are left open for a track,
/// whose share says how it covers a square there.
struct Body {
  std::string name;
  Footprint footprint;
  std::function<bool(const Eigen::Vector3d&)> inside;
};

Body track(double half, double radius, double width) {
  return {"track", Footprint::track(half, radius, width), [=](const Eigen::Vector3d& p) {
            const double beyond = std::max(0.0, std::abs(p.x()) - half);
            return std::hypot(beyond, p.z()) < radius;
          }};
}
Body box(const Eigen::Vector3d& size) {
  return {"box", Footprint::box(size), [=](const Eigen::Vector3d& p) {
            return (p.cwiseAbs().array() < 0.5 * size.array()).all();
          }};
}
Body disc(double radius, double thickness) {
  return {"disc", Footprint::disc(radius, thickness), [=](const Eigen::Vector3d& p) {
            return std::hypot(p.x(), p.y()) < radius && std::abs(p.z()) < 0.5 * thickness;
          }};
}

/// Where a vertical line, going up, enters the body, m; nothing when it misses it.
std::optional<double> entry(const Body& body, double x, double y) {
  const Eigen::Isometry3d to_local = body.footprint.pose().inverse();
  const double centre = body.footprint.pose().translation().z();
  const auto inside = [&](double z) { return body.inside(to_local * Eigen::Vector3d(x, y, z)); };
  constexpr double kStep = 0.0005;
  constexpr double kFar = 0.4;
  for (double z = centre - kFar; z < centre + kFar; z += kStep) {
    if (!inside(z)) continue;
    double out = z - kStep;
    double in = z;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (out + in);
      (inside(middle) ? in : out) = middle;
    }
    return in;
  }
  return std::nullopt;
}

FootprintSamples surface_at(const Footprint& footprint, const std::vector<Eigen::Vector2d>& places,
                            const PathHistory* path = nullptr) {
  FootprintSamples samples;
  samples.clear(places.size());
  for (const Eigen::Vector2d& place : places) samples.add(place.x(), place.y());
  if (path != nullptr) {
    footprint.surface(kEdge, *path, samples);
  } else {
    footprint.surface(kEdge, samples);
  }
  return samples;
}

double height_at(const Footprint& footprint, double x, double y) {
  return surface_at(footprint, {{x, y}}).height[0];
}

class Poses {
 public:
  explicit Poses(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// Anywhere, at any yaw, rolled and pitched up to `tilt`, rad.
  Eigen::Isometry3d pose(double tilt) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << between(-1.0, 1.0), between(-1.0, 1.0), between(-0.3, 0.3);
    pose.linear() = (Eigen::AngleAxisd(between(-3.1, 3.1), Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(between(-tilt, tilt), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(between(-tilt, tilt), Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    return pose;
  }

 private:
  std::mt19937 random_;
};

std::vector<Body> bodies() {
  return {track(0.06, 0.03, 0.04), track(0.0, 0.05, 0.03), box({0.12, 0.08, 0.05}),
          disc(0.06, 0.03)};
}

TEST(Footprint, ItsSurfaceIsWhereAVerticalLineEntersTheBody) {
  for (Body& body : bodies()) {
    Poses poses(1);
    int hits = 0;
    for (int trial = 0; trial < 25; ++trial) {
      // The end of a disc alone is its surface.
      body.footprint.set_pose(poses.pose(body.name == "disc" ? 0.0 : 0.9));
      const Eigen::Vector3d centre = body.footprint.pose().translation();
      for (int i = 0; i < 24; ++i) {
        const double x = centre.x() + poses.between(-0.05, 0.05);
        const double y = centre.y() + poses.between(-0.05, 0.05);
        // Not at the outline, where a line leaves the body as soon as it has entered.
        constexpr double kAround = 0.002;
        const FootprintSamples samples = surface_at(
            body.footprint,
            {{x, y}, {x + kAround, y}, {x - kAround, y}, {x, y + kAround}, {x, y - kAround}});
        if (*std::min_element(samples.share.begin(), samples.share.begin() + 5) < 1.0) continue;
        const auto expected = entry(body, x, y);
        ASSERT_TRUE(expected.has_value()) << body.name;
        EXPECT_NEAR(samples.height[0], *expected, 1e-6) << body.name;
        ++hits;
      }
    }
    EXPECT_GT(hits, 30) << body.name;
  }
}

TEST(Footprint, UpsideDownItsOtherSideIsBelow) {
  for (Body& body : bodies()) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << 0.3, -0.2, 0.1;
    pose.linear() = (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    body.footprint.set_pose(pose);
    for (const double along : {-0.03, 0.0, 0.03}) {
      const Eigen::Vector3d at = pose * Eigen::Vector3d(along, 0.0, 0.0);
      EXPECT_NEAR(height_at(body.footprint, at.x(), at.y()), *entry(body, at.x(), at.y()), 1e-6)
          << body.name;
      EXPECT_EQ(surface_at(body.footprint, {{at.x(), at.y()}}).share[0], 1.0) << body.name;
    }
  }
}

TEST(Footprint, ItMissesWhatItDoesNotCover) {
  for (Body& body : bodies()) {
    Poses poses(2);
    for (int trial = 0; trial < 40; ++trial) {
      body.footprint.set_pose(poses.pose(0.5));
      const Eigen::Vector3d centre = body.footprint.pose().translation();
      const double angle = poses.between(0.0, 6.28);
      const double far = body.footprint.radius_from_above() + kEdge;
      EXPECT_EQ(surface_at(body.footprint, {{centre.x() + far * std::cos(angle),
                                             centre.y() + far * std::sin(angle)}})
                    .share[0],
                0.0)
          << body.name;
    }
  }
}

TEST(Footprint, SlopesAreThoseOfItsHeights) {
  for (Body& body : bodies()) {
    Poses poses(3);
    int seen = 0;
    for (int trial = 0; trial < 200; ++trial) {
      body.footprint.set_pose(poses.pose(body.name == "disc" ? 0.4 : 0.7));
      const Eigen::Vector3d centre = body.footprint.pose().translation();
      const double x = centre.x() + poses.between(-0.06, 0.06);
      const double y = centre.y() + poses.between(-0.06, 0.06);
      constexpr double kStep = 1e-6;
      const FootprintSamples s = surface_at(
          body.footprint, {{x, y}, {x + kStep, y}, {x - kStep, y}, {x, y + kStep}, {x, y - kStep}});
      if (*std::min_element(s.share.begin(), s.share.begin() + 5) < 1.0) continue;
      const double by_x = (s.height[1] - s.height[2]) / (2.0 * kStep);
      const double by_y = (s.height[3] - s.height[4]) / (2.0 * kStep);
      if (std::hypot(by_x, by_y) > 5.0) continue;  // an edge, or nearly upright
      // An edge between the neighbours has no slope.
      if (std::abs(s.height[1] + s.height[2] - 2.0 * s.height[0]) > 1e-9) continue;
      // The normal into the body is (-dz/dx, -dz/dy, 1).
      EXPECT_NEAR(s.slope_x[0], -by_x, 1e-3 * (1.0 + std::abs(by_x))) << body.name;
      EXPECT_NEAR(s.slope_y[0], -by_y, 1e-3 * (1.0 + std::abs(by_y))) << body.name;
      ++seen;
    }
    EXPECT_GT(seen, 40) << body.name;
  }
}

TEST(Footprint, TheShareFallsLinearlyAcrossItsSide) {
  // Level: a track's and a box's sides, a disc's rim.
  Body wheel = track(0.05, 0.03, 0.04);
  Body cuboid = box({0.12, 0.04, 0.05});
  Body round = disc(0.02, 0.03);
  for (Body* body : {&wheel, &cuboid, &round}) {
    for (const double inside : {0.01, 0.0025, 0.001, 0.0, -0.001, -0.0024, -0.0026, -0.01}) {
      for (const double side : {1.0, -1.0}) {
        const double share = surface_at(body->footprint, {{0.0, side * (0.02 - inside)}}).share[0];
        EXPECT_NEAR(share, std::clamp(0.5 + inside / kEdge, 0.0, 1.0), 1e-9)
            << body->name << " " << inside;
      }
    }
  }
}

TEST(Footprint, ABoxesCornerHasTheProductOfBothShares) {
  const Footprint cuboid = Footprint::box({0.12, 0.04, 0.05});
  EXPECT_NEAR(surface_at(cuboid, {{0.06, 0.02}}).share[0], 0.25, 1e-12);
  EXPECT_NEAR(surface_at(cuboid, {{0.06 - 0.001, 0.02}}).share[0], 0.7 * 0.5, 1e-12);
  EXPECT_NEAR(surface_at(cuboid, {{0.06 + 0.001, 0.02}}).share[0], 0.3 * 0.5, 1e-12);
}

TEST(Footprint, IsPlaneAsFarAsItSays) {
  Body belt = track(0.06, 0.03, 0.04);
  Body round = disc(0.06, 0.03);
  for (const double along : {0.0, 0.02, 0.059, 0.061, 0.07}) {
    EXPECT_NEAR(surface_at(belt.footprint, {{along, 0.0}}).flat_within[0], 0.06 - along, 1e-12);
    if (along < 0.06) {
      EXPECT_NEAR(surface_at(round.footprint, {{along, 0.0}}).flat_within[0], 0.06 - along, 1e-12);
    }
  }
  EXPECT_LT(surface_at(Footprint::wheel(0.05, 0.03), {{0.0, 0.0}}).flat_within[0], 0.0);
  EXPECT_EQ(surface_at(Footprint::box({0.1, 0.1, 0.1}), {{0.0, 0.0}}).flat_within[0], 0.0);
}

TEST(Footprint, ATrackOnItsSideCoversNothingAndOneOnEndStandsOnAWheel) {
  Body belt = track(0.06, 0.03, 0.04);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()).toRotationMatrix();
  belt.footprint.set_pose(pose);
  EXPECT_EQ(surface_at(belt.footprint, {{0.0, 0.0}}).share[0], 0.0);
  pose.linear() =
      Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  belt.footprint.set_pose(pose);
  EXPECT_NEAR(height_at(belt.footprint, 0.0, 0.0), -0.09, 1e-9);
  EXPECT_NEAR(height_at(belt.footprint, 0.02, 0.0), -0.06 - std::sqrt(0.0009 - 0.0004), 1e-9);
}

// ---- extents

/// Points on and in the body, in the world.
std::vector<Eigen::Vector3d> points_of(const Body& body) {
  const Footprint& f = body.footprint;
  const double beyond = f.kind() == Footprint::Kind::kTrack ? f.radius() : 0.0;
  const Eigen::Vector3d half(f.half().x() + beyond, f.half().y(), f.half().z() + beyond);
  std::vector<Eigen::Vector3d> points;
  constexpr int kSteps = 32;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int k = -kSteps; k <= kSteps; ++k) {
      for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const Eigen::Vector3d p(half.x() * i / kSteps, half.y() * y, half.z() * k / kSteps);
        if (body.inside(p * 0.99999)) points.push_back(f.pose() * p);
      }
    }
  }
  return points;
}

TEST(Footprint, ReachHoldsTheBody) {
  for (Body& body : bodies()) {
    Poses poses(4);
    for (int trial = 0; trial < 12; ++trial) {
      body.footprint.set_pose(poses.pose(0.8));
      const Footprint& f = body.footprint;
      const Eigen::Vector3d centre = f.pose().translation();
      Eigen::Vector3d most = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& p : points_of(body)) {
        most = most.cwiseMax((p - centre).cwiseAbs());
      }
      EXPECT_GE(f.reach().x(), most.x() - 1e-9) << body.name;
      EXPECT_GE(f.reach().y(), most.y() - 1e-9) << body.name;
      EXPECT_GE(f.reach_down(), most.z() - 1e-9) << body.name;
      EXPECT_GE(f.radius_from_above(), std::max(most.x(), most.y())) << body.name;
      // A box round it is at most as much larger as a box round a ball.
      EXPECT_LE(f.reach().norm(), 1.6 * most.head<2>().norm() + 1e-9) << body.name;
      EXPECT_LE(f.reach_down(), 1.6 * most.z() + 1e-9) << body.name;
    }
  }
}

TEST(Footprint, ReachOfALevelBodyIsItsHalfExtents) {
  const Footprint belt = Footprint::track(0.06, 0.03, 0.04);
  EXPECT_EQ(belt.reach(), Eigen::Vector2d(0.09, 0.02));
  EXPECT_EQ(belt.reach_down(), 0.03);
  EXPECT_DOUBLE_EQ(belt.radius_from_above(), std::hypot(0.09, 0.02));
  EXPECT_EQ(Footprint::box({0.12, 0.08, 0.05}).reach(), Eigen::Vector2d(0.06, 0.04));
  EXPECT_EQ(Footprint::disc(0.06, 0.03).reach_down(), 0.015);
}

TEST(Footprint, ReachBelowHoldsWhatIsBelow) {
  for (const double half : {0.0, 0.06}) {
    Body body = track(half, 0.03, 0.04);
    Poses poses(5);
    double slack = 0.0;
    int tested = 0;
    for (int trial = 0; trial < 12; ++trial) {
      body.footprint.set_pose(poses.pose(0.6));
      const Footprint& f = body.footprint;
      const Eigen::Vector3d centre = f.pose().translation();
      const std::vector<Eigen::Vector3d> points = points_of(body);
      double lowest = 1e9;
      for (const Eigen::Vector3d& p : points) lowest = std::min(lowest, p.z());
      const Eigen::Vector2d aslant = Eigen::Vector2d(0.6, -0.8);
      EXPECT_LT(f.reach_below(lowest - 0.06, aslant), 0.0);
      for (const double above : {0.002, 0.01, 0.03}) {
        Eigen::Vector2d most = Eigen::Vector2d::Zero();
        double most_aslant = 0.0;
        for (const Eigen::Vector3d& p : points) {
          if (p.z() > lowest + above) continue;
          most = most.cwiseMax((p - centre).head<2>().cwiseAbs());
          most_aslant = std::max(most_aslant, std::abs((p - centre).head<2>().dot(aslant)));
        }
        const Eigen::Vector2d reach(f.reach_below(lowest + above, Eigen::Vector2d::UnitX()),
                                    f.reach_below(lowest + above, Eigen::Vector2d::UnitY()));
        EXPECT_GE(f.reach_below(lowest + above, aslant), most_aslant - 1e-9);
        EXPECT_GE(reach.x(), most.x() - 1e-9) << half << " " << above;
        EXPECT_GE(reach.y(), most.y() - 1e-9) << half << " " << above;
        slack += (reach - most).sum();
        ++tested;
      }
    }
    EXPECT_LT(slack / tested, 0.03) << half;  // both directions together, m
  }
  // Level, in closed form: half a chord of the circle round each axle.
  const Footprint belt = Footprint::track(0.06, 0.05, 0.04);
  const Eigen::Vector2d ahead = Eigen::Vector2d::UnitX();
  EXPECT_NEAR(belt.reach_below(-0.04, ahead), 0.06 + 0.03, 1e-12);
  EXPECT_NEAR(belt.reach_below(-0.04, Eigen::Vector2d::UnitY()), 0.02, 1e-12);
  EXPECT_NEAR(belt.reach_below(0.02, ahead), 0.06 + 0.05, 1e-12) << "above the axles: all of it";
  EXPECT_LT(belt.reach_below(-0.05, ahead), 0.0);
}

TEST(Footprint, LowestAtRimIsBelowWhateverLiesInASquareAtTheOutline) {
  for (Body& body : bodies()) {
    Poses poses(6);
    for (int trial = 0; trial < 12; ++trial) {
      body.footprint.set_pose(poses.pose(body.name == "disc" ? 0.3 : 0.5));
      const Footprint& f = body.footprint;
      const double bound = f.lowest_at_rim(kEdge);
      EXPECT_GE(bound, f.pose().translation().z() - f.reach_down() - 1e-12) << body.name;
      for (int i = 0; i < 60; ++i) {
        const Eigen::Vector2d at(f.pose().translation().x() + poses.between(-0.12, 0.12),
                                 f.pose().translation().y() + poses.between(-0.12, 0.12));
        if (entry(body, at.x(), at.y()).has_value()) continue;
        for (const double dx : {-0.5, 0.5}) {
          for (const double dy : {-0.5, 0.5}) {
            const double x = at.x() + dx * kEdge;
            const double y = at.y() + dy * kEdge;
            const FootprintSamples corner = surface_at(f, {{x, y}});
            if (corner.share[0] > 0.0) {
              EXPECT_GE(corner.height[0], bound - 1e-9) << body.name;
            }
          }
        }
      }
    }
  }
  // A level wheel: 1.5 edges inside its outline its surface is sqrt(b (2 r - b)) below the axle.
  const double beyond = 1.5 * kEdge;
  EXPECT_NEAR(Footprint::wheel(0.05, 0.03).lowest_at_rim(kEdge),
              -std::sqrt(beyond * (0.1 - beyond)), 1e-12);
  EXPECT_NEAR(Footprint::wheel(0.05, 0.03).lowest_at_rim(0.05), -0.05, 1e-12)
      << "squares as large as the wheel";
}

TEST(Footprint, SidesAndKinds) {
  const Footprint belt = Footprint::track(0.06, 0.03, 0.04);
  const Footprint wheel = Footprint::wheel(0.05, 0.03);
  const Footprint cuboid = Footprint::box({0.12, 0.08, 0.05});
  const Footprint round = Footprint::disc(0.06, 0.03);
  EXPECT_EQ(belt.narrow(), 0.04);
  EXPECT_EQ(wheel.narrow(), 0.03);
  EXPECT_DOUBLE_EQ(Footprint::wheel(0.01, 0.03).narrow(), 0.02) << "narrower along than across";
  EXPECT_EQ(cuboid.narrow(), 0.08);
  EXPECT_EQ(round.narrow(), 0.06) << "the b of a disc is its radius";
  EXPECT_TRUE(round.round());
  EXPECT_FALSE(cuboid.round());
  EXPECT_TRUE(cuboid.has_corners());
  EXPECT_TRUE(round.has_corners());
  EXPECT_FALSE(belt.has_corners());
  EXPECT_TRUE(belt.extended());
  EXPECT_FALSE(wheel.extended());
  EXPECT_TRUE(cuboid.extended());
  Footprint turned = belt;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 4.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  turned.set_pose(pose);
  EXPECT_NEAR(belt.projected_side(kEdge), kEdge, 1e-15);
  EXPECT_NEAR(turned.projected_side(kEdge), kEdge * std::numbers::sqrt2, 1e-15);
}

// ---- the path

/// The lowest that the body was over a place on its way there, each step of the way looked at.
double swept(Footprint footprint, const PathHistory& path, double x, double y) {
  const Eigen::Isometry3d end = footprint.pose();
  double low = 1e9;
  constexpr int kSteps = 4000;
  constexpr double kFar = 0.3;  // m: longer than the body
  for (int i = 0; i <= kSteps; ++i) {
    const double back = std::copysign(kFar * i / kSteps, path.travel_m);
    Eigen::Isometry3d pose = end;
    pose.translation() -= end.linear() * Eigen::Vector3d(back, 0.0, path.gradient * back);
    footprint.set_pose(pose);
    const FootprintSamples samples = surface_at(footprint, {{x, y}});
    if (samples.share[0] > 0.0) low = std::min(low, samples.height[0]);
  }
  return low;
}

TEST(Footprint, WhatItHasPassedIsTheLowestOfItsWay) {
  for (const double half : {0.0, 0.05}) {
    Poses poses(7);
    int lower = 0;
    for (int trial = 0; trial < 24; ++trial) {
      Footprint belt = Footprint::track(half, 0.03, 0.04);
      belt.set_pose(poses.pose(0.25));
      const PathHistory path = {trial % 2 == 0 ? 0.5 : -0.5, poses.between(-0.3, 0.3)};
      const Eigen::Vector3d local(poses.between(-0.9, 0.9) * (half + 0.03), 0.0, 0.0);
      const Eigen::Vector3d at = belt.pose() * local;
      const FootprintSamples samples = surface_at(belt, {{at.x(), at.y()}}, &path);
      if (samples.share[0] < 1.0) continue;
      EXPECT_NEAR(samples.passed[0], swept(belt, path, at.x(), at.y()), 2e-5)
          << half << " " << trial;
      if (samples.passed[0] < samples.height[0] - 1e-6) ++lower;
    }
    EXPECT_GT(lower, 3) << half;
  }
}

TEST(Footprint, WhereItsWayDoesNotReachItHasPassedNothing) {
  const Footprint wheel = Footprint::wheel(0.05, 0.03);
  // It came 1 cm, from the left: what lies farther from its middle it has not passed.
  const PathHistory path = {0.01, 0.0};
  const FootprintSamples samples =
      surface_at(wheel, {{-0.009, 0.0}, {-0.011, 0.0}, {0.009, 0.0}}, &path);
  EXPECT_NEAR(samples.passed[0], -0.05, 1e-12) << "its lowest point came over here";
  EXPECT_EQ(samples.passed[1], samples.height[1]);
  EXPECT_EQ(samples.passed[2], samples.height[2]) << "ahead of it";
  const PathHistory back = {-0.01, 0.0};
  EXPECT_NEAR(surface_at(wheel, {{0.009, 0.0}}, &back).passed[0], -0.05, 1e-12);
  const Footprint cuboid = Footprint::box({0.12, 0.08, 0.05});
  EXPECT_EQ(surface_at(cuboid, {{0.0, 0.0}}, &path).passed[0], -0.025) << "boxes sweep nothing";
}

TEST(Footprint, AnOddNumberOfPlacesIsAnsweredAsAnEvenOne) {
  Footprint belt = Footprint::track(0.06, 0.03, 0.04);
  const FootprintSamples three = surface_at(belt, {{0.0, 0.0}, {0.07, 0.0}, {0.08, 0.0}});
  const FootprintSamples one = surface_at(belt, {{0.08, 0.0}});
  EXPECT_EQ(three.count, 3U);
  EXPECT_EQ(three.height[2], one.height[0]);
  EXPECT_EQ(three.share[2], one.share[0]);
}

// Slip has the sign of what the surface does to the body, whichever way both go.
TEST(SignedSlip, IsPositiveDrivenAndNegativeBrakedForwardAndBackward) {
  for (const double way : {1.0, -1.0}) {
    const auto slip = [way](double surface, double ground) {
      return signed_slip(way * surface, way * ground);
    };
    EXPECT_DOUBLE_EQ(slip(0.2, 0.2), 0.0) << way;
    EXPECT_DOUBLE_EQ(slip(0.2, 0.15), 0.25) << way;
    EXPECT_DOUBLE_EQ(slip(0.15, 0.2), -0.25) << way;
    EXPECT_DOUBLE_EQ(slip(0.2, 0.0), 1.0) << way << ": on the spot";
    EXPECT_DOUBLE_EQ(slip(0.0, 0.2), -1.0) << way << ": locked";
    EXPECT_DOUBLE_EQ(slip(0.2, -0.05), 1.0) << way << ": it is carried the other way";
    EXPECT_DOUBLE_EQ(slip(0.05, -0.2), 1.0) << way;
    EXPECT_EQ(slip(0.001, -0.001), 0.0) << way << ": next to nothing moves";
    EXPECT_EQ(slip(0.0011, 0.0), 1.0) << way;
    EXPECT_EQ(slip(0.0, 0.0011), -1.0) << way;
  }
}

}  // namespace
}  // namespace screed
