// Facts and blocks in a page.
#include "host_sim/render/report/page_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

class PageFileTest : public ::testing::Test {
 protected:
  std::filesystem::path built(const std::string& text) const {
    write_text(folder_.path() / "page.html", text);
    return folder_.path() / "page.html";
  }
  TempFolder folder_;
};

TEST_F(PageFileTest, PutsFactsAndBlocksAtTheMark) {
  PageFile page;
  page.add_block("a", {});
  const std::string text = page.document(built("before <!-- data --> after"), "{\"x\":1}");
  EXPECT_EQ(text.find("before <script type=\"application/json\" id=\"facts\">{\"x\":1}</script>"),
            0U)
      << text;
  EXPECT_NE(text.find("<script type=\"text/plain\" id=\"block-a\">"), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 6), " after");
  EXPECT_THROW(page.add_block("a", {}), std::logic_error);
}

TEST_F(PageFileTest, NoFactEndsItsScript) {
  const std::string text = PageFile().document(built("<!-- data -->"), "{\"x\":\"</script><!--\"}");
  EXPECT_NE(text.find("\"\\u003c/script>\\u003c!--\""), std::string::npos) << text;
}

TEST_F(PageFileTest, SaysHowAPageIsBuiltWhereThereIsNone) {
  try {
    PageFile().document(folder_.path() / "no.html", "{}");
    FAIL() << "was written";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("make report-page"), std::string::npos);
  }
  EXPECT_THROW(PageFile().document(built("no mark"), "{}"), InputError);
}

TEST(Deflated, IsReadByZlib) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(5000);
  for (int i = 0; i < 5000; ++i) bytes.push_back(static_cast<std::uint8_t>(i * i));
  const std::vector<std::uint8_t> packed = deflated(bytes);
  EXPECT_LT(packed.size(), bytes.size());
  std::vector<std::uint8_t> back(bytes.size());
  uLongf size = back.size();
  ASSERT_EQ(uncompress(back.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(back, bytes);
}

}  // namespace
}  // namespace screed
