// Stack analysis of images with indirect calls whose targets are listed.
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "host_sim/core/errors.h"
#include "tools/avr/stack/indirect_calls.h"
#include "tools/avr/stack/stack_analysis.h"

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
