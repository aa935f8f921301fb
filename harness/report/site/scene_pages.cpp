// A page for each scene, with what every technique made of it: masks and pictures of errors, from right to wrong.
#include "analysis/in_order.h"
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"

namespace gnomon::site {

namespace {

using Row = std::pair<const Entry*, const Record*>;

double error_or_last(const Record& record) { return record.metric("error").value_or(std::numeric_limits<double>::infinity()); }

/// Rows with equal pictures are one figure that names their machines.
std::string gallery_html(const Pages& pages, const std::string& from, std::span<const Row> rows) {
  struct Figure {
    Row row;
    std::vector<std::string> machines;
  };
  std::vector<std::pair<std::string, Figure>> figures;
  for (const Row& row : rows) {
    const RowPictures& pictures = pages.pictures.of(*row.second, row.first->dir);
    if (!pictures.has_any()) continue;
    Figure& figure = value_of_key(figures, setting_name(*row.second) + "\n" + pictures.mask + "\n" + pictures.error);
    if (figure.machines.empty()) figure.row = row;
    add_once(figure.machines, row.first->title + division_text(*row.first));
  }
  std::string html;
  const Column error = error_column();
  for (const auto& [key, figure] : figures) {
    const Record& record = *figure.row.second;
    html += figures_html(
        pages, from, *figure.row.first, record,
        fmt::format("{}, error {} {}; {}", link_html(from, pages.technique_path(record.technique), setting_name(record)),
                    html_text(shown(error, number(record.metric("error")))), html_text(error.shown_unit),
                    html_text(joined(figure.machines, "; "))));
  }
  return html.empty() ? "" : fmt::format("<div class=\"figures\">\n{}</div>\n", html);
}

std::string table_html(const std::string& from, std::span<const Row> rows, const std::string& name) {
  const Column error = error_column(), frame = frame_column();
  HtmlTable table{.caption = "Rows of this place",
                  .heads = {{"technique", "", true},
                            {"suite", "", true},
                            {"machine", "", true},
                            {error.heading, error.shown_unit},
                            {"time", "ms"},
                            {"causes", "", true}},
                  .rows = {},
                  .name = name};
  for (const auto& [entry, record] : rows) {
    const bool is_ok = record->status == Status::ok;
    const std::optional<ValueWithInterval> cost = is_ok ? cost_of(*record, Cost::light) : std::nullopt;
    table.rows.push_back(
        {linked_cell(link_html(from, Pages::row_path(*entry, *record), setting_name(*record)), setting_name(*record)),
         text_html_cell(entry->suite), text_html_cell(entry->title + division_text(*entry)),
         number_html_cell(error, is_ok ? record->metric("error") : std::nullopt),
         number_html_cell(frame, cost ? std::optional(cost->value) : std::nullopt, cost ? value_text(frame, *cost) : ""),
         text_html_cell(is_ok ? top_causes(*record) : fmt::format("{}: {}", gnomon::name(record->status), record->reason))});
  }
  return table.html();
}

void add_scene(Pages& pages, const std::string& scene) {
  const std::string path = pages.scene_path(scene);
  std::vector<std::pair<std::string, std::vector<Row>>> places;
  for_each_row(pages.sources, [&](const Entry& entry, const Record& record) {
    if (record.scene == scene) value_of_key(places, place_text(record)).emplace_back(&entry, &record);
  });
  std::string body, parts;
  for (std::size_t k = 0; k < places.size(); ++k) {
    auto& [place, rows] = places[k];
    std::ranges::stable_sort(rows, {}, [](const Row& row) { return error_or_last(*row.second); });
    const std::string id = fmt::format("place-{}", k + 1);
    const std::string gallery = gallery_html(pages, path, rows);
    const std::string table = table_html(path, rows, fmt::format("p{}", k + 1));
    body += section_html(
        id, place,
        gallery.empty()
            ? table
            : fmt::format("<details open><summary>Pictures, from right to wrong</summary>\n{}</details>\n{}", gallery, table));
    parts += fmt::format("<a href=\"#{}\">{}</a>\n", id, html_text(place));
  }
  const auto& facts = places.front().second.front().second->scene_facts;
  std::string lead = facts ? paragraph(fmt::format("{} meshes, {} triangles, {}", facts->meshes, facts->triangles,
                                                   facts->closed ? "closed" : "with open edges"))
                           : "";
  pages.folder.add(
      {.path = path,
       .title = scene,
       .kicker = "Scene",
       .lead = lead,
       .body = fmt::format("<details class=\"contents\"><summary>Places</summary>\n{}</details>\n{}", parts, body)});
  pages.folder.index(path, scene, "scene");
}

}  // namespace

void add_scenes(Pages& pages) {
  const std::string path = "scenes/index.html";
  HtmlTable table{.caption = "Scenes", .heads = {{"scene", "", true}, {"rows"}, {"triangles"}}, .rows = {}, .has_filter = true};
  for (const std::string& scene : pages.scenes) {
    std::size_t rows = 0;
    std::optional<double> triangles;
    for_each_row(pages.sources, [&](const Entry&, const Record& record) {
      if (record.scene != scene) return;
      ++rows;
      if (record.scene_facts) triangles = static_cast<double>(record.scene_facts->triangles);
    });
    table.rows.push_back({linked_cell(link_html(path, pages.scene_path(scene), scene), scene),
                          {.html = fmt::format("{}", rows), .sort = fmt::format("{}", rows)},
                          number_html_cell(whole_column("triangles", "", "triangles"), triangles)});
    add_scene(pages, scene);
  }
  pages.folder.add({.path = path, .title = "Scenes", .body = table.html()});
}

}  // namespace gnomon::site
