#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <zlib.h>

#include "report/html/html_parts.h"

namespace gnomon {

namespace {

/// RFC 4648, written apart from the encoder.
std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = (bits << 6 | static_cast<unsigned>(digits.find(c))) & 0xffff;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

RC_GTEST_PROP(Report, packed_bytes_come_back, (const std::vector<std::uint8_t>& bytes)) {
  const std::string text = packed(bytes);
  RC_ASSERT(text.size() % 4 == 0u);
  const std::vector<std::uint8_t> deflated = from_base64(text);
  std::vector<std::uint8_t> inflated(bytes.size() + 1);
  uLongf size = inflated.size();
  RC_ASSERT(uncompress(inflated.data(), &size, deflated.data(), deflated.size()) == Z_OK);
  inflated.resize(size);
  RC_ASSERT(inflated == bytes);
}

TEST(Report, text_of_records_cannot_end_the_script_element) {
  const Json json = {{"label", "</script><script>alert(1)</script><!--"}, {"bad", "\xff"}};
  const std::string text = script_text(json);
  EXPECT_EQ(text.find('<'), text.npos);
  EXPECT_EQ(Json::parse(text)["label"], json["label"]);
}

TEST(Report, titles_are_text) { EXPECT_EQ(html_text("a<b & \"c\">"), "a&lt;b &amp; &quot;c&quot;&gt;"); }

TEST(Report, the_template_has_each_slot_once_and_in_order) {
  const std::string_view page = page_template();
  if (page.empty()) GTEST_SKIP() << "built without the page";
  std::size_t before = 0;
  for (const std::string_view slot : {title_slot, data_slot, pictures_slot}) {
    const std::size_t at = page.find(slot);
    ASSERT_NE(at, page.npos) << slot;
    EXPECT_EQ(page.find(slot, at + 1), page.npos) << slot;
    EXPECT_GE(at, before) << slot;
    before = at;
  }
}

}  // namespace

}  // namespace gnomon
