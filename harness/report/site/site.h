#pragma once
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace gnomon {

struct SiteOptions {
  std::vector<std::filesystem::path> dirs;  ///< of runs, kept results and submissions
  /// The source tree whose documentation and changes are part of the site; empty: none.
  std::filesystem::path tree;
  std::string earlier_feed;  ///< text of feed.xml of the site that this one replaces; empty: none
  std::time_t now = 0;       ///< when entries of the feed are new
};

struct SiteSummary {
  std::size_t pages = 0, rows = 0, machines = 0;
  std::uintmax_t bytes = 0;        ///< of all files
  std::vector<std::string> notes;  ///< what the site leaves out, and why
};

/// Writes static pages into an empty folder. They need no server and no other file. Throws Error where input is bad (see
/// read_sources), and when the program was built without the pages' scripts (GNOMON_REPORT=OFF).
SiteSummary make_site(const SiteOptions& options, const std::filesystem::path& folder);

/// site.json, which says that a folder is a site, and what is in it: {"schema": "gnomon-site-1", "entries": [names]}.
inline constexpr const char* site_file = "site.json";
inline constexpr const char* site_schema = "gnomon-site-1";

}  // namespace gnomon
