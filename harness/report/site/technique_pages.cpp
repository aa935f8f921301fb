// A page for each technique: errors by scene on every machine, where it is on fronts, how it grows, its best and worst
// pictures.
#include <gnomon/registry.h>

#include "analysis/growth.h"
#include "analysis/in_order.h"
#include "report/html/html_parts.h"
#include "report/site/site_parts.h"

namespace gnomon::site {

namespace {

using Rows = std::vector<std::pair<const Entry*, const Record*>>;

Rows rows_of(const Sources& sources, const std::string& technique) {
  Rows rows;
  for_each_row(sources, [&](const Entry& entry, const Record& record) {
    if (record.technique == technique) rows.emplace_back(&entry, &record);
  });
  return rows;
}

/// Rows are scenes and lights, columns machines: the error of the technique as shipped.
std::string by_scene_html(const Pages& pages, const std::string& from, const Rows& rows) {
  std::vector<std::string> machines;
  std::vector<std::pair<std::string, std::string>> places;  // and their scenes
  std::map<std::pair<std::string, std::string>, double> errors;
  for (const auto& [entry, record] : rows) {
    const std::optional<double> error = record->metric("error");
    if (!record->settings.empty() || record->status != Status::ok || !error) continue;
    const std::string machine = pages.sources.machines[entry->machine].title + division_text(*entry),
                      place = place_text(*record);
    add_once(machines, machine);
    add_once(places, {place, record->scene});
    errors.try_emplace({place, machine}, *error);
  }
  if (places.empty()) return "";
  const Column error = error_column();
  HtmlTable table{.caption = "Error by scene and machine", .heads = {{"place", "", true}}, .rows = {}, .name = "place"};
  for (const std::string& machine : machines) table.heads.push_back({machine, error.shown_unit});
  for (const auto& [place, scene] : places) {
    std::vector<HtmlTable::Cell> row{linked_cell(link_html(from, pages.scene_path(scene), place), place)};
    for (const std::string& machine : machines) {
      const auto found = errors.find({place, machine});
      row.push_back(number_html_cell(error, found == errors.end() ? std::nullopt : std::optional(found->second)));
    }
    table.rows.push_back(std::move(row));
  }
  return table.html();
}

/// Every row of the technique.
std::string rows_html(const Pages& pages, const std::string& from, const Rows& rows) {
  const Column error = error_column(), frame = frame_column(), bytes = quantity_column("bytes");
  HtmlTable table{.caption = "All rows of the technique",
                  .heads = {{"setting", "", true},
                            {"place", "", true},
                            {"suite", "", true},
                            {"machine", "", true},
                            {error.heading, error.shown_unit},
                            {"time", "ms"},
                            {bytes.heading, bytes.shown_unit},
                            {"causes", "", true}},
                  .rows = {},
                  .has_filter = true,
                  .name = "row"};
  for (const auto& [entry, record] : rows) {
    const bool is_ok = record->status == Status::ok;
    const std::optional<ValueWithInterval> cost = is_ok ? cost_of(*record, Cost::light) : std::nullopt;
    const std::string why = is_ok ? top_causes(*record) : fmt::format("{}: {}", name(record->status), record->reason);
    table.rows.push_back(
        {linked_cell(link_html(from, Pages::row_path(*entry, *record), setting_name(*record)), setting_name(*record)),
         linked_cell(link_html(from, pages.scene_path(record->scene), place_text(*record)), place_text(*record)),
         text_html_cell(entry->suite), text_html_cell(entry->title + division_text(*entry)),
         number_html_cell(error, is_ok ? record->metric("error") : std::nullopt),
         number_html_cell(frame, cost ? std::optional(cost->value) : std::nullopt, cost ? value_text(frame, *cost) : ""),
         number_html_cell(bytes, is_ok && record->bytes ? std::optional(static_cast<double>(*record->bytes)) : std::nullopt),
         text_html_cell(why)});
  }
  return table.html();
}

/// Its settings in the fields over all places.
std::string fronts_html(const Pages& pages, const std::string& from, const std::string& technique) {
  const Column error = error_column(), frame = frame_column();
  HtmlTable table{.caption = "Standing over all places",
                  .heads = {{"setting", "", true},
                            {"suite and machine", "", true},
                            {"lights", "", true},
                            {"standing", "", true},
                            {error.heading, error.shown_unit},
                            {"time", "ms"}},
                  .rows = {},
                  .name = "front"};
  for (std::size_t k = 0; k < pages.sources.entries.size(); ++k) {
    const Entry& entry = pages.sources.entries[k];
    for (const Field* const field : overall_fields(pages.fields[k])) {
      const std::vector<FrontEntry> stands = find_front(*field, better("error"));
      for (std::size_t i = 0; i < field->candidates.size(); ++i) {
        const Candidate& candidate = field->candidates[i];
        if (candidate.technique != technique) continue;
        const std::string by = stands[i].beaten_by.empty() ? "" : fmt::format(" by {}", stands[i].beaten_by);
        table.rows.push_back(
            {text_html_cell(candidate.setting),
             linked_cell(link_html(from, Pages::table_path(entry) + "#plots", full_title(entry)), full_title(entry)),
             text_html_cell(lights_text(field->answer)), text_html_cell(fmt::format("{}{}", name(stands[i].standing), by)),
             number_html_cell(error, candidate.error),
             number_html_cell(frame, candidate.cost ? std::optional(candidate.cost->value) : std::nullopt,
                              candidate.cost ? value_text(frame, *candidate.cost) : "")});
      }
    }
  }
  if (table.rows.empty()) return "";
  return paragraph("Error against the time of relight and resolve: who is on the front is beaten in both by none.") +
         table.html();
}

/// Exponents of its times in the number of triangles, where an entry has a sweep of them.
std::string growth_html(const Pages& pages, const std::string& technique) {
  const Column exponent = number_column("exponent", "", "exponent");
  HtmlTable table{.caption = "Growth with the number of triangles",
                  .heads = {{"setting", "", true},
                            {"suite and machine", "", true},
                            {"scene and light", "", true},
                            {"stage", "", true},
                            {"exponent"},
                            {"interval", "", true},
                            {"triangles from"},
                            {"to"}},
                  .rows = {},
                  .name = "growth"};
  for (const Entry& entry : pages.sources.entries) {
    std::vector<Record> own;
    std::ranges::copy_if(entry.records, std::back_inserter(own), [&](const Record& r) { return r.technique == technique; });
    std::set<std::uint64_t> triangles;
    for (const Record& r : own)
      if (r.scene_facts) triangles.insert(r.scene_facts->triangles);
    if (triangles.size() < least_points) continue;
    try {
      for (const Growth& growth : find_growth(own, "triangles").rows) {
        if (!growth.exponent) continue;
        const ValueWithInterval& e = *growth.exponent;
        const auto whole = [](double x) {
          return HtmlTable::Cell{.html = fmt::format("{:.0f}", x), .sort = fmt::format("{:.0f}", x)};
        };
        table.rows.push_back({text_html_cell(growth.setting),
                              text_html_cell(full_title(entry)),
                              text_html_cell(fmt::format("{}, {}", growth.place.scene, growth.place.light)),
                              text_html_cell(growth.stage),
                              {.html = fmt::format("{:.2f}", e.value), .sort = fmt::format("{}", e.value)},
                              text_html_cell(e.has_interval ? fmt::format("{:.2f} .. {:.2f}", e.low, e.high) : ""),
                              whole(growth.points.front().x),
                              whole(growth.points.back().x)});
      }
    } catch (const Error&) {
      // No series of these rows differs in its triangles alone.
    }
  }
  if (table.rows.empty()) return "";
  return paragraph("Time = coefficient * triangles^exponent, by least squares of logarithms.") + table.html();
}

/// The rows with pictures of the least and the greatest error, of those that are off at all where there are such.
std::string pictures_html(const Pages& pages, const std::string& from, const Rows& rows) {
  Rows shown;
  for (const auto& row : rows)
    if (row.second->status == Status::ok && row.second->metric("error") &&
        pages.pictures.of(*row.second, row.first->dir).has_any())
      shown.push_back(row);
  if (shown.empty()) return "";
  std::ranges::stable_sort(shown, {}, [](const auto& row) { return *row.second->metric("error"); });
  const Column error = error_column();
  const auto figure = [&](const auto& row, const char* which) {
    const std::string text = gnomon::shown(error, number(row.second->metric("error")));
    return figures_html(pages, from, *row.first, *row.second,
                        fmt::format("{}: {}, {}, error {} {}; {}", which,
                                    link_html(from, pages.scene_path(row.second->scene), place_text(*row.second)),
                                    html_text(setting_name(*row.second)), html_text(text), html_text(error.shown_unit),
                                    html_text(row.first->title)));
  };
  return fmt::format("<div class=\"figures\">{}{}</div>", figure(shown.front(), "best"), figure(shown.back(), "worst"));
}

/// The data sheet, of a technique that this program has.
std::string about_html(const std::string& from, const std::string& technique, bool has_documents) {
  const auto entries = registry().techniques();
  const auto found = std::ranges::find(entries, technique, &TechniqueEntry::id);
  if (found == entries.end())
    return paragraph("This program has no technique of that name: it is of a plugin, or of another program.");
  const About& about = found->about;
  std::string html = paragraph(about.summary) + "<dl class=\"facts-list\">\n";
  for (const auto& [topic, text] :
       {std::pair("source", about.source), std::pair("error", about.error), std::pair("fails", about.fails)})
    if (!std::string_view(text).empty()) html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", topic, html_text(text));
  html += "</dl>\n";
  if (has_documents)
    html += fmt::format("<p>{}</p>\n",
                        link_html(from, fmt::format("docs/techniques/{}.html", technique), "Data sheet with parameters"));
  return html;
}

std::string title_of(const std::string& technique) {
  const auto entries = registry().techniques();
  const auto found = std::ranges::find(entries, technique, &TechniqueEntry::id);
  return found == entries.end() ? "" : std::string(found->about.title);
}

void add_technique(Pages& pages, const std::string& technique, bool has_documents) {
  const std::string path = pages.technique_path(technique);
  const Rows rows = rows_of(pages.sources, technique);
  pages.folder.add({.path = path,
                    .title = technique,
                    .kicker = "Technique",
                    .lead = paragraph(title_of(technique)),
                    .body = section_html("about", "What it is", about_html(path, technique, has_documents)) +
                            section_html("scenes", "Error by scene, as shipped", by_scene_html(pages, path, rows)) +
                            section_html("pictures", "Best and worst", pictures_html(pages, path, rows)) +
                            section_html("fronts", "Over all places", fronts_html(pages, path, technique)) +
                            section_html("growth", "Growth with triangles", growth_html(pages, technique)) +
                            section_html("rows", "All rows", rows_html(pages, path, rows))});
  pages.folder.index(path, technique, "technique", title_of(technique));
}

}  // namespace

void add_techniques(Pages& pages, bool has_documents) {
  const std::string path = "techniques/index.html";
  HtmlTable table{.caption = "Techniques",
                  .heads = {{"technique", "", true}, {"title", "", true}, {"rows"}, {"machines"}},
                  .rows = {},
                  .has_filter = true};
  for (const std::string& technique : pages.techniques) {
    const Rows rows = rows_of(pages.sources, technique);
    std::set<std::size_t> machines;
    for (const auto& [entry, record] : rows) machines.insert(entry->machine);
    const auto whole = [](std::size_t n) {
      return HtmlTable::Cell{.html = fmt::format("{}", n), .sort = fmt::format("{}", n)};
    };
    table.rows.push_back({linked_cell(link_html(path, pages.technique_path(technique), technique), technique),
                          text_html_cell(title_of(technique)), whole(rows.size()), whole(machines.size())});
    add_technique(pages, technique, has_documents);
  }
  pages.folder.add({.path = path, .title = "Techniques", .body = table.html()});
}

}  // namespace gnomon::site
