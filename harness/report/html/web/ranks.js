// Contenders in pairs over places: the best by error against each. The program compares them; the filter changes nothing here.

import { data } from "./data.js";
import { breakable, h, list } from "./dom.js";

/** What is read first: the program's columns in this order, then its others. */
const leading = ["technique", "against", "ratio", "verdict"];

function inReadingOrder({ columns, groups, ...ranks }) {
  const first = leading.map((name) => columns.findIndex(({ heading }) => heading === name)).filter((index) => index >= 0);
  const order = [...first, ...columns.keys()].filter((index, place, all) => all.indexOf(index) === place);
  const sorted = (cells) => order.map((index) => cells[index]);
  return { ...ranks, columns: sorted(columns), groups: groups.map((group) => ({ ...group, rows: group.rows.map(sorted) })) };
}

/** Builds the section, or removes it with its link where there are no two to compare. */
export function showRanks(section) {
  if (!data.ranks) {
    document.querySelector(`nav a[href="#${section.id}"]`).remove();
    section.remove();
    return;
  }
  const { title, columns, groups, notes } = inReadingOrder(data.ranks);
  const kind = (column) => (column.is_left ? "text" : null);
  const headings = columns.map((column) => h("th", { scope: "col", class: kind(column) }, column.heading));
  const cell = (text, index) => h("td", { class: kind(columns[index]) }, columns[index].is_left ? breakable(text) : text);
  const body = groups.map(({ heading, rows }) =>
    h(
      "tbody",
      {},
      h("tr", { class: "title" }, h("th", { scope: "rowgroup", class: "text", colspan: columns.length }, heading)),
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
