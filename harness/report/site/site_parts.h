#pragma once
// Private to the site: what its pages share.
#include <functional>
#include <set>

#include "report/analysis/analysis_table.h"
#include "report/site/html_table.h"
#include "report/site/page.h"
#include "report/site/pictures.h"
#include "report/site/slug.h"
#include "report/site/source.h"

namespace gnomon::site {

/// All that pages are made from. What it refers to outlives it.
class Pages {
 public:
  Pages(const Sources& sources, Folder& folder, Pictures& pictures);

  const Sources& sources;
  Folder& folder;
  Pictures& pictures;
  /// Of each entry its fields of error against relight and resolve; none where nothing can be ranked.
  std::vector<std::vector<Field>> fields;
  std::vector<std::string> techniques, scenes, suites;  ///< in order of appearance
  std::set<std::string> with_differences;               ///< suites that have a page of differences

  std::string technique_path(const std::string& technique) const {
    return fmt::format("techniques/{}.html", technique_ids_.at(technique));
  }
  std::string scene_path(const std::string& scene) const { return fmt::format("scenes/{}.html", scene_ids_.at(scene)); }
  std::string machine_path(std::size_t machine) const { return fmt::format("machines/{}.html", sources.machines[machine].id); }
  static std::string suite_path(const Entry& entry) { return fmt::format("suites/{}.html", entry.suite_id); }
  static std::string table_path(const Entry& entry) { return fmt::format("tables/{}.html", entry.id); }
  static std::string differences_path(const Entry& entry) { return fmt::format("differences/{}.html", entry.suite_id); }
  /// A row in the table of its entry: the page filtered to it.
  static std::string row_path(const Entry& entry, const Record& record);

  std::vector<const Entry*> entries_of(const std::string& suite) const;

 private:
  std::map<std::string, std::string> technique_ids_, scene_ids_;
};

/// Calls back with each record and its entry, in the order of the sources.
void for_each_row(const Sources& sources, const std::function<void(const Entry&, const Record&)>& visit);

/// " (tuned)"; empty where the entry has no division.
std::string division_text(const Entry& entry);
/// A part of a page with a heading that links lead to.
std::string section_html(const std::string& id, const std::string& title, const std::string& html);
/// A row's pictures with what they show, for a page at `from`; empty where there are none.
std::string figures_html(const Pages& pages, const std::string& from, const Entry& entry, const Record& record,
                         const std::string& caption);
/// A paragraph of text.
std::string paragraph(std::string_view text);

Column error_column();
Column frame_column();
/// "1.23 (1.10 .. 1.35)" in the column's digits.
std::string value_text(const Column& column, const ValueWithInterval& value);

/// The table of entries: suite, machine, division, rows, links to tables and downloads.
std::string entries_html(const std::string& from, std::span<const Entry* const> entries, const std::string& name = "");

void add_home(Pages& pages, const std::filesystem::path& tree);
void add_suites(Pages& pages);
void add_tables(Pages& pages);
void add_differences(Pages& pages);
void add_techniques(Pages& pages, bool has_documents);
void add_scenes(Pages& pages);
void add_machines(Pages& pages);

}  // namespace gnomon::site
