// Order of an image's functions: maps and disassemblies of small images.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tools/avr/order/image_calls.h"
#include "tools/avr/order/order_search.h"

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
