#include "report/site/site_parts.h"

#include "analysis/in_order.h"
#include "report/html/html_parts.h"

namespace gnomon::site {

namespace {

std::vector<Field> fields_or_none(const Entry& entry, Folder& folder) {
  try {
    return find_fields(entry.records, {});
  } catch (const Error& error) {
    folder.notes.push_back(fmt::format("no front of {}: {}", full_title(entry), error.what()));
    return {};
  }
}

/// The day of the first and the last row: "2026-11-28", "2026-11-28 .. 2026-11-30".
std::string days_of(const Entry& entry) {
  std::set<std::string> days;
  for (const Record& record : entry.records)
    if (const std::string started = context_text(record, "started"); started.size() >= 10) days.insert(started.substr(0, 10));
  if (days.empty()) return "";
  return days.size() == 1 ? *days.begin() : fmt::format("{} .. {}", *days.begin(), *days.rbegin());
}

std::size_t count(const Entry& entry, Status status) {
  return static_cast<std::size_t>(std::ranges::count(entry.records, status, &Record::status));
}

HtmlTable::Cell count_html_cell(std::size_t number) {
  return {.html = number == 0 ? "-" : fmt::format("{}", number), .sort = fmt::format("{}", number)};
}

}  // namespace

Pages::Pages(const Sources& from, Folder& into, Pictures& with) : sources(from), folder(into), pictures(with) {
  Slugs technique_slugs, scene_slugs;
  std::set<std::string> known_techniques, known_scenes;
  for_each_row(sources, [&](const Entry&, const Record& record) {
    if (known_techniques.insert(record.technique).second) techniques.push_back(record.technique);
    if (known_scenes.insert(record.scene).second) scenes.push_back(record.scene);
  });
  for (const std::string& technique : techniques) technique_ids_[technique] = technique_slugs.of(technique);
  for (const std::string& scene : scenes) scene_ids_[scene] = scene_slugs.of(scene);
  for (const Entry& entry : sources.entries) {
    add_once(suites, entry.suite);
    fields.push_back(fields_or_none(entry, folder));
  }
}

std::string Pages::row_path(const Entry& entry, const Record& record) {
  return table_path(entry) + state_text({{"scene", record.scene}, {"light", record.light}, {"technique", record.technique}});
}

std::vector<const Entry*> Pages::entries_of(const std::string& suite) const {
  std::vector<const Entry*> entries;
  for (const Entry& entry : sources.entries)
    if (entry.suite == suite) entries.push_back(&entry);
  return entries;
}

void for_each_row(const Sources& sources, const std::function<void(const Entry&, const Record&)>& visit) {
  for (const Entry& entry : sources.entries)
    for (const Record& record : entry.records) visit(entry, record);
}

std::string division_text(const Entry& entry) { return entry.division.empty() ? "" : fmt::format(" ({})", entry.division); }

std::string section_html(const std::string& id, const std::string& title, const std::string& html) {
  if (html.empty()) return "";
  return fmt::format("<section id=\"{}\" aria-labelledby=\"{}-title\"><h2 id=\"{}-title\">{}</h2>\n{}</section>\n", id, id, id,
                     html_text(title), html);
}

std::string paragraph(std::string_view text) { return text.empty() ? "" : fmt::format("<p>{}</p>\n", html_text(text)); }

std::string figures_html(const Pages& pages, const std::string& from, const Entry& entry, const Record& record,
                         const std::string& caption) {
  const RowPictures& pictures = pages.pictures.of(record, entry.dir);
  if (!pictures.has_any()) return "";
  const int width = pages.pictures.width();
  std::string html = "<figure class=\"row\">";
  const auto add = [&](const std::string& path, const char* what) {
    if (!path.empty())
      html += fmt::format("<img src=\"{}{}\" alt=\"{}: {}\" width=\"{}\" height=\"{}\" loading=\"lazy\">", root_of(from), path,
                          what, html_text(title(record)), width, record.height * width / std::max(1, record.width));
  };
  add(pictures.mask, "mask");
  add(pictures.error, "errors");
  return html + fmt::format("<figcaption>{}</figcaption></figure>\n", caption);
}

Column error_column() { return quantity_column("error"); }

Column frame_column() { return number_column("frame_ms", "ms", "relight + resolve"); }

std::string value_text(const Column& column, const ValueWithInterval& value) {
  const auto text = [&](double x) { return shown(column, {.value = x}); };
  if (!value.has_interval) return text(value.value);
  return fmt::format("{} ({} .. {})", text(value.value), text(value.low), text(value.high));
}

std::string entries_html(const std::string& from, std::span<const Entry* const> entries, const std::string& name) {
  HtmlTable table{.caption = "Suites by machine and division",
                  .heads = {{"suite", "", true},
                            {"machine", "", true},
                            {"division", "", true},
                            {"rows"},
                            {"unsupported"},
                            {"failed"},
                            {"techniques"},
                            {"places"},
                            {"day", "", true},
                            {"download", "", true}},
                  .rows = {},
                  .name = name};
  for (const Entry* const entry : entries) {
    std::set<std::string> techniques;
    std::set<Place> places;
    for (const Record& record : entry->records) {
      techniques.insert(record.technique);
      places.insert(place_of(record));
    }
    const std::string downloads = fmt::format("{} {}", link_html(from, fmt::format("data/{}.csv", entry->id), "CSV"),
                                              link_html(from, fmt::format("data/{}.json", entry->id), "JSON"));
    table.rows.push_back({linked_cell(link_html(from, Pages::suite_path(*entry), entry->suite), entry->suite),
                          linked_cell(link_html(from, Pages::table_path(*entry), entry->title), entry->title),
                          text_html_cell(entry->division), count_html_cell(entry->records.size()),
                          count_html_cell(count(*entry, Status::unsupported)), count_html_cell(count(*entry, Status::failed)),
                          count_html_cell(techniques.size()), count_html_cell(places.size()), text_html_cell(days_of(*entry)),
                          linked_cell(downloads, "")});
  }
  return table.html();
}

}  // namespace gnomon::site
