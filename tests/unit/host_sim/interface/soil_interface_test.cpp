// The C interface of soil: the same bits as the soil itself, what it refuses, states, threads.
#include "host_sim/interface/screed/soil.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/core/rotation.h"
#include "host_sim/physics/soil/soil_bed.h"

namespace screed {
namespace {

// Programs that are there were compiled with these sizes: whoever changes one makes a new ABI.
static_assert(sizeof(screed_error) == 256);
static_assert(sizeof(screed_bed) == 32);
static_assert(sizeof(screed_setting) == 16);
static_assert(sizeof(screed_patch) == 56);
static_assert(sizeof(screed_body_motion) == 152);
static_assert(sizeof(screed_patch_motion) == 104);
static_assert(sizeof(screed_wrench) == 80);
static_assert(sizeof(screed_rectangle) == 16);
static_assert(sizeof(screed_volumes) == 40);

struct Destroy {
  void operator()(screed_soil* soil) const { screed_soil_destroy(soil); }
};
using Soil = std::unique_ptr<screed_soil, Destroy>;

constexpr double kStep_s = 0.002;
constexpr screed_bed kBed = {101, 61, 0.01, SCREED_EDGE_WALLED, nullptr};
constexpr double kRough = std::numeric_limits<double>::infinity();
constexpr screed_patch kWheel = {SCREED_WHEEL, {0.04, 0.03, 0.0}, kRough, 0.0, 0.002};
constexpr screed_patch kHull = {SCREED_BOX, {0.2, 0.1, 0.05}, 0.4, 0.0, 0.0};

Soil make(const screed_bed& bed = kBed, const char* preset = "gravel") {
  screed_error error;
  Soil soil(screed_soil_create(&bed, preset, nullptr, 0, &error));
  EXPECT_NE(soil, nullptr) << error.text;
  return soil;
}

screed_patch_motion patch_at(const Eigen::Vector3d& place, double yaw, double surface_speed) {
  screed_patch_motion patch{};
  std::copy_n(place.data(), 3, patch.position);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> axes =
      rotation_about(Eigen::Vector3d::UnitZ(), yaw).toRotationMatrix();
  std::copy_n(axes.data(), 9, patch.axes);
  patch.surface_speed = surface_speed;
  return patch;
}

/// Two wheels and a hull between them go round in a circle and slip; they sink into the soil.
class Ride {
 public:
  explicit Ride(screed_soil* soil) : soil_(soil) {
    const std::array<screed_patch, 3> patches = {kWheel, kWheel, kHull};
    body_ = screed_soil_add_body(soil, patches.data(), patches.size(), nullptr);
    EXPECT_EQ(body_, 0);
  }
  /// Goes on with a soil that was loaded.
  Ride(screed_soil* soil, const Ride& other) : Ride(other) { soil_ = soil; }

  screed_body_motion body() const {
    const double t = step_ * kStep_s;
    screed_body_motion body{};
    body.mass = 1.5;
    body.inertia[0] = body.inertia[4] = body.inertia[8] = 0.01;
    body.centre[0] = 0.15 * std::cos(t);
    body.centre[1] = 0.15 * std::sin(t);
    body.centre[2] = 0.045 - 0.01 * t;
    body.velocity[0] = -0.15 * std::sin(t);
    body.velocity[1] = 0.15 * std::cos(t);
    body.velocity[2] = -0.01;
    body.omega[2] = 1.0;
    return body;
  }
  std::array<screed_patch_motion, 3> patches() const {
    const double t = step_ * kStep_s;
    const Eigen::Vector3d centre(0.15 * std::cos(t), 0.15 * std::sin(t), 0.045 - 0.01 * t);
    const double yaw = t + 0.5 * M_PI;
    const Eigen::Vector3d left(-std::sin(yaw), std::cos(yaw), 0.0);
    const Eigen::Vector3d down(0.0, 0.0, 0.01);
    return {patch_at(centre + 0.09 * left - down, yaw, 0.2),
            patch_at(centre - 0.09 * left - down, yaw, 0.25), patch_at(centre + down, yaw, 0.0)};
  }
  std::array<screed_wrench, 3> step() {
    std::array<screed_wrench, 3> wrenches{};
    screed_error error;
    const screed_body_motion motion = body();
    EXPECT_EQ(screed_soil_press(soil_, body_, &motion, patches().data(), kStep_s, wrenches.data(),
                                &error),
              SCREED_OK)
        << error.text;
    EXPECT_EQ(screed_soil_end_step(soil_, &error), SCREED_OK) << error.text;
    ++step_;
    return wrenches;
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) step();
  }

 private:
  screed_soil* soil_;
  int body_ = -1;
  int step_ = 0;
};

std::vector<double> heights_of(const screed_soil* soil) {
  std::vector<double> heights(static_cast<size_t>(kBed.nodes_x) * kBed.nodes_y);
  const screed_rectangle all = {0, 0, kBed.nodes_x, kBed.nodes_y};
  EXPECT_EQ(screed_soil_heights(soil, &all, heights.data(), nullptr), SCREED_OK);
  return heights;
}

std::vector<char> state_of(const screed_soil* soil) {
  std::vector<char> state(screed_soil_save(soil, nullptr, 0, nullptr));
  EXPECT_EQ(screed_soil_save(soil, state.data(), state.size(), nullptr), state.size());
  return state;
}

/// The text with which a call fails.
template <typename Call>
std::string refusal(const Call& call) {
  screed_error error = {SCREED_OK, "not called"};
  call(&error);
  return error.text;
}

std::string refused_bed(const screed_bed& bed, const char* preset = "gravel",
                        const std::vector<screed_setting>& settings = {}) {
  return refusal([&](screed_error* error) {
    EXPECT_EQ(screed_soil_create(&bed, preset, settings.data(), settings.size(), error), nullptr);
  });
}

TEST(SoilInterface, HasTheBitsOfTheSoilItself) {
  const Soil soil = make();
  Ride ride(soil.get());
  HeightField level(kBed.nodes_x, kBed.nodes_y, kBed.spacing, false);
  level.add_walls();
  SoilBed bed(level, soil_preset("gravel"));
  std::array<Footprint, 3> footprints = {Footprint::wheel(0.04, 0.03), Footprint::wheel(0.04, 0.03),
                                         Footprint::box({0.2, 0.1, 0.05})};
  std::array<ContactMemory, 3> memories;
  BodyMemory memory;
  for (int step = 0; step < 500; ++step) {
    const screed_body_motion motion = ride.body();
    const std::array<screed_patch_motion, 3> patches = ride.patches();
    PressingBody body;
    body.mass_kg = motion.mass;
    body.inverse_inertia = Eigen::Matrix3d::Identity() * 0.01;
    body.inverse_inertia =
        Eigen::LLT<Eigen::Matrix3d>(body.inverse_inertia).solve(Eigen::Matrix3d::Identity());
    body.centre = Eigen::Map<const Eigen::Vector3d>(motion.centre);
    body.velocity = Eigen::Map<const Eigen::Vector3d>(motion.velocity);
    body.omega = Eigen::Map<const Eigen::Vector3d>(motion.omega);
    std::array<FootprintContact, 3> contacts;
    for (size_t i = 0; i < 3; ++i) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(patches[i].axes);
      pose.translation() = Eigen::Map<const Eigen::Vector3d>(patches[i].position);
      footprints[i].set_pose(pose);
      contacts[i].footprint = &footprints[i];
      contacts[i].memory = &memories[i];
      FootprintMotion& its = contacts[i].motion;
      its.surface_speed = patches[i].surface_speed;
      const Eigen::Vector3d velocity =
          body.velocity + body.omega.cross(pose.translation() - body.centre);
      its.slip = signed_slip(its.surface_speed, velocity.dot(pose.linear().col(0)));
      its.soil_friction = i == 2 ? 0.4 : kRough;
      its.lug_height_m = i == 2 ? 0.0 : 0.002;
    }
    bed.press(body, contacts, kStep_s, memory);
    bed.end_step();
    const std::array<screed_wrench, 3> wrenches = ride.step();
    for (size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(wrenches[i].force[k], contacts[i].reaction.force[k]) << step;
        ASSERT_EQ(wrenches[i].torque[k], contacts[i].reaction.torque[k]) << step;
      }
      ASSERT_EQ(wrenches[i].sinkage, contacts[i].reaction.sinkage);
    }
  }
  const std::vector<double> heights = heights_of(soil.get());
  for (size_t i = 0; i < heights.size(); ++i)
    ASSERT_EQ(heights[i], bed.surface().node(i) * kHeightUnit_m);
  EXPECT_LT(*std::min_element(heights.begin(), heights.end()), -0.004);
}

TEST(SoilInterface, VolumesAddUp) {
  const Soil soil = make();
  Ride ride(soil.get());
  for (int i = 0; i < 10; ++i) {
    ride.steps(50);
    screed_volumes volumes{};
    ASSERT_EQ(screed_soil_volumes(soil.get(), &volumes, nullptr), SCREED_OK);
    EXPECT_EQ(volumes.now, volumes.before - volumes.compacted - volumes.in_transit);
    EXPECT_NEAR(volumes.unit, 1e-4 / (1 << 24), 1e-18);
  }
}

TEST(SoilInterface, ALoadedStateGoesOnWithTheSameBits) {
  const Soil soil = make();
  Ride ride(soil.get());
  ride.steps(300);
  const std::vector<char> state = state_of(soil.get());
  screed_error error;
  const Soil loaded(screed_soil_load(state.data(), state.size(), &error));
  ASSERT_NE(loaded, nullptr) << error.text;
  EXPECT_EQ(state_of(loaded.get()), state);
  Ride again(loaded.get(), ride);
  for (int i = 0; i < 300; ++i) {
    const auto here = ride.step();
    const auto there = again.step();
    ASSERT_EQ(std::memcmp(here.data(), there.data(), sizeof(here)), 0) << i;
  }
  EXPECT_EQ(state_of(loaded.get()), state_of(soil.get()));
}

TEST(SoilInterface, DamagedStatesAreRefused) {
  const screed_bed small = {8, 8, 0.02, SCREED_EDGE_WRAPPED, nullptr};
  const Soil soil = make(small);
  const std::vector<char> state = state_of(soil.get());
  const auto load = [](const std::vector<char>& bytes) {
    return refusal([&](screed_error* error) {
      EXPECT_EQ(screed_soil_load(bytes.data(), bytes.size(), error), nullptr);
    });
  };
  for (size_t size = 1; size < state.size(); ++size) {
    ASSERT_EQ(load({state.begin(), state.begin() + static_cast<ptrdiff_t>(size)}),
              "state of a soil: damaged, or of something else");
  }
  for (size_t at = 0; at < state.size(); ++at) {
    std::vector<char> damaged = state;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    ASSERT_NE(load(damaged), "") << at;
  }
}

TEST(SoilInterface, AStateIsWrittenOnlyWhereThereIsRoom) {
  const Soil soil = make();
  std::vector<char> state(screed_soil_save(soil.get(), nullptr, 0, nullptr), 'x');
  EXPECT_EQ(screed_soil_save(soil.get(), state.data(), state.size() - 1, nullptr), state.size());
  EXPECT_EQ(state, std::vector<char>(state.size(), 'x'));
}

TEST(SoilInterface, NoStateIsSavedInTheMiddleOfAStep) {
  const Soil soil = make();
  const Ride ride(soil.get());
  const screed_body_motion motion = ride.body();
  std::array<screed_wrench, 3> wrenches{};
  ASSERT_EQ(screed_soil_press(soil.get(), 0, &motion, ride.patches().data(), kStep_s,
                              wrenches.data(), nullptr),
            SCREED_OK);
  EXPECT_EQ(refusal([&](screed_error* error) {
              EXPECT_EQ(screed_soil_save(soil.get(), nullptr, 0, error), 0U);
            }),
            "save: in the middle of a step; allowed: after its end");
  ASSERT_EQ(screed_soil_end_step(soil.get(), nullptr), SCREED_OK);
  EXPECT_GT(screed_soil_save(soil.get(), nullptr, 0, nullptr), 0U);
}

TEST(SoilInterface, ChangedHoldsEveryNodeThatChanged) {
  const Soil soil = make();
  screed_rectangle changed{};
  ASSERT_EQ(screed_soil_changed(soil.get(), &changed, nullptr), SCREED_OK);
  EXPECT_EQ(changed.nodes_x * changed.nodes_y, kBed.nodes_x * kBed.nodes_y);
  ASSERT_EQ(screed_soil_changed(soil.get(), &changed, nullptr), SCREED_OK);
  EXPECT_EQ(changed.nodes_x, 0);
  const std::vector<double> before = heights_of(soil.get());
  Ride(soil.get()).steps(100);
  const std::vector<double> after = heights_of(soil.get());
  ASSERT_EQ(screed_soil_changed(soil.get(), &changed, nullptr), SCREED_OK);
  EXPECT_LT(changed.nodes_x * changed.nodes_y, kBed.nodes_x * kBed.nodes_y);
  int moved = 0;
  for (int y = 0; y < kBed.nodes_y; ++y) {
    for (int x = 0; x < kBed.nodes_x; ++x) {
      const size_t node = static_cast<size_t>(y) * kBed.nodes_x + static_cast<size_t>(x);
      if (before[node] == after[node]) continue;
      ++moved;
      EXPECT_TRUE(x >= changed.x && x < changed.x + changed.nodes_x);
      EXPECT_TRUE(y >= changed.y && y < changed.y + changed.nodes_y);
    }
  }
  EXPECT_GT(moved, 10);
}

TEST(SoilInterface, SoilsOnEightThreadsDoNotKnowOfEachOther) {
  const auto ride = [] {
    const Soil soil = make();
    Ride(soil.get()).steps(200);
    return state_of(soil.get());
  };
  const std::vector<char> alone = ride();
  std::array<std::vector<char>, 8> states;
  std::vector<std::thread> threads;
  threads.reserve(states.size());
  for (std::vector<char>& state : states) threads.emplace_back([&] { state = ride(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<char>& state : states) EXPECT_EQ(state, alone);
}

TEST(SoilInterface, ASecondThreadIsRefused) {
  const screed_bed large = {600, 600, 0.01, SCREED_EDGE_OPEN, nullptr};
  const Soil soil = make(large);
  std::atomic<bool> seen = false;
  std::thread other([&] {
    while (!seen) screed_soil_save(soil.get(), nullptr, 0, nullptr);
  });
  screed_error error;
  while (screed_soil_end_step(soil.get(), &error) == SCREED_OK) {
  }
  seen = true;
  other.join();
  EXPECT_STREQ(error.text, "this soil is in use on another thread; one thread at a time");
  EXPECT_EQ(screed_soil_end_step(soil.get(), nullptr), SCREED_OK);
}

TEST(SoilInterface, BedsThatAreNotAllowedAreRefused) {
  EXPECT_EQ(refused_bed({1, 10, 0.01, SCREED_EDGE_OPEN, nullptr}),
            "height field of 1 x 10 samples; allowed: 2 to 16384 a side");
  EXPECT_EQ(refused_bed({10, 10, std::nan(""), SCREED_EDGE_OPEN, nullptr}),
            "height field: spacing_m = nan; allowed: 1e-06 to 100");
  EXPECT_EQ(refused_bed({10, 10, 0.01, 3, nullptr}), "edge = 3; allowed: 0 to 2 (screed_edge)");
  const std::array<double, 4> heights = {0.0, 0.0, std::nan(""), 0.0};
  EXPECT_EQ(refused_bed({2, 2, 0.01, SCREED_EDGE_OPEN, heights.data()}),
            "height = nan; allowed: -127 to 127 m");
  EXPECT_NE(refused_bed(kBed, "loam").find("lete_sand"), std::string::npos);
  EXPECT_NE(refused_bed(kBed, "gravel", {{"phi", 90.0}}).find("0 to 60"), std::string::npos);
  EXPECT_NE(refused_bed(kBed, "gravel", {{"wet", 1.0}}).find("no setting 'wet'; allowed: "),
            std::string::npos);
  EXPECT_EQ(refused_bed(kBed, "gravel", {{"avalanches", 0.5}}),
            "avalanches = 0.5; allowed: 0 or 1");
  EXPECT_EQ(refusal([](screed_error* error) {
              screed_soil_create(nullptr, "gravel", nullptr, 0, error);
            }),
            "bed: a null pointer");
}

TEST(SoilInterface, BodiesThatAreNotAllowedAreRefused) {
  const Soil soil = make();
  const auto add = [&](const screed_patch& patch, size_t count = 1) {
    return refusal([&](screed_error* error) {
      EXPECT_EQ(screed_soil_add_body(soil.get(), &patch, count, error), -1);
    });
  };
  EXPECT_EQ(add({9, {1, 1, 1}, 0, 0, 0}), "shape = 9; allowed: 0 to 3 (screed_shape)");
  EXPECT_EQ(add({SCREED_BOX, {1, 1, 0}, 0, 0, 0}), "size = 0; allowed: 0.0001 to 100 m");
  EXPECT_EQ(add({SCREED_DISC, {1, 1, 0}, -1, 0, 0}), "friction = -1; allowed: 0 or more");
  EXPECT_EQ(add(kWheel, size_t{1} << 40U), "count of patches = 1.09951e+12; allowed: 1 to 1024");
  EXPECT_EQ(add(kWheel, 0), "count of patches = 0; allowed: 1 to 1024");
}

TEST(SoilInterface, AMotionThatIsNotAllowedIsRefusedAndChangesNothing) {
  const Soil soil = make();
  Ride ride(soil.get());
  ride.steps(100);
  const std::vector<char> before = state_of(soil.get());
  const screed_body_motion good = ride.body();
  const std::array<screed_patch_motion, 3> good_patches = ride.patches();
  const auto press = [&](int body, const screed_body_motion& motion,
                         const std::array<screed_patch_motion, 3>& patches, double dt) {
    return refusal([&](screed_error* error) {
      std::array<screed_wrench, 3> wrenches{};
      EXPECT_EQ(
          screed_soil_press(soil.get(), body, &motion, patches.data(), dt, wrenches.data(), error),
          SCREED_BAD_INPUT);
    });
  };
  EXPECT_EQ(press(1, good, good_patches, kStep_s),
            "body = 1; allowed: numbers of bodies, 1 were added");
  EXPECT_EQ(press(0, good, good_patches, 0.1), "dt = 0.1; allowed: 0.00001 to 0.02 s");
  screed_body_motion wrong = good;
  wrong.velocity[1] = std::nan("");
  EXPECT_EQ(press(0, wrong, good_patches, kStep_s), "velocity = nan; allowed: -1000 to 1000 m/s");
  wrong = good;
  wrong.inertia[1] = 5.0;
  EXPECT_EQ(press(0, wrong, good_patches, kStep_s),
            "inertia: allowed: a symmetric matrix with positive moments, or all zero");
  wrong = good;
  wrong.mass = 0.0;
  EXPECT_EQ(press(0, wrong, good_patches, kStep_s), "mass = 0; allowed: 0.000001 kg and more");
  auto patches = good_patches;
  patches[2].axes[0] = 2.0;
  EXPECT_NE(press(0, good, patches, kStep_s).find("error of the rotation"), std::string::npos);
  patches = good_patches;
  patches[2].surface_speed = 1e17;
  EXPECT_EQ(press(0, good, patches, kStep_s), "surface_speed = 1e+17; allowed: -1000 to 1000 m/s");
  patches = good_patches;
  patches[2].position[2] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(press(0, good, patches, kStep_s), "position = inf; allowed: within ten beds, m");
  EXPECT_EQ(state_of(soil.get()), before);
}

TEST(SoilInterface, NamesAndKeysEndWithNull) {
  size_t presets = 0;
  while (screed_soil_preset(presets) != nullptr) ++presets;
  EXPECT_EQ(presets, soil_presets().size());
  const Soil soil = make();
  size_t keys = 0;
  for (; screed_soil_key(keys) != nullptr; ++keys) {
    double value = std::nan("");
    EXPECT_EQ(screed_soil_parameter(soil.get(), screed_soil_key(keys), &value, nullptr), SCREED_OK);
    EXPECT_EQ(value, soil_preset("gravel").*kSoilParameters[keys].member);
  }
  EXPECT_EQ(keys, std::size(kSoilParameters));
}

}  // namespace
}  // namespace screed
