// The stack analysis on small hand-made images, in the words of avr-objdump.
#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/avr/stack/disassembly.h"
#include "tools/avr/stack/image_size.h"
#include "tools/avr/stack/stack_analysis.h"

namespace screed::avr_stack {
namespace {

/// Writes an image: functions one after the other, instructions as objdump prints them.
class Image {
 public:
  /// Vectors 0 (reset) to the last one; each is the address that it jumps to.
  explicit Image(const std::vector<std::uint32_t>& vectors) {
    symbol("__vectors");
    for (const std::uint32_t target : vectors) four("jmp", hex(target));
  }

  Image& symbol(const std::string& name) {
    char line[16];
    std::snprintf(line, sizeof(line), "\n%08x <", at_);
    text_ += line + name + ">:\n";
    return *this;
  }
  /// An instruction of two bytes; of four bytes.
  Image& two(const std::string& mnemonic, const std::string& operands = "") {
    return add("00 00      ", mnemonic, operands, 2);
  }
  Image& four(const std::string& mnemonic, const std::string& operands) {
    return add("00 00 00 00", mnemonic, operands, 4);
  }
  Image& call(std::uint32_t target) { return four("call", hex(target)); }
  Image& push(int times) {
    for (int i = 0; i < times; ++i) two("push", "r28");
    return *this;
  }
  Image& pop(int times) {
    for (int i = 0; i < times; ++i) two("pop", "r28");
    return *this;
  }

  StackReport report() const {
    std::istringstream in(text_);
    return analyze(Disassembly::read(in));
  }
  std::string refusal() const {
    try {
      report();
    } catch (const RunError& error) {
      return error.what();
    }
    return "accepted";
  }

 private:
  static std::string hex(std::uint32_t value) {
    char text[16];
    std::snprintf(text, sizeof(text), "0x%x", value);
    return text;
  }
  Image& add(const char* bytes, const std::string& mnemonic, const std::string& operands,
             std::uint32_t size) {
    char address[16];
    std::snprintf(address, sizeof(address), "%8x:\t", at_);
    text_ += address + std::string(bytes) + "\t" + mnemonic;
    if (!operands.empty()) text_ += "\t" + operands + "\t; a comment, 0x3d";
    text_ += "\n";
    at_ += size;
    return *this;
  }

  std::string text_;
  std::uint32_t at_ = 0;
};

/// One vector; the program begins at 4.
Image program() {
  Image image({4});
  image.symbol("main");
  return image;
}

TEST(AvrStack, CountsPushesAndReturnAddresses) {
  // main calls f, which pushes 3 and calls g, which pushes 5.
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").push(3).call(0x1e).pop(3).two("ret");
  image.symbol("g").push(5).pop(5).two("ret");
  const StackReport report = image.report();
  EXPECT_EQ(report.main.bytes, 2U + 3U + 2U + 5U);
  ASSERT_EQ(report.main.frames.size(), 3U);
  EXPECT_EQ(report.main.frames[1].name, "f");
  EXPECT_EQ(report.main.frames[1].bytes, 5U);
  EXPECT_EQ(report.main.frames[2].name, "g");
  EXPECT_EQ(report.main.frames[2].bytes, 7U);
}

TEST(AvrStack, TakesTheDeeperOfTwoBranches) {
  Image image = program();
  image.two("breq", ".+6").push(1).pop(1).two("rjmp", ".+8").push(2).pop(2).two("rjmp", ".-2");
  EXPECT_EQ(image.report().main.bytes, 2U);
}

TEST(AvrStack, FollowsSkipInstructions) {
  // sbrs may skip the four bytes of the call.
  Image image = program();
  image.two("sbrs", "r24, 7").call(0x10).two("rjmp", ".-2").two("nop").two("nop");
  image.symbol("f").push(4).pop(4).two("ret");
  EXPECT_EQ(image.report().main.bytes, 6U);
}

TEST(AvrStack, FollowsTailJumpsAndFallingThrough) {
  // f pushes 2, pops them and jumps to g; g falls into h, which pushes 7.
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").push(2).pop(2).four("jmp", "0x18");
  image.symbol("g").two("nop");
  image.symbol("h").push(7).pop(7).two("ret");
  const StackReport report = image.report();
  EXPECT_EQ(report.main.bytes, 2U + 7U);
  EXPECT_EQ(report.main.frames[1].name, "f => h");
}

TEST(AvrStack, UnderstandsFramesMadeThroughY) {
  // As gcc makes a frame of 300 bytes and drops it again.
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").push(2);
  image.two("in", "r28, 0x3d").two("in", "r29, 0x3e");
  image.two("subi", "r28, 0x2C").two("sbci", "r29, 0x01");
  image.two("in", "r0, 0x3f").two("cli").two("out", "0x3e, r29");
  image.two("out", "0x3f, r0").two("out", "0x3d, r28");
  image.two("std", "Y+1, r24").call(0x3e);
  image.two("subi", "r28, 0xD4").two("sbci", "r29, 0xFE");
  image.two("out", "0x3e, r29").two("out", "0x3d, r28");
  image.pop(2).two("ret").two("nop").two("nop").two("nop").two("nop");
  image.symbol("g").push(1).pop(1).two("ret");
  EXPECT_EQ(image.report().main.bytes, 2U + 2U + 300U + 2U + 1U);
}

TEST(AvrStack, UnderstandsSmallFrames) {
  // sbiw for up to 63 bytes; rcall to the next instruction for two bytes, push r0 for one.
  Image image = program();
  image.two("rcall", ".+0").two("push", "r0");
  image.two("in", "r28, 0x3d").two("in", "r29, 0x3e").two("sbiw", "r28, 0x3f");
  image.two("out", "0x3e, r29").two("out", "0x3d, r28").two("rjmp", ".-2");
  EXPECT_EQ(image.report().main.bytes, 3U + 63U);
}

/// f as gcc writes it with -mcall-prologues: it pushes r28 and r29 and makes a frame of 0x12c bytes
/// in a helper, and drops both in another. `way_back`: low byte of the word address after the
/// prologue.
Image shared_prologue(const char* way_back) {
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").two("ldi", "r26, 0x2C").two("ldi", "r27, 0x01");
  image.two("ldi", way_back).two("ldi", "r31, 0x00").four("jmp", "0x26");
  image.call(0x54).two("ldi", "r30, 0x02");
  image.two("subi", "r28, 0xD4").two("sbci", "r29, 0xFE").four("jmp", "0x3e");
  image.symbol("saves").two("push", "r28").two("push", "r29");
  image.two("in", "r28, 0x3d").two("in", "r29, 0x3e").two("sub", "r28, r26").two("sbc", "r29, r27");
  image.two("in", "r0, 0x3f").two("cli").two("out", "0x3e, r29").two("out", "0x3f, r0");
  image.two("out", "0x3d, r28").two("ijmp");
  image.symbol("restores").two("ldd", "r26, Y+2").two("ldd", "r27, Y+1");
  image.two("add", "r28, r30").two("adc", "r29, r1");
  image.two("in", "r0, 0x3f").two("cli").two("out", "0x3e, r29").two("out", "0x3f, r0");
  image.two("out", "0x3d, r28").two("movw", "r28, r26").two("ret");
  image.symbol("g").push(1).pop(1).two("ret");
  return image;
}

TEST(AvrStack, UnderstandsSharedPrologues) {
  EXPECT_EQ(shared_prologue("r30, 0x0C").report().main.bytes, 2U + 2U + 300U + 2U + 1U);
}

TEST(AvrStack, SharedProloguesNeedAKnownWayBack) {
  EXPECT_EQ(shared_prologue("r29, 0x0C").refusal(),
            "no stack bound: indirect call or jump at 0x3c in saves, part of f (ijmp)");
}

TEST(AvrStack, ACallForgetsTheWayBack) {
  Image image = program();
  image.two("ldi", "r30, 0x02").two("ldi", "r31, 0x00").call(0xe).two("ijmp");
  image.symbol("f").two("ret");
  EXPECT_EQ(image.refusal(), "no stack bound: indirect call or jump at 0xc in main (ijmp)");
}

TEST(AvrStack, StartUpCodeBeginsWithAnEmptyStack) {
  Image image = program();
  image.two("ldi", "r28, 0xFF").two("ldi", "r29, 0x0A").two("out", "0x3e, r29");
  image.two("out", "0x3d, r28").push(1).two("rjmp", ".-2");
  EXPECT_EQ(image.report().main.bytes, 1U);
}

TEST(AvrStack, AddsTheDeepestInterruptWithItsReturnAddress) {
  // Vector 1 is unused, 2 pushes 3, 3 pushes 4.
  Image image({0x10, 0x12, 0x16, 0x26});
  image.symbol("main").two("rjmp", ".-2");
  image.symbol("__bad_interrupt").four("jmp", "0x0");
  image.symbol("__vector_2").push(3).pop(3).two("reti").two("nop");
  image.symbol("__vector_3").push(4).pop(4).two("reti");
  const StackReport report = image.report();
  ASSERT_EQ(report.interrupts.size(), 2U);
  EXPECT_EQ(report.interrupts[0].entry, "__vector_3");
  EXPECT_EQ(report.interrupts[0].bytes, 6U);
  EXPECT_EQ(report.worst_case(), 6U);
}

TEST(AvrStack, RefusesRecursion) {
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").call(0x12).two("ret");
  image.symbol("g").call(0xc).two("ret");
  EXPECT_EQ(image.refusal(), "no stack bound: recursion into f at 0x12 in g (call 0xc)");
}

TEST(AvrStack, RefusesIndirectCallsAndJumps) {
  for (const char* what : {"icall", "ijmp"}) {
    Image image = program();
    image.two(what).two("rjmp", ".-2");
    EXPECT_EQ(image.refusal(),
              std::string("no stack bound: indirect call or jump at 0x4 in main (") + what + ")");
  }
}

TEST(AvrStack, RefusesAStackThatGrowsInALoop) {
  Image image = program();
  image.two("push", "r24").two("rjmp", ".-4");
  EXPECT_EQ(image.refusal(),
            "no stack bound: stack height differs between two paths at 0x4 in main (push r24)");
}

TEST(AvrStack, RefusesAStackPointerFromAnUnknownValue) {
  Image image = program();
  image.two("in", "r28, 0x3d").two("in", "r29, 0x3e").two("sub", "r28, r24").two("sbc", "r29, r25");
  image.two("out", "0x3e, r29").two("out", "0x3d, r28").two("rjmp", ".-2");
  EXPECT_EQ(image.refusal(),
            "no stack bound: stack pointer set to an unknown value at 0xc in main (out 0x3e, r29)");
}

TEST(AvrStack, RefusesAReturnThatLeavesBytesBehind) {
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("f").push(1).two("ret");
  EXPECT_EQ(image.refusal(), "no stack bound: return with 1 bytes on the stack at 0xe in f (ret)");
}

TEST(AvrStack, RefusesInterruptsThatNest) {
  // The function that enables interrupts is fine in main and refused in the interrupt.
  Image image({0x8, 0xe});
  image.symbol("main").call(0x14).two("rjmp", ".-2");
  image.symbol("__vector_1").call(0x14).two("reti");
  image.symbol("f").two("sei").two("ret");
  EXPECT_EQ(image.refusal(),
            "no stack bound: an interrupt that lets others interrupt it at 0x14 in f (sei)");
}

TEST(AvrStack, RefusesTextThatIsNoImage) {
  std::istringstream nothing("hello\n");
  EXPECT_THROW(Disassembly::read(nothing), InputError);
  std::istringstream no_vectors("00000000 <main>:\n   0:\tff cf       \trjmp\t.-2\t; 0x0 <main>\n");
  EXPECT_THROW(analyze(Disassembly::read(no_vectors)), InputError);
}

TEST(AvrStack, NamesAreDemangled) {
  Image image = program();
  image.call(0xc).two("rjmp", ".-2").two("nop");
  image.symbol("_ZN6screed9scale_q16Eli").push(1).pop(1).two("ret");
  EXPECT_EQ(image.report().main.frames[1].name, "screed::scale_q16(long, int)");
}

TEST(AvrStack, AddsUpSections) {
  std::istringstream in(
      "screed.elf  :\n"
      "section       size      addr\n"
      ".data           90   8388864\n"
      ".text        20910         0\n"
      ".bss             7   8388954\n"
      ".noinit          2   8388961\n"
      ".comment        17         0\n"
      "Total        21026\n");
  const ImageSize size = read_image_size(in);
  EXPECT_EQ(size.flash, 21000U);
  EXPECT_EQ(size.static_ram, 99U);
  std::istringstream nothing("Total 0\n");
  EXPECT_THROW(read_image_size(nothing), InputError);
}

}  // namespace
}  // namespace screed::avr_stack
