// A page for each suite or edition: its entries, and every setting over all places, machine beside machine.
#include "analysis/in_order.h"
#include "measure/edition/edition.h"
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"

namespace gnomon::site {

namespace {

/// A field over all places and the entry that it is of.
struct Overall {
  const Entry* entry = nullptr;
  const Field* field = nullptr;
};

std::vector<Overall> overall_of(const Pages& pages, const std::string& suite, AnswerKind answer) {
  std::vector<Overall> all;
  for (std::size_t k = 0; k < pages.sources.entries.size(); ++k) {
    const Entry& entry = pages.sources.entries[k];
    if (entry.suite != suite) continue;
    for (const Field* const field : overall_fields(pages.fields[k]))
      if (field->answer == answer) all.push_back({&entry, field});
  }
  return all;
}

/// Rows are settings, columns error and time of each entry.
HtmlTable table_of(const Pages& pages, const std::string& from, std::span<const Overall> all, std::string name) {
  HtmlTable table{.caption = "Settings over all places, by machine",
                  .heads = {{"technique", "", true}},
                  .rows = {},
                  .has_filter = true,
                  .name = std::move(name)};
  const Column error = error_column(), frame = frame_column();
  std::vector<std::pair<std::string, std::string>> settings;  // and their techniques
  for (const auto& [entry, field] : all) {
    const std::string who = all.size() > 1 ? fmt::format(", {}{}", entry->title, division_text(*entry)) : "";
    table.heads.push_back({error.heading + who, error.shown_unit});
    table.heads.push_back({"time" + who, frame.shown_unit});
    for (const Candidate& candidate : field->candidates) add_once(settings, {candidate.setting, candidate.technique});
  }
  for (const auto& [setting, technique] : settings) {
    std::vector<HtmlTable::Cell> row{linked_cell(link_html(from, pages.technique_path(technique), setting), setting)};
    for (const auto& [entry, field] : all) {
      const auto found = std::ranges::find(field->candidates, setting, &Candidate::setting);
      const bool is_there = found != field->candidates.end();
      row.push_back(number_html_cell(error, is_there ? std::optional(found->error) : std::nullopt));
      const bool has_cost = is_there && found->cost;
      row.push_back(number_html_cell(frame, has_cost ? std::optional(found->cost->value) : std::nullopt,
                                     has_cost ? value_text(frame, *found->cost) : ""));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string overall_html(const Pages& pages, const std::string& from, const std::string& suite) {
  std::string html;
  for (const AnswerKind answer : {AnswerKind::binary, AnswerKind::fraction, AnswerKind::received, AnswerKind::transmitted}) {
    const std::vector<Overall> all = overall_of(pages, suite, answer);
    if (all.empty()) continue;
    const std::string kind(name(answer));
    html += fmt::format("<h3>{}</h3>\n", html_text(lights_text(answer)));
    html += table_of(pages, from, all, kind).html();
    for (const auto& [entry, field] : all)
      html +=
          paragraph(fmt::format("{}{}: mean error and geometric mean time over {} of {} places that these settings finished.",
                                entry->title, division_text(*entry), field->places, field->all_places));
  }
  return html;
}

/// What this program knows of an edition with one of the hashes: the errata, each with all that it says.
std::string errata_html(const std::string& suite, std::span<const std::string> hashes) {
  std::string html;
  for (const std::string& name : edition_names()) {
    if (suite != "edition " + name) continue;
    const Edition edition = read_edition(name);
    if (std::ranges::find(hashes, edition.hash) == hashes.end()) continue;
    for (const Erratum& erratum : edition.errata)
      html += fmt::format("<li><code>{}</code>{}, from version {}: {}</li>\n", html_text(erratum.technique),
                          erratum.rows.empty() ? "" : fmt::format(" (<code>{}</code>)", html_text(erratum.rows)),
                          html_text(erratum.version), html_text(erratum.reason));
  }
  return html.empty() ? "" : section_html("errata", "Errata", fmt::format("<ul>\n{}</ul>\n", html));
}

void add_suite(Pages& pages, const std::string& suite) {
  const std::vector<const Entry*> entries = pages.entries_of(suite);
  const Entry& first = *entries.front();
  const std::string path = Pages::suite_path(first);
  std::string lead;
  std::vector<std::string> hashes;
  for (const Entry* const entry : entries)
    if (!entry->edition.empty()) add_once(hashes, entry->edition);
  if (!hashes.empty()) lead = paragraph(fmt::format("Hash of the edition: {}", joined(hashes, ", ")));
  if (pages.with_differences.contains(suite))
    lead += fmt::format("<p>{}</p>", link_html(path, Pages::differences_path(first), "Differences between machines"));
  std::string fronts;
  for (const Entry* const entry : entries)
    fronts += fmt::format("<li>{}</li>\n", link_html(path, Pages::table_path(*entry) + "#plots", full_title(*entry)));
  pages.folder.add({.path = path,
                    .title = suite,
                    .kicker = first.edition.empty() ? "Suite" : "Edition",
                    .lead = lead,
                    .body = section_html("machines", "By machine and division", entries_html(path, entries)) +
                            section_html("overall", "Over all places", overall_html(pages, path, suite)) +
                            section_html("fronts", "Error against time",
                                         paragraph("The plots of each table join the settings that no other beats in both:") +
                                             fmt::format("<ul>\n{}</ul>\n", fronts)) +
                            errata_html(suite, hashes)});
  pages.folder.index(path, suite, "suite");
}

}  // namespace

void add_suites(Pages& pages) {
  for (const std::string& suite : pages.suites) add_suite(pages, suite);
}

}  // namespace gnomon::site
