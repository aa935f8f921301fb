#include "report/site/markdown.h"

#include <gtest/gtest.h>

namespace markdown_test {

using namespace gnomon::site;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string as_written(const std::string& address) { return address; }

RenderedPage render(std::string_view text) { return render_markdown(text, as_written); }

TEST(Markdown, headings_have_the_names_that_links_use) {
  EXPECT_EQ(heading_id("The way of a pixel"), "the-way-of-a-pixel");
  EXPECT_EQ(heading_id("What is `--out`?"), "what-is---out");
  EXPECT_EQ(heading_id("Caf\u00e9 1, 2"), "caf\u00e9-1-2");
  const RenderedPage page = render("# A page\n\nFirst.\n\n## Same\n\n## Same\n");
  EXPECT_EQ(page.title, "A page");
  ASSERT_EQ(page.sections.size(), 4u);
  EXPECT_EQ(page.sections[2].id, "same");
  EXPECT_EQ(page.sections[3].id, "same-1");
  EXPECT_TRUE(has(page.html, "id=\"same-1\"")) << page.html;
}

TEST(Markdown, words_of_sections_are_found_and_those_of_code_blocks_are_not) {
  const RenderedPage page =
      render("# T\n\none `two`\nthree\n\n- four\n\n```\nfive\n```\n\n| a | b |\n|---|---|\n| six | seven |\n");
  const std::string& text = page.sections[1].text;
  for (const char* const word : {"one ", "two ", "three ", "four ", "six "})
    EXPECT_TRUE(has(text + " ", word)) << word << ": " << text;
  EXPECT_FALSE(has(text, "five"));
  EXPECT_FALSE(has(text, "sixseven"));
}

TEST(Markdown, html_and_addresses_that_run_something_are_left_out) {
  const RenderedPage page = render(
      "# <script>alert(1)</script> T\n\n<!-- a note -->\n\n<img src=x onerror=alert(2)>\n\n[a](javascript:alert(3)) `<script>`\n");
  EXPECT_FALSE(has(page.html, "<script")) << page.html;
  EXPECT_FALSE(has(page.html, "onerror"));
  EXPECT_FALSE(has(page.html, "a note"));
  EXPECT_FALSE(has(page.html, "javascript:"));
  EXPECT_TRUE(has(page.html, "&lt;script&gt;")) << page.html;
}

TEST(Markdown, links_and_pictures_lead_where_they_are_sent) {
  const auto link = [](const std::string& address) { return "to/" + address; };
  const RenderedPage page = render_markdown("[a](b.md#c) ![p](q.png)", link);
  EXPECT_TRUE(has(page.html, "href=\"to/b.md#c\"")) << page.html;
  EXPECT_TRUE(has(page.html, "src=\"to/q.png\"")) << page.html;
}

TEST(Markdown, tables_scroll_by_themselves_and_text_cannot_open_one) {
  const RenderedPage page = render("| a | b |\n|---|--:|\n| 1 | 2 |\n\n`<table>`\n");
  EXPECT_TRUE(has(page.html, "<div class=\"wide\"")) << page.html;
  EXPECT_EQ(page.html.find("<table>"), page.html.rfind("<table>"));
  EXPECT_TRUE(has(page.html, "align=\"right\"") && has(page.html, "<td class=r>")) << page.html;
}

TEST(Markdown, bytes_that_are_no_utf8_are_replaced) { EXPECT_TRUE(has(render("a \xff b").html, "\xef\xbf\xbd")); }

}  // namespace markdown_test
