#include "report/site/site.h"

#include "measure/json.h"
#include "report/figure/figure_style.h"
#include "report/html/html_parts.h"
#include "report/site/documents.h"
#include "report/site/feed.h"
#include "report/site/site_parts.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace site {
namespace {

constexpr std::uintmax_t most_changes_bytes = 4 << 20;

void add_assets(Folder& folder) {
  const Assets all = assets();
  if (all.site.empty())
    throw Error(
        "this program was built without the scripts of the site (GNOMON_REPORT=OFF); `gnomon table` has the same numbers");
  folder.write("assets/site.css", color_variables() + std::string(all.style));
  folder.write("assets/site.js", all.site);
  folder.write("assets/report.js", all.report);
}

void add_search_page(Folder& folder) {
  folder.add(
      {.path = "search.html",
       .title = "Search",
       .body =
           "<form class=\"bar\" role=\"search\" aria-label=\"Words\" id=\"search\"><label class=\"field grows\"><span>words, all of which must "
           "occur</span><input type=\"search\" name=\"q\"></label></form>\n<p id=\"found\" role=\"status\"></p>\n<ol "
           "id=\"results\" class=\"results\"></ol>\n<noscript><p class=\"notice\">The search needs JavaScript, which is "
           "switched off here.</p></noscript>"});
}

/// All downloads, for programs.
void add_data_index(const Pages& pages) {
  Json list = Json::array();
  for (const Entry& entry : pages.sources.entries)
    list.push_back({{"suite", entry.suite},
                    {"edition_hash", entry.edition.empty() ? Json() : Json(entry.edition)},
                    {"division", entry.division.empty() ? Json() : Json(entry.division)},
                    {"machine", entry.title},
                    {"rows", entry.records.size()},
                    {"csv", fmt::format("{}.csv", entry.id)},
                    {"json", fmt::format("{}.json", entry.id)}});
  pages.folder.write("data/index.json", json_text(list, 1) + "\n");
}

std::uintmax_t bytes_in(const fs::path& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += entry.file_size();
  return bytes;
}

void add_marker(Folder& folder) {
  Json names = Json::array({site_file});
  for (const auto& entry : fs::directory_iterator(folder.stage())) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  folder.write(site_file, json_text({{"schema", site_schema}, {"entries", names}}, 1) + "\n");
}

}  // namespace

void add_home(Pages& pages, const fs::path& tree) {
  std::vector<const Entry*> entries;
  for (const Entry& entry : pages.sources.entries) entries.push_back(&entry);
  std::size_t rows = 0;
  for (const Entry* const entry : entries) rows += entry->records.size();
  const std::string path = "index.html";
  std::string more;
  if (!tree.empty())
    more = fmt::format("<ul>\n<li>{}</li>\n<li>{}</li>\n<li>{}</li>\n<li>{}</li>\n</ul>\n",
                       link_html(path, "README.html", "Two commands that run the program"),
                       link_html(path, "docs/README.html", "Documentation by what you want to do"),
                       link_html(path, "docs/changes.html", "Changes"), "<a href=\"feed.xml\">Changes as an Atom feed</a>");
  pages.folder.add(
      {.path = path,
       .title = "Gnomon",
       .kicker = "Shadow techniques side by side",
       .lead = fmt::format("<ul class=\"facts\"><li><b>{}</b><span>rows</span></li><li><b>{}</b><span>techniques</span></li>"
                           "<li><b>{}</b><span>scenes</span></li><li><b>{}</b><span>machines</span></li></ul>",
                           rows, pages.techniques.size(), pages.scenes.size(), pages.sources.machines.size()),
       .body = (tree.empty() ? "" : fmt::format("<div class=\"document\">{}</div>\n", introduction(tree))) +
               section_html("results", "Results", entries_html(path, entries)) + section_html("read", "Read on", more)});
}

}  // namespace site

SiteSummary make_site(const SiteOptions& options, const fs::path& path) {
  using namespace site;
  const Sources sources = read_sources(options.dirs);
  std::size_t rows = 0;
  for (const Entry& entry : sources.entries) rows += entry.records.size();
  Folder folder(path);
  add_assets(folder);
  Pictures pictures(folder, rows);
  Pages pages(sources, folder, pictures);
  add_differences(pages);
  add_tables(pages);
  add_suites(pages);
  add_techniques(pages, !options.tree.empty());
  add_scenes(pages);
  add_machines(pages);
  if (!options.tree.empty()) {
    add_documents(folder, options.tree);
    if (fs::exists(options.tree / "docs/changes.md"))
      folder.write("feed.xml", atom_feed(small_file(options.tree / "docs/changes.md", most_changes_bytes),
                                         feed_times(options.earlier_feed), options.now));
  }
  add_home(pages, options.tree);
  add_search_page(folder);
  add_data_index(pages);
  folder.write_index();
  add_marker(folder);
  return {.pages = folder.page_count(),
          .rows = rows,
          .machines = sources.machines.size(),
          .bytes = bytes_in(path),
          .notes = folder.notes};
}

}  // namespace gnomon
