// Order of an image's functions: maps and disassemblies of small images.

#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/avr/order/order_search.h"
#include "tools/avr/stack/image_size.h"
#include "tools/avr/stack/stack_analysis.h"

namespace screed::avr_order {
namespace {

/// Vectors of 4 bytes, then f (3000 bytes), g (3000) and h (16), as avr-ld's map has them.
constexpr const char* kMap = R"(
Memory Configuration

.text           0x0000000000000000     0x1784
 *(.vectors)
 .vectors       0x0000000000000000        0x4 build/vectors.o
                0x0000000000000000                __vectors
 .text.f        0x0000000000000004      0xbb8 /tmp/image.ltrans0.ltrans.o
 .text._Z1gv.constprop.3
                0x0000000000000bbc      0xbb8 /tmp/image.ltrans0.ltrans.o
 .text.empty    0x0000000000001774        0x0 /tmp/image.ltrans0.ltrans.o
 .text.h        0x0000000000001774       0x10 /tmp/image.ltrans0.ltrans.o

.data           0x0000000000800100       0x20
 .data.state    0x0000000000800100       0x20 /tmp/image.ltrans0.ltrans.o
)";

/// f calls h twice, which is 6000 bytes behind it; g calls h, which is near; h calls itself.
constexpr const char* kCode = R"(
00000000 <__vectors>:
   0:	00 00 00 00	jmp	0x4

00000004 <f>:
   4:	00 00 00 00	call	0x1774
   8:	00 00 00 00	call	0x1774

00000bbc <_Z1gv.constprop.3>:
 bbc:	00 00      	rcall	.+2998

00001774 <h>:
    1774:	00 00      	rcall	.-2
    1776:	00 00      	ret
)";

std::vector<Section> sections(const std::string& map = kMap) {
  std::istringstream in(map);
  return read_map(in);
}

ImageCalls image(const std::string& map = kMap) {
  std::istringstream code(kCode);
  return {sections(map), avr_stack::Disassembly::read(code)};
}

TEST(AvrOrder, ReadsTheSectionsOfTheCode) {
  const std::vector<Section> found = sections();
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0].name, ".vectors");
  EXPECT_FALSE(found[0].movable);
  EXPECT_EQ(found[2].name, ".text._Z1gv.constprop.3");
  EXPECT_EQ(found[2].begin, 0xbbcU);
  EXPECT_EQ(found[2].size, 3000U);
  EXPECT_TRUE(found[2].movable);
  EXPECT_EQ(found[3].name, ".text.h");
}

TEST(AvrOrder, AMapWithoutCodeIsRefused) {
  EXPECT_THROW(sections("Memory Configuration\n"), InputError);
  EXPECT_THROW(image(std::string(kMap).substr(0, std::string(kMap).find(" .text.f"))), InputError);
}

TEST(AvrOrder, CountsTheCallsThatARelativeCallDoesNotReach) {
  ImageCalls calls = image();
  EXPECT_EQ(calls.calls(), 4U);  // that of the vectors too, not h's of itself
  const std::vector<std::size_t> as_it_is = calls.order();
  ASSERT_EQ(as_it_is.size(), 3U);
  EXPECT_EQ(calls.long_calls(as_it_is), 2);
  EXPECT_EQ(calls.long_calls({as_it_is[0], as_it_is[2], as_it_is[1]}), 0);
}

TEST(AvrOrder, FindsTheOrderInWhichEachCallIsShort) {
  ImageCalls calls = image();
  const FunctionOrder best = best_order(calls, 1, 200);
  EXPECT_EQ(best.long_calls, 0);
  EXPECT_EQ(calls.long_calls(best.sections), 0);
}

TEST(AvrOrder, IsNeverWorseThanTheOneItBeginsWith) {
  ImageCalls calls = image();
  const FunctionOrder same = best_order(calls, 0, 1);
  EXPECT_EQ(same.sections, calls.order());
  EXPECT_EQ(same.long_calls, 2);
}

TEST(AvrOrder, NamesSectionsWithoutTheCompilersNumbers) {
  EXPECT_EQ(pattern_of(".text._Z1gv.constprop.3"), ".text._Z1gv*");
  EXPECT_EQ(pattern_of(".text.f.isra.0.part.12"), ".text.f*");
  EXPECT_EQ(pattern_of(".text.f.cold"), ".text.f.cold");
}

}  // namespace
}  // namespace screed::avr_order

// Stack analysis of images with indirect calls whose targets are listed.

namespace screed::avr_stack {
namespace {

IndirectCalls list(const std::string& text) {
  std::istringstream in(text);
  return read_indirect_calls(in);
}

/// main calls f; f pushes 2 and calls indirectly; g pushes 5, h pushes 9.
constexpr const char* kImage = R"(
00000000 <__vectors>:
   0:	00 00 00 00	jmp	0x4

00000004 <main>:
   4:	00 00 00 00	call	0xa
   8:	00 00      	rjmp	.-2

0000000a <_Z1fv>:
   a:	00 00      	push	r28
   c:	00 00      	push	r29
   e:	00 00      	icall
  10:	00 00      	pop	r29
  12:	00 00      	pop	r28
  14:	00 00      	ret

00000016 <_Z1gi>:
  16:	00 00      	push	r2
  18:	00 00      	push	r3
  1a:	00 00      	push	r4
  1c:	00 00      	push	r5
  1e:	00 00      	push	r6
  20:	00 00      	pop	r6
  22:	00 00      	pop	r5
  24:	00 00      	pop	r4
  26:	00 00      	pop	r3
  28:	00 00      	pop	r2
  2a:	00 00      	ret

0000002c <_Z1hi.constprop.3>:
  2c:	00 00      	push	r2
  2e:	00 00      	pop	r2
  30:	00 00      	ret
)";

unsigned depth(const std::string& indirect, const std::string& image = kImage) {
  std::istringstream in(image);
  return analyze(Disassembly::read(in), list(indirect)).main.bytes;
}

std::string refusal(const std::string& indirect, const std::string& image = kImage) {
  try {
    depth(indirect, image);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST(IndirectCalls, TheDeepestListedTargetCounts) {
  EXPECT_EQ(depth("f() -> g(int)"), 2U + 2U + 2U + 5U);
  EXPECT_EQ(depth("f() -> h(int)"), 2U + 2U + 2U + 1U) << "the compiler's clone has the plain name";
  EXPECT_EQ(depth("f() -> h(int) | g(int)"), 2U + 2U + 2U + 5U);
}

TEST(IndirectCalls, NeverReachedTakesNothing) {
  EXPECT_EQ(depth("# no objects\n\n f() -> never \n"), 2U + 2U);
}

TEST(IndirectCalls, WhatIsNotListedIsRefused) {
  const std::string expected = "no stack bound: indirect call or jump at 0xe in f() (icall)";
  EXPECT_EQ(refusal(""), expected);
  EXPECT_EQ(refusal("g(int) -> h(int)"), expected);
}

TEST(IndirectCalls, AListedTargetMustExist) {
  EXPECT_EQ(refusal("f() -> k(int)"),
            "indirect calls: f() -> k(int): there is no such function in the image");
  EXPECT_EQ(refusal("f() -> _GLOBAL__*"),
            "indirect calls: f() -> _GLOBAL__*: there is no such function in the image");
}

TEST(IndirectCalls, RecursionThroughAListedTargetIsRefused) {
  EXPECT_EQ(refusal("f() -> f()"), "no stack bound: recursion into f() at 0xe in f() (icall)");
  EXPECT_EQ(refusal("f() -> _Z1*"), "no stack bound: recursion into f() at 0xe in f() (icall)");
}

TEST(IndirectCalls, AnIndirectJumpGoesOnAtItsTargets) {
  std::string image = kImage;
  image.replace(image.find("icall"), 5, "ijmp");
  // The targets return with the two bytes of f still on the stack.
  EXPECT_EQ(
      refusal("f() -> g(int)", image),
      "no stack bound: return with 2 bytes on the stack at 0x2a in g(int), part of f() (ret)");
  for (const char* push : {"push	r28", "push	r29"}) {
    image.replace(image.find(push), 8, "nop     ");
  }
  for (const char* pop : {"pop	r29", "pop	r28"}) image.replace(image.find(pop), 7, "nop    ");
  EXPECT_EQ(depth("f() -> g(int) | h(int)", image), 2U + 5U);
}

TEST(IndirectCalls, WrongLinesAreNamed) {
  const auto error = [](const std::string& text) -> std::string {
    try {
      list(text);
    } catch (const InputError& it) {
      return it.what();
    }
    return "accepted";
  };
  EXPECT_EQ(error("# fine\nf()\n"), "indirect calls, line 2: expected FUNCTION -> TARGET | TARGET");
  EXPECT_EQ(error("f() -> g()\nf() -> h()\n"),
            "indirect calls, line 2: this function is listed already");
  EXPECT_EQ(error("f() -> g() | \n"), "indirect calls, line 1: a target without a name");
}

}  // namespace
}  // namespace screed::avr_stack
