// Contenders in pairs over places: the best by error against each. The program compares them; the filter changes nothing here.

import { data } from "./data.js";
import { breakable, h, list } from "./dom.js";

/** Builds the section, or removes it with its link where there are no two to compare. */
export function showRanks(section) {
  if (!data.ranks) {
    document.querySelector(`nav a[href="#${section.id}"]`).remove();
    section.remove();
    return;
  }
  const { title, columns, groups, notes } = data.ranks;
  const kind = (column) => (column.is_left ? "text" : null);
  const headings = columns.map((column) => h("th", { scope: "col", class: kind(column) }, column.heading));
  const cell = (text, index) => h("td", { class: kind(columns[index]) }, columns[index].is_left ? breakable(text) : text);
  const body = groups.map(({ heading, rows }) =>
    h(
      "tbody",
      {},
      h("tr", { class: "group" }, h("th", { scope: "rowgroup", class: "text", colspan: columns.length }, heading)),
      rows.map((row) => h("tr", {}, row.map(cell))),
    ),
  );
  const table = h("table", {}, h("caption", { class: "hidden" }, title), h("thead", {}, h("tr", {}, headings)), body);
  section.append(
    h("p", { class: "lead" }, `${title}, of all rows of the run.`),
    h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": title }, table),
    h("div", { class: "below" }, list({}, notes)),
  );
}
