// A page for each entry, with the table, plots and ranks of the report, and its downloads.
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"

namespace gnomon::site {

namespace {

/// Columns of the page: those of parameters, counts, classes and of each truth are in the downloads alone.
std::vector<std::string> page_columns(std::span<const Record> records) {
  std::vector<std::string> names = column_names(records);
  std::erase_if(names, [](const std::string& name) { return name.find('.') != name.npos; });
  return names;
}

/// The table for programs, without values that a row does not have: these are most of them.
std::string json_download(std::span<const Record> records) {
  Json table = parse_json(render_table(records, Format::json));
  for (Json& row : table["rows"]) {
    Json filled = json_object();
    for (auto& [name, value] : row.items())
      if (!value.is_null()) filled[name] = std::move(value);
    row = std::move(filled);
  }
  return json_text(table) + "\n";
}

/// What the report's script shows: the numbers of the run, without pictures, and where scenes and techniques have their pages.
Json data_of(const Pages& pages, const Entry& entry) {
  const Layout layout = lay_out(entry.records, page_columns(entry.records));
  Json data = report_data(layout, entry.records);
  data["title"] = full_title(entry);
  data["notes"] = Json::array();
  for (const auto& [key, list, path] : {std::tuple("techniques", &Record::technique, &Pages::technique_path),
                                        std::tuple("scenes", &Record::scene, &Pages::scene_path)}) {
    Json& links = data["links"][key] = json_object();
    for (const Record& record : entry.records) links[record.*list] = "../" + address_text((pages.*path)(record.*list));
  }
  return data;
}

void add_table(Pages& pages, const Entry& entry) {
  const std::string path = Pages::table_path(entry);
  const std::string csv = fmt::format("data/{}.csv", entry.id), json = fmt::format("data/{}.json", entry.id);
  pages.folder.write(csv, render_table(entry.records, Format::csv));
  pages.folder.write(json, json_download(entry.records));
  const std::string lead = fmt::format("<p class=\"machine\">Suite {} on {}{}. Download {} or {}.</p>",
                                       link_html(path, Pages::suite_path(entry), entry.suite),
                                       link_html(path, pages.machine_path(entry.machine), entry.title),
                                       entry.division.empty() ? "" : html_text(fmt::format(", division {}", entry.division)),
                                       link_html(path, csv, "CSV"), link_html(path, json, "JSON"));
  std::string body =
      "<noscript><p class=\"notice\">This table draws itself with JavaScript, which is switched off here. The downloads have the same numbers.</p></noscript>\n";
  std::string parts;
  for (const auto& [id, title] :
       {std::pair("table", "Table"), std::pair("plots", "Plots"), std::pair("ranks", "Ranks"), std::pair("about", "About")}) {
    body += fmt::format("<section id=\"{}\" aria-labelledby=\"{}-title\"><h2 id=\"{}-title\">{}</h2></section>\n", id, id, id,
                        title);
    parts += fmt::format("<a href=\"#{}\">{}</a>\n", id, title);
  }
  pages.folder.add({.path = path,
                    .title = full_title(entry),
                    .kicker = "Table",
                    .lead = lead,
                    .body = body,
                    .parts = parts,
                    .data = script_text(data_of(pages, entry)),
                    .scripts = {"report.js"}});
  pages.folder.index(path, full_title(entry), "table");
  for (const Record& record : entry.records)
    pages.folder.index(Pages::row_path(entry, record), fmt::format("{} on {}", title(record), entry.title), "row",
                       fmt::format("{} {}", record.reason, top_causes(record)));
}

}  // namespace

void add_tables(Pages& pages) {
  for (const Entry& entry : pages.sources.entries) add_table(pages, entry);
}

}  // namespace gnomon::site
