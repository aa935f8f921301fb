#include "report/site/feed.h"

#include <algorithm>
#include <span>
#include <vector>

#include "measure/scene/blob.h"
#include "report/html/html_parts.h"
#include "report/site/documents.h"
#include "report/site/markdown.h"

namespace gnomon::site {

namespace {

struct Change {
  std::string version, title, text;  ///< text: Markdown
};

/// The items of the lists, each with the heading of level two above it.
std::vector<Change> changes_in(std::string_view text) {
  std::vector<Change> changes;
  std::string version;
  bool is_item = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("## ")) version = line.substr(3);
    const bool is_new = line.starts_with("- ");
    is_item = is_new || (is_item && (line.starts_with("  ") || line.empty()));
    if (is_new) changes.push_back({version, "", ""});
    if (is_item) changes.back().text += fmt::format("{}\n", line.substr(std::min<std::size_t>(2, line.size())));
  }
  for (Change& change : changes) {
    const std::size_t begin = change.text.find("**"), end = change.text.find("**", begin + 2);
    const bool has_bold = begin == 0 && end != change.text.npos;
    change.title = has_bold ? change.text.substr(2, end - 2) : change.text.substr(0, change.text.find_first_of(".\n"));
  }
  return changes;
}

/// Text that XML may hold.
std::string xml_text(std::string_view text) {
  std::string clean;
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') clean += c;
  return html_text(clean);
}

std::string iso_text(std::time_t time) {
  std::tm parts{};
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&time, &parts));
  return text;
}

/// What is between two texts, from a place on, which moves behind it; nothing where they are not there.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end, std::size_t& at) {
  const std::size_t from = text.find(begin, at), to = from == text.npos ? from : text.find(end, from + begin.size());
  if (to == text.npos) return {};
  at = to + end.size();
  return text.substr(from + begin.size(), to - from - begin.size());
}

}  // namespace

FeedTimes feed_times(std::string_view feed) {
  FeedTimes times;
  std::size_t at = 0;
  while ((at = feed.find("<entry>", at)) != feed.npos) {
    const std::string_view id = between(feed, "<id>", "</id>", at), time = between(feed, "<updated>", "</updated>", at);
    if (!id.empty() && !time.empty()) times.emplace(id, time);
    ++at;
  }
  return times;
}

std::string atom_feed(std::string_view changes, const FeedTimes& known, std::time_t now) {
  const std::string today = iso_text(now);
  std::string entries, latest;
  for (const Change& change : changes_in(changes)) {
    const std::string id = fmt::format("tag:gnomon,2026:changes/{}", content_hash(change.text).substr(0, 16));
    const auto found = known.find(id);
    const std::string time = found == known.end() ? today : found->second;
    latest = std::max(latest, time);
    const auto link = [](const std::string& address) {
      if (address.find(':') != address.npos) return address;
      return document_place(address.starts_with("../") ? address.substr(3) : "docs/" + address);
    };
    entries += fmt::format(
        "<entry>\n<id>{}</id>\n<title>{}</title>\n<updated>{}</updated>\n<link href=\"docs/changes.html\"/>\n"
        "<category term=\"{}\"/>\n<content type=\"html\">{}</content>\n</entry>\n",
        id, xml_text(change.title), time, xml_text(change.version), xml_text(render_markdown(change.text, link).html));
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<feed xmlns=\"http://www.w3.org/2005/Atom\">\n"
      "<id>tag:gnomon,2026:changes</id>\n<title>Changes of Gnomon</title>\n<updated>{}</updated>\n"
      "<author><name>The Gnomon authors</name></author>\n<link href=\"docs/changes.html\"/>\n{}</feed>\n",
      latest.empty() ? today : latest, entries);
}

}  // namespace gnomon::site
