// `screed terrain generate`: height maps of made-up terrain.
#include <filesystem>
#include <iostream>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/noise_terrain.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

struct GenerateArguments {
  std::string file;
  NoiseTerrainOptions noise;
};

int generate(const GenerateArguments& arguments) {
  const std::string& file = arguments.file;
  const NoiseTerrainOptions& options = arguments.noise;
  const std::filesystem::path path(file);
  const std::string kind = path.extension().string();
  if (kind != ".png" && kind != ".bmp") {
    throw InputError(file + ": the name must end with .png (16 bit) or .bmp (8 bit)");
  }
  const GreyImage image = noise_terrain(options);
  if (kind == ".png") {
    write_grey16_png(path, image.width, image.height, image.samples);
  } else {
    write_grey8_bmp(path, image.width, image.height, image.samples);
  }
  std::cout << file << ": " << image.width << " x " << image.height << ", tileable, seed "
            << options.seed << "\n";
  return 0;
}

}  // namespace

void register_terrain_command(Command& root, Program& program) {
  Command* terrain = root.add_subcommand("terrain", "Generate height maps");
  auto [command, arguments] = add_subcommand<GenerateArguments>(
      *terrain, program, "generate",
      "Generate a tileable height map of seeded noise, for [map] edges = wrap", generate);
  NoiseTerrainOptions& options = arguments.noise;
  command.add_option("FILE", arguments.file, "Output image: 16-bit PNG or 8-bit BMP")->required();
  add_number(command, "--seed", options.seed, "Seed of the noise", kSeedRange);
  add_number(command, "--size", options.size, "Side length [samples]", {16, 4096});
  add_number(command, "--waves", options.waves, "Number of hills along a side", {1, 64});
  add_number(command, "--octaves", options.octaves, "Number of octaves", {1, 10});
  add_number(command, "--persistence", options.persistence, "Amplitude ratio of successive octaves",
             kShareRange);
}

}  // namespace screed
