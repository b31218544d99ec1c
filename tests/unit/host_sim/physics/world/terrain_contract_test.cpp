// What plant and vehicle rely on in any terrain, and that they rely on nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "paths.h"
#include "tests/step_one.h"

namespace screed {
namespace {

HeightField level(bool wrap) {
  return HeightField::from_function(25, 25, 0.025, wrap, [](double, double) { return 0.1; });
}

TerrainOptions rigid() {
  return {};
}
TerrainOptions soil() {
  TerrainOptions options;
  options.soil = soil_preset("viper");
  return options;
}
TerrainOptions particles() {
  TerrainOptions options;
  options.particles.emplace();
  return options;
}

TEST(TerrainContract, TheFactoryMakesTheKindThatTheOptionsName) {
  const std::unique_ptr<Terrain> hard = build_terrain(level(false), rigid());
  EXPECT_FALSE(hard->is_deformable());
  EXPECT_EQ(hard->hard_surface(), &hard->surface());
  EXPECT_EQ(hard->footprint_shape(), FootprintShape::kNone);

  const std::unique_ptr<Terrain> soft = build_terrain(level(false), soil());
  EXPECT_TRUE(soft->is_deformable());
  EXPECT_EQ(soft->hard_surface(), nullptr);
  EXPECT_EQ(soft->footprint_shape(), FootprintShape::kLowerSurface);

  const std::unique_ptr<Terrain> loose = build_terrain(level(false), particles());
  EXPECT_TRUE(loose->is_deformable());
  ASSERT_NE(loose->hard_surface(), nullptr);
  EXPECT_NE(loose->hard_surface(), &loose->surface());
  EXPECT_EQ(loose->footprint_shape(), FootprintShape::kSolid);
  EXPECT_GT(loose->contact_stiffness().stiffness_n_per_m, 0.0);
}

TEST(TerrainContract, BoundsAreTheBedAndSayWhatIsBeyond) {
  for (const auto& [options, open] : {std::pair{rigid(), BedEdge::kOpen},
                                      {soil(), BedEdge::kOpen},
                                      {particles(), BedEdge::kWalled}}) {
    const BedBounds edged = build_terrain(level(false), options)->bounds();
    EXPECT_EQ(edged.edge, open);
    EXPECT_DOUBLE_EQ(edged.width_m, 0.6);
    HeightField field = level(false);
    field.add_walls();
    const std::unique_ptr<Terrain> walled = build_terrain(std::move(field), options);
    EXPECT_EQ(walled->bounds().edge, BedEdge::kWalled);
    EXPECT_EQ(walled->surface().edge(), BedEdge::kWalled) << "who draws it sees them, too";
    const BedBounds wrapped = build_terrain(level(true), options)->bounds();
    EXPECT_EQ(wrapped.edge, BedEdge::kWrapped);
    EXPECT_DOUBLE_EQ(wrapped.depth_m, 0.625);
  }
}

TEST(TerrainContract, APressedBodyIsBorneUnlessTheTerrainHasItsHardSurfaceAlone) {
  for (const TerrainOptions& options : {rigid(), soil(), particles()}) {
    const std::unique_ptr<Terrain> terrain = build_terrain(level(false), options);
    SCOPED_TRACE(static_cast<int>(terrain->footprint_shape()));
    Footprint box = Footprint::box({0.1, 0.08, 0.04});
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const double top = terrain->surface().max_height_within(0.0, 0.0, 0.1);
    pose.translation().z() = top + 0.02 - 0.01;
    box.set_pose(pose);
    ContactMemory memory;
    FootprintContact contact;
    contact.footprint = &box;
    contact.memory = &memory;
    PressingBody body;
    body.centre = pose.translation();
    BodyMemory of_body;
    terrain->press(body, {&contact, 1}, 1e-4, of_body);
    terrain->end_step(1e-4);
    const bool presses = terrain->footprint_shape() != FootprintShape::kNone;
    EXPECT_EQ(contact.reaction.force.z() > 0.0, presses);
    EXPECT_EQ(contact.reaction.normal_load > 0.0, presses);
    EXPECT_EQ(terrain->balance().error(), 0);
  }
}

/// Terrain of no known kind: notes what it is asked.
class NotingTerrain final : public Terrain {
 public:
  explicit NotingTerrain(FootprintShape shape, double longest_step_s, std::vector<std::string>& log)
      : shape_(shape), longest_step_s_(longest_step_s), log_(log) {}

  const HeightField& surface() const override { return surface_; }
  bool is_deformable() const override { return true; }
  BedBounds bounds() const override { return {0.2, 0.2, BedEdge::kWrapped}; }
  FootprintShape footprint_shape() const override { return shape_; }
  double longest_step_s() const override { return longest_step_s_; }
  void press(const PressingBody& body, std::span<FootprintContact> contacts, double dt,
             BodyMemory& /*memory*/) override {
    EXPECT_GT(body.mass_kg, 0.0);
    log_.push_back("press " + std::to_string(dt));
    footprints = contacts.size();
    for (FootprintContact& contact : contacts) contact.reaction.force = lift;
  }
  void end_step(double dt) override { log_.push_back("end " + std::to_string(dt)); }

  size_t footprints = 0;
  Eigen::Vector3d lift = Eigen::Vector3d::Zero();

 private:
  FootprintShape shape_;
  double longest_step_s_;
  std::vector<std::string>& log_;
  HeightField surface_ = level(true);
};

PlantOptions in_the_air(TrackModel model) {
  PlantOptions options;
  options.starts[0].z_m = 5.0;
  options.vehicle.track_model = model;
  return options;
}

Assembly rover() {
  return import_urdf(std::string(kBoardsFolder) + "/a_star_32u4/rover5.urdf");
}

TEST(TerrainContract, APlantTakesStepsAsShortAsItsTerrainNeeds) {
  std::vector<std::string> log;
  Plant plant(std::make_unique<NotingTerrain>(FootprintShape::kSolid, 0.0003, log), rover(),
              in_the_air(TrackModel::kBelt));
  EXPECT_TRUE(log.empty());
  testing::step_one(plant, {0.0, 0.0});
  std::vector<std::string> ends = log;
  std::erase_if(ends, [](const std::string& call) { return call.starts_with("press"); });
  EXPECT_EQ(ends, std::vector<std::string>(4, "end 0.000250"));
  ASSERT_FALSE(log.empty());
  EXPECT_EQ(log.front(), "press 0.000250");
  EXPECT_EQ(log.back(), "end 0.000250");
  EXPECT_GE(std::count(log.begin(), log.end(), "press 0.000250"), 4);
}

TEST(TerrainContract, WithoutFootprintsATerrainIsNotPressed) {
  std::vector<std::string> log;
  Plant plant(std::make_unique<NotingTerrain>(FootprintShape::kNone, 1.0, log), rover(),
              in_the_air(TrackModel::kBelt));
  testing::step_one(plant, {0.0, 0.0});
  EXPECT_EQ(log, std::vector<std::string>{"end 0.001000"});
}

TEST(TerrainContract, AChainIsABandOrALinkEach) {
  const auto footprints = [](TrackModel model, FootprintShape shape) {
    std::vector<std::string> log;
    auto terrain = std::make_unique<NotingTerrain>(shape, 1.0, log);
    const NotingTerrain& noted = *terrain;
    Plant plant(std::move(terrain), rover(), in_the_air(model));
    testing::step_one(plant, {0.0, 0.0});
    return noted.footprints;
  };
  const size_t belts = footprints(TrackModel::kBelt, FootprintShape::kLowerSurface);
  EXPECT_GE(belts, 2U);
  EXPECT_EQ(footprints(TrackModel::kBelt, FootprintShape::kSolid), belts);
  EXPECT_EQ(footprints(TrackModel::kChain, FootprintShape::kLowerSurface), belts);
  EXPECT_GT(footprints(TrackModel::kChain, FootprintShape::kSolid), belts + 50U);
}

// Twice the weight on each of them, straight up: the robot rises.
TEST(TerrainContract, ReactionsActOnTheRobot) {
  std::vector<std::string> log;
  auto terrain = std::make_unique<NotingTerrain>(FootprintShape::kLowerSurface, 1.0, log);
  terrain->lift = {0.0, 0.0, 20.0};
  Plant plant(std::move(terrain), rover(), in_the_air(TrackModel::kBelt));
  for (int i = 0; i < 10; ++i) testing::step_one(plant, {0.0, 0.0});
  EXPECT_GT(plant.robot(0).vehicle().chassis().velocity.z(), 0.05);
}

// The terrain's bounds decide, not its height map.
TEST(TerrainContract, ARobotThatLeavesAWrappedBedComesBack) {
  std::vector<std::string> log;
  PlantOptions options = in_the_air(TrackModel::kBelt);
  options.starts[0].x_m = 0.35;  // beds of 0.2 m: two further
  Plant plant(std::make_unique<NotingTerrain>(FootprintShape::kNone, 1.0, log), rover(), options);
  EXPECT_NEAR(plant.robot(0).vehicle().chassis().pose.translation().x(), -0.05, 1e-12);
  EXPECT_NEAR(plant.robot(0).unwrapped_position().x(), -0.05,
              1e-12);  // the start is on the first bed
}

}  // namespace
}  // namespace screed
