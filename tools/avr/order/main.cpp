// avr_order: in which order the functions of an image lie, so that as many calls as possible reach
// their functions with a rcall.
//
// Reads the linker's map and the disassembly of an image, and prints the sections of its functions,
// one a line, for the linker script of hal/avr/firmware.mk.
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>

#include "host_sim/core/errors.h"
#include "tools/avr/order/order_search.h"
#include "tools/command_line/program.h"

namespace {

using screed::InputError;
using screed::avr_order::FunctionOrder;
using screed::avr_order::ImageCalls;

struct Options {
  std::string map;
  std::string disassembly;
  std::uint64_t searches = 6;
  int moves = 9'000'000;
};

std::ifstream opened(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError("cannot read " + path);
  return in;
}

int run(const Options& options) {
  std::ifstream map = opened(options.map);
  std::ifstream code = opened(options.disassembly);
  ImageCalls image(screed::avr_order::read_map(map), screed::avr_stack::Disassembly::read(code));
  const FunctionOrder best = screed::avr_order::best_order(image, options.searches, options.moves);
  std::fprintf(stderr, "%zu calls between functions, %d of them long; in the new order %d\n",
               image.calls(), image.long_calls(image.order()), best.long_calls);
  for (const std::size_t section : best.sections)
    std::printf("%s\n", screed::avr_order::pattern_of(image.name(section)).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  screed::Command app("Order of an image's functions with few long calls", "avr_order");
  app.add_option("map", options.map, "Map of the linker")->required();
  app.add_option("disassembly", options.disassembly, "Output of avr-objdump -d")->required();
  app.add_option("--searches", options.searches, "Searches, of which the best counts")
      ->range(1, 1000);
  app.add_option("--moves", options.moves, "Orders tried in each")->range(1, 100'000'000);
  return screed::run_program(app, argc, argv, [&] { return run(options); });
}
