// Where the images under test are; the paths come from the build (mcu_tests.mk).
#pragma once

namespace screed::mcu {

constexpr const char* kScreedImage = SCREED_IMAGE_FOLDER "/screed.elf";
/// Built with NODE=3.
constexpr int kOtherNode = 3;
constexpr const char* kOtherNodeImage = SCREED_IMAGE_FOLDER "_node_3/screed.elf";
constexpr const char* kScreedListing = SCREED_IMAGE_FOLDER "/screed.lst";
constexpr const char* kScreedSizes = SCREED_IMAGE_FOLDER "/screed.size";
constexpr const char* kWiring = SCREED_WIRING;
constexpr const char* kGoldenImage = SCREED_IMAGE_FOLDER "/golden.elf";
constexpr const char* kNetworkImage = SCREED_IMAGE_FOLDER "/network.elf";
constexpr const char* kModelImage = SCREED_IMAGE_FOLDER "/model.elf";
constexpr const char* kRobotImage = SCREED_IMAGE_FOLDER "/robot.elf";

}  // namespace screed::mcu
