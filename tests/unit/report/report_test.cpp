#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>

#include "report/html/html_parts.h"

namespace gnomon::report_test {

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

TEST(Report, shares_of_eight_and_twelve_bits_are_off_by_half_a_step_at_most) {
  std::vector<float> shares{0, 1, 0.5f, -0.25f, 1.5f, std::numeric_limits<float>::quiet_NaN(), 0.3333f};
  for (int k = 0; k < 1000; ++k) shares.push_back(static_cast<float>(k) / 999);
  const auto taken = [&](std::size_t i) { return shares[i] > 0 ? std::min(shares[i], 1.0f) : 0.0f; };  // to 0 .. 1
  const std::vector<std::uint8_t> eight = share_bytes(shares, 8), twelve = share_bytes(shares, 12);
  ASSERT_EQ(eight.size(), shares.size());
  ASSERT_EQ(twelve.size(), shares.size() + (shares.size() + 1) / 2) << "an odd number of pixels ends with half a byte";
  for (std::size_t i = 0; i < shares.size(); ++i) {
    EXPECT_NEAR(eight[i] / 255.0, taken(i), 0.5 / 255 + 1e-6);
    const int pair = twelve[shares.size() + i / 2], low = i % 2 ? pair & 15 : pair >> 4;
    EXPECT_NEAR((16 * twelve[i] + low) / 4095.0, taken(i), 0.5 / 4095 + 1e-6) << i;
  }
}

TEST(Report, standard_errors_of_one_byte_are_off_by_three_percent_at_most) {
  std::vector<float> errors{0};
  for (double e = 1e-6; e <= 1; e *= 1.07) errors.push_back(static_cast<float>(e));
  const std::vector<std::uint8_t> bytes = error_bytes(errors);
  EXPECT_EQ(bytes[0], 0);
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(std::pow(10, 6 * (bytes[i] - 255) / 254.0) / errors[i], 1, 0.028) << errors[i];
  // What is smaller than the smallest is that, and never 0, which is exact.
  EXPECT_EQ(error_bytes(std::vector{1e-9f, 2.0f}), (std::vector<std::uint8_t>{1, 255}));
}

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

}  // namespace gnomon::report_test
