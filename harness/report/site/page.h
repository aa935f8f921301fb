#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::site {

/// Scripts and styles that the build makes from harness/report/site/web. All empty when the program was built without them
/// (GNOMON_REPORT=OFF).
struct Assets {
  std::string_view style;   ///< of every page
  std::string_view site;    ///< the script of every page: search, order and filter of tables
  std::string_view report;  ///< the script of the table of one run: the report's table, plots and ranks
};
Assets assets();

/// What a page is made of. Text is HTML already.
struct Page {
  std::string path;                       ///< in the site: "techniques/svbsp.html"
  std::string title;                      ///< text
  std::string kicker = {};                ///< a few words above the title, text
  std::string lead = {};                  ///< below it, HTML
  std::string body = {};                  ///< of `main`, HTML; links are relative to the page
  std::string parts = {};                 ///< links to parts of the page, HTML; may be empty
  std::string data = {};                  ///< for a script of its own: JSON without `<`; may be empty
  std::vector<std::string> scripts = {};  ///< beside `site`: files in assets/
};

/// The folder of a site while it is made, and what is found in it by words.
class Folder {
 public:
  explicit Folder(std::filesystem::path stage) : stage_(std::move(stage)) {}

  void add(const Page& page);
  /// Throws Error where it cannot be written.
  void write(const std::string& path, std::string_view bytes);
  /// What a search finds: an address in the site, a heading, of what kind it is, and the words.
  void index(const std::string& path, const std::string& heading, const std::string& kind, const std::string& words = "");
  /// assets/search.js: `gnomonFound([[path, heading, kind, words], ...])`.
  void write_index();

  const std::filesystem::path& stage() const { return stage_; }
  std::size_t page_count() const { return pages_; }
  std::uintmax_t bytes() const { return bytes_; }
  std::vector<std::string> notes;  ///< what the site leaves out, and why

 private:
  std::filesystem::path stage_;
  std::vector<std::string> found_;  ///< entries of the index as JSON
  std::size_t pages_ = 0;
  std::uintmax_t bytes_ = 0;
};

/// "../" as often as a page at `path` lies deep: what links to the top of the site begin with.
std::string root_of(std::string_view path);

/// `<a href="...">text</a>` from a page at `from` to a path of the site, which may end in a #part.
std::string link_html(std::string_view from, std::string_view to, std::string_view text);

/// A path with what addresses do not hold as %XX.
std::string address_text(std::string_view path);

/// The part of an address that says what a page shows: "#?technique=svbsp&scene=bunny".
std::string state_text(const std::vector<std::pair<std::string, std::string>>& state);

}  // namespace gnomon::site
