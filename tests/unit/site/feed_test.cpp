#include "report/site/feed.h"

#include <gtest/gtest.h>

namespace feed_test {

using namespace gnomon::site;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

constexpr const char* changes =
    "# Changes\n\n## Unreleased\n\n- **A thing** ([page](thing.md)): it is <new> & good.\n  It goes on.\n- Another one. More.\n\n## 0.1\n\n- **Old**.\n";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; ++at) ++found;
  return found;
}

TEST(Feed, has_an_entry_for_each_change_with_its_title) {
  const std::string feed = atom_feed(changes, {}, 0);
  EXPECT_EQ(count(feed, "<entry>"), 3u);
  EXPECT_TRUE(has(feed, "<title>A thing</title>")) << feed;
  EXPECT_TRUE(has(feed, "<title>Another one</title>")) << feed;
  EXPECT_TRUE(has(feed, "It goes on."));
  EXPECT_TRUE(has(feed, "<category term=\"0.1\"/>"));
  EXPECT_TRUE(has(feed, "href=&quot;docs/thing.html&quot;")) << feed;
  EXPECT_TRUE(has(feed, "<updated>1970-01-01T00:00:00Z</updated>"));
}

TEST(Feed, keeps_the_times_of_entries_that_were_there) {
  const std::string first = atom_feed(changes, {}, 86400);
  const std::string second = atom_feed(std::string(changes) + "- **New**.\n", feed_times(first), 2 * 86400);
  EXPECT_EQ(feed_times(first).size(), 3u);
  EXPECT_EQ(count(second, "<updated>1970-01-02T00:00:00Z</updated>"), 3u);
  EXPECT_EQ(count(second, "<updated>1970-01-03T00:00:00Z</updated>"), 2u);  // of the new entry and of the feed
  EXPECT_EQ(atom_feed(changes, feed_times(first), 3 * 86400), first);
}

TEST(Feed, another_text_has_no_times) {
  EXPECT_TRUE(feed_times("<html>").empty());
  EXPECT_TRUE(feed_times("<entry><id>a").empty());
}

}  // namespace feed_test
