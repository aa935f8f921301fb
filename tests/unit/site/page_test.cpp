#include "report/site/page.h"

#include <gtest/gtest.h>

#include "measure/scratch_folder.h"
#include "report/site/html_table.h"
#include "report/site/slug.h"
#include "report/site/source.h"

namespace page_test {

using namespace gnomon;
using namespace gnomon::site;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Slug, holds_nothing_that_leaves_a_folder_or_a_page) {
  EXPECT_EQ(plain_slug("AMD EPYC, llvmpipe (LLVM 15.0.6)"), "amd-epyc-llvmpipe-llvm-15-0-6");
  EXPECT_EQ(plain_slug("../../etc/passwd"), "etc-passwd");
  EXPECT_EQ(plain_slug("<script>"), "script");
  EXPECT_EQ(plain_slug("\xff\xfe"), "x");
  EXPECT_EQ(plain_slug(std::string(500, 'a')).size(), 60u);
}

TEST(Slug, different_texts_have_different_names) {
  Slugs slugs;
  EXPECT_EQ(slugs.of("a b"), "a-b");
  EXPECT_EQ(slugs.of("a/b"), "a-b-2");
  EXPECT_EQ(slugs.of("a b"), "a-b");
  EXPECT_NE(slugs.of("index"), "index");  // it lists the others
  EXPECT_EQ(slugs.of("a-b-2"), "a-b-2-2");
}

TEST(Address, leads_from_any_depth_and_is_escaped) {
  EXPECT_EQ(root_of("index.html"), "");
  EXPECT_EQ(root_of("docs/course/README.html"), "../../");
  EXPECT_EQ(address_text("a b/\"c\".html#part"), "a%20b/%22c%22.html#part");
  EXPECT_EQ(link_html("docs/x.html", "index.html", "<b>"), "<a href=\"../index.html\">&lt;b&gt;</a>");
}

TEST(Address, says_what_a_page_shows) {
  EXPECT_EQ(state_text({{"scene", "soup:count=5"}, {"light", ""}, {"technique", "a&b"}}),
            "#?scene=soup%3Acount%3D5&technique=a%26b");
  const std::string path = "t.html" + state_text({{"scene", "a b"}});
  EXPECT_EQ(address_text(path), path);
}

TEST(Page, text_stays_text) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_page");
  Folder folder(scratch.path());
  folder.add({.path = "techniques/x.html", .title = "</title><script>bad</script>", .kicker = "<i>"});
  const std::string html = small_file(scratch.path() / "techniques/x.html", 1 << 20);
  EXPECT_FALSE(has(html, "<script>bad"));
  EXPECT_FALSE(has(html, "<i>"));
  EXPECT_TRUE(has(html, "../assets/site.js"));
  EXPECT_TRUE(has(html, "script-src 'self'"));
}

TEST(Page, what_is_found_holds_no_tag) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_page");
  Folder folder(scratch.path());
  folder.index("a.html", "</script><script>", "row", "w");
  folder.write_index();
  EXPECT_FALSE(has(small_file(scratch.path() / "assets/search.js", 1 << 20), "<"));
}

TEST(HtmlTable, escapes_captions_and_sorts_by_values) {
  HtmlTable table{.caption = "\"<", .heads = {{"<h>", "", true}, {"error", "%"}}, .rows = {}};
  table.rows.push_back({text_html_cell("<script>"), number_html_cell(share_column("error", "error"), 0.012)});
  table.rows.push_back({text_html_cell(""), number_html_cell(share_column("error", "error"), std::nullopt)});
  const std::string html = table.html();
  EXPECT_FALSE(has(html, "<script>"));
  EXPECT_FALSE(has(html, "<h>"));
  EXPECT_TRUE(has(html, "data-v=\"0.012\"")) << html;
  EXPECT_TRUE(has(html, "<td>-</td>")) << html;
}

}  // namespace page_test
