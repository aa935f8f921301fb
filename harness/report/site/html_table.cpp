#include "report/site/html_table.h"

#include "report/html/html_parts.h"
#include "report/table/digits.h"

namespace gnomon::site {

namespace {

std::string head_html(const HtmlTable::Head& head) {
  const std::string unit = head.unit.empty() ? "" : fmt::format(" <small>{}</small>", html_text(head.unit));
  return fmt::format("<th scope=\"col\"{}>{}{}</th>", head.is_left ? " class=\"text\"" : "", html_text(head.text), unit);
}

std::string cell_html(const HtmlTable::Cell& cell, bool is_first) {
  const char* const tag = is_first ? "th" : "td";
  return fmt::format("<{}{}{}{}>{}</{}>", tag, is_first ? " scope=\"row\"" : "", cell.is_left ? " class=\"text\"" : "",
                     cell.sort.empty() ? "" : fmt::format(" data-v=\"{}\"", html_text(cell.sort)), cell.html, tag);
}

/// Of a layout's group headings and cells as people read them.
std::string group_html(const Layout& layout, const Layout::Group& group) {
  std::string html = "<tbody>\n", cells;
  std::size_t columns = 0;
  for (const Column& column : layout.columns) columns += column.audience != Audience::programs;
  if (!group.heading.empty())
    html += fmt::format("<tr class=\"group\"><th scope=\"rowgroup\" class=\"text\" colspan=\"{}\">{}</th></tr>\n", columns,
                        html_text(group.heading));
  for (const Layout::Row& row : group.rows) {
    html += "<tr>";
    bool is_first = true;
    for (std::size_t k = 0; k < layout.columns.size(); ++k) {
      const Column& column = layout.columns[k];
      if (column.audience == Audience::programs) continue;
      html += cell_html({.html = html_text(shown(column, row.cells[k])), .is_left = column.alignment == Align::left},
                        std::exchange(is_first, false));
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n";
}

std::string scrolled(const std::string& table, const std::string& caption) {
  return fmt::format("<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{}\">\n{}</div>\n", html_text(caption),
                     table);
}

}  // namespace

std::string HtmlTable::html() const {
  std::string html = fmt::format("<table class=\"sortable\"{}{}>\n<caption class=\"hidden\">{}</caption>\n<thead><tr>",
                                 has_filter ? " data-filter" : "", name.empty() ? "" : fmt::format(" data-name=\"{}\"", name),
                                 html_text(caption));
  for (const Head& head : heads) html += head_html(head);
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<Cell>& row : rows) {
    html += "<tr>";
    for (std::size_t k = 0; k < row.size(); ++k) html += cell_html(row[k], k == 0);
    html += "</tr>\n";
  }
  return scrolled(html + "</tbody>\n</table>\n", caption);
}

HtmlTable::Cell text_html_cell(std::string_view text) {
  return {.html = text.empty() ? "-" : html_text(text), .sort = std::string(text), .is_left = true};
}

HtmlTable::Cell linked_cell(std::string html, std::string_view sort) {
  return {.html = std::move(html), .sort = std::string(sort), .is_left = true};
}

HtmlTable::Cell number_html_cell(const Column& column, const std::optional<double>& value, const std::string& title) {
  const std::string text = html_text(shown(column, number(value)));
  return {.html = title.empty() ? text : fmt::format("<span title=\"{}\">{}</span>", html_text(title), text),
          .sort = value ? exact(*value) : ""};
}

std::string layout_html(const Layout& layout) {
  std::string html = fmt::format("<table>\n<caption class=\"hidden\">{}</caption>\n<thead><tr>", html_text(layout.title));
  for (const Column& column : layout.columns)
    if (column.audience != Audience::programs)
      html += head_html({.text = column.heading, .unit = column.shown_unit, .is_left = column.alignment == Align::left});
  html += "</tr></thead>\n";
  for (const Layout::Group& group : layout.groups) html += group_html(layout, group);
  html = scrolled(html + "</table>\n", layout.title);
  if (layout.notes.empty()) return html;
  html += "<ul class=\"below\">\n";
  for (const std::string& note : layout.notes) html += fmt::format("<li>{}</li>\n", html_text(note));
  return html + "</ul>\n";
}

}  // namespace gnomon::site
