// avr_stack: flash, RAM and worst-case stack of a linked AVR image against its budget.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>

#include "host_sim/core/errors.h"
#include "tools/avr/stack/disassembly.h"
#include "tools/avr/stack/image_size.h"
#include "tools/avr/stack/stack_analysis.h"
#include "tools/command_line/program.h"

namespace {

using screed::InputError;
using screed::avr_stack::StackPath;

struct Options {
  std::string disassembly;
  std::string indirect_calls;
  std::string sizes;
  unsigned flash_budget = 28672;
  unsigned ram_budget = 2560;
  unsigned flash_spare = 0;
  unsigned ram_spare = 0;
  std::optional<unsigned> free_word;
};

constexpr unsigned kRamBegin = 0x100;

std::ifstream opened(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError("cannot read " + path);
  return in;
}

void print_path(const char* title, const StackPath& path) {
  std::printf("  %-44s %6u B\n", title, path.bytes);
  for (const auto& frame : path.frames)
    std::printf("    %6u  %s\n", frame.bytes, frame.name.c_str());
}

/// Prints one line of the budget; true when it is kept.
bool print_budget(const char* what, unsigned used, unsigned budget) {
  if (used <= budget) {
    std::printf("%-24s %6u of %6u B, %6u B to spare\n", what, used, budget, budget - used);
    return true;
  }
  std::printf("%-24s %6u of %6u B, %6u B TOO MUCH\n", what, used, budget, used - budget);
  return false;
}

/// The word of RAM that neither variables nor stack may reach; true when it stays free.
bool check_free_word(unsigned address, unsigned static_ram, unsigned stack, unsigned ram) {
  const unsigned variables_end = kRamBegin + static_ram;
  const unsigned stack_end = kRamBegin + ram - stack;
  const bool kept = variables_end <= address && stack_end >= address + 2;
  std::printf("RAM at 0x%04x %s: variables end at 0x%04x, the stack at 0x%04x\n", address,
              kept ? "stays free" : "IS USED", variables_end, stack_end);
  return kept;
}

screed::avr_stack::StackReport analyze_input(const Options& options) {
  using namespace screed::avr_stack;
  IndirectCalls indirect;
  if (!options.indirect_calls.empty()) {
    auto in = opened(options.indirect_calls);
    indirect = read_indirect_calls(in);
  }
  if (options.disassembly == "-") return analyze(Disassembly::read(std::cin), indirect);
  auto in = opened(options.disassembly);
  return analyze(Disassembly::read(in), indirect);
}

int run(const Options& options) {
  using namespace screed::avr_stack;
  const StackReport stack = analyze_input(options);
  std::printf("worst-case stack         %6u B\n", stack.worst_case());
  print_path("deepest path from reset", stack.main);
  if (!stack.interrupts.empty()) print_path("deepest interrupt", stack.interrupts.front());
  if (options.sizes.empty()) return 0;

  auto sizes = opened(options.sizes);
  const ImageSize size = read_image_size(sizes);
  std::printf("static RAM               %6u B\n", size.static_ram);
  bool flash_kept = print_budget("flash", size.flash, options.flash_budget);
  if (flash_kept && size.flash + options.flash_spare > options.flash_budget) {
    std::printf("%u B of flash must stay free\n", options.flash_spare);
    flash_kept = false;
  }
  const unsigned ram = size.static_ram + stack.worst_case();
  bool ram_kept = print_budget("static RAM and stack", ram, options.ram_budget);
  if (ram_kept && ram + options.ram_spare > options.ram_budget) {
    std::printf("%u B of RAM must stay free\n", options.ram_spare);
    ram_kept = false;
  }
  if (options.free_word) {
    ram_kept = check_free_word(*options.free_word, size.static_ram, stack.worst_case(),
                               options.ram_budget) &&
               ram_kept;
  }
  if (!flash_kept || !ram_kept) throw screed::RunError("the image is over its budget");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  screed::Command app("Worst-case stack and memory budget of a linked AVR image", "avr_stack");
  app.add_option("disassembly", options.disassembly, "Output of avr-objdump -d; -: standard input")
      ->required();
  app.add_option("--indirect-calls", options.indirect_calls,
                 "File with the targets of indirect calls, a line each: FUNCTION -> TARGET | "
                 "TARGET (or never)");
  app.add_option("--sizes", options.sizes, "Output of avr-size -A; also checks the memory budgets");
  app.add_option("--flash-budget", options.flash_budget, "Flash budget [bytes]")->show_default();
  app.add_option("--ram-budget", options.ram_budget,
                 "RAM budget of static data and stack together [bytes]")
      ->show_default();
  app.add_option("--flash-spare", options.flash_spare,
                 "Part of the flash budget that must stay free [bytes]")
      ->show_default();
  app.add_option("--ram-spare", options.ram_spare,
                 "Part of the RAM budget that must stay free [bytes]")
      ->show_default();
  app.add_option("--free-word", options.free_word,
                 "Address of two bytes of RAM that neither variables nor stack may reach");
  return screed::run_program(app, argc, argv, [&] { return run(options); });
}
