// A page for each machine: what it is, its tables, its rows that are not done.
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"

namespace gnomon::site {

namespace {

std::vector<const Entry*> entries_on(const Sources& sources, std::size_t machine) {
  std::vector<const Entry*> entries;
  for (const Entry& entry : sources.entries)
    if (entry.machine == machine) entries.push_back(&entry);
  return entries;
}

std::string facts_html(std::span<const std::pair<std::string, std::string>> facts) {
  if (facts.empty()) return "";
  std::string html = "<dl class=\"facts-list\">\n";
  for (const auto& [topic, text] : facts) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_text(topic), html_text(text));
  return html + "</dl>\n";
}

/// Its rows without an answer, with why.
std::string undone_html(const std::string& from, std::span<const Entry* const> entries) {
  HtmlTable table{.caption = "Rows without an answer",
                  .heads = {{"row", "", true}, {"suite", "", true}, {"status", "", true}, {"reason", "", true}},
                  .rows = {},
                  .has_filter = true,
                  .name = "undone"};
  for (const Entry* const entry : entries)
    for (const Record& record : entry->records)
      if (record.status != Status::ok)
        table.rows.push_back({linked_cell(link_html(from, Pages::row_path(*entry, record), title(record)), title(record)),
                              text_html_cell(entry->suite), text_html_cell(name(record.status)),
                              text_html_cell(record.reason)});
  return table.rows.empty() ? "" : table.html();
}

}  // namespace

void add_machines(Pages& pages) {
  const std::string index = "machines/index.html";
  HtmlTable table{.caption = "Machines", .heads = {{"machine", "", true}, {"suites"}, {"rows"}}, .rows = {}};
  for (std::size_t k = 0; k < pages.sources.machines.size(); ++k) {
    const Machine& machine = pages.sources.machines[k];
    const std::string path = pages.machine_path(k);
    const std::vector<const Entry*> entries = entries_on(pages.sources, k);
    std::size_t rows = 0;
    for (const Entry* const entry : entries) rows += entry->records.size();
    const auto whole = [](std::size_t n) {
      return HtmlTable::Cell{.html = fmt::format("{}", n), .sort = fmt::format("{}", n)};
    };
    table.rows.push_back(
        {linked_cell(link_html(index, path, machine.title), machine.title), whole(entries.size()), whole(rows)});
    pages.folder.add({.path = path,
                      .title = machine.title,
                      .kicker = "Machine",
                      .body = section_html("tables", "Tables", entries_html(path, entries)) +
                              section_html("remarks", "What its submissions say", facts_html(machine.remarks)) +
                              section_html("facts", "The machine and the program", facts_html(machine.facts)) +
                              section_html("undone", "Rows without an answer", undone_html(path, entries))});
    std::string words;
    for (const auto& [topic, text] : machine.facts) words += fmt::format("{} {} ", topic, text);
    pages.folder.index(path, machine.title, "machine", words);
  }
  std::string differences;
  for (const std::string& suite : pages.with_differences) {
    const std::string path = Pages::differences_path(*pages.entries_of(suite).front());
    differences += fmt::format("<li>{}</li>\n", link_html(index, path, suite));
  }
  if (!differences.empty()) differences = fmt::format("<ul>\n{}</ul>\n", differences);
  pages.folder.add({.path = index,
                    .title = "Machines",
                    .body = section_html("machines", "Machines", table.html()) +
                            section_html("differences", "Differences between machines", differences)});
}

}  // namespace gnomon::site
