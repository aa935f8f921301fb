// The table of all rows: sorted by any column, filtered, with columns to choose.

import { causeBar, causeLegend, occurringCauses, wrongShare } from "./causes.js";
import { columnNamed, data, isOk, isSoft, textOf } from "./data.js";
import { breakable, h } from "./dom.js";
import { filteredRows, filterBar, onFilter } from "./filter.js";

const isInterval = (column) => /_(low|high)$/.test(column.name) && columnNamed(column.name.replace(/_(low|high)$/, ""));
const withCauses = data.rows.filter((row) => row.causes);
const causesColumn = {
  name: "causes",
  heading: "causes",
  shown_unit: withCauses.some(isSoft) ? "of the error" : "of the wrong",
  is_left: true,
  is_headline: true,
  better: "lower",
  sentence:
    "Why wrong pixels are wrong: each cause's part of the wrong tested pixels, under a light with area of the error. Sorts by " +
    "the share of all tested ones.",
};

/** Columns that may be shown; intervals stand with their times, behind what rows are judged by what it is read against, then causes. */
function allColumns() {
  const columns = data.columns.filter((column) => !isInterval(column) && column.name !== "causes");
  const judged = columns.find((column) => column.name === "error" && column.is_headline);
  if (!judged) return withCauses.length > 0 ? [...columns, causesColumn] : columns;
  const floors = ["error_floor", "snapping_floor", "constant_error"].map(columnNamed).filter((column) => column?.is_headline);
  const beside = withCauses.length > 0 ? [...floors, causesColumn] : floors;
  const others = columns.filter((column) => !floors.includes(column));
  others.splice(others.indexOf(judged) + 1, 0, ...beside);
  return others;
}

const sortValue = (row, column) => (column === causesColumn ? wrongShare(row) : row.values[column.index]);

function compare(a, b) {
  return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
}

/** Rows in order; those without a value stay at the end. */
function sorted(rows, { column, descending }) {
  if (!column) return rows;
  const sign = descending ? -1 : 1;
  return [...rows].sort((p, q) => {
    const a = sortValue(p, column),
      b = sortValue(q, column);
    if (a === null || b === null) return (a === null) - (b === null) || p.index - q.index;
    return sign * compare(a, b) || p.index - q.index;
  });
}

function interval(row, column) {
  const [low, high] = ["_low", "_high"].map((end) => columnNamed(column.name + end));
  if (!low || !high || row.values[low.index] === null || row.values[high.index] === null) return null;
  const ends = [low, high].map((end) => textOf(row, end));
  return ends[0] === ends[1] ? null : h("small", { class: "interval" }, ends.join(" \u2013 "));
}

function techniqueCell(row, text, openPictures) {
  const button =
    row.pictures &&
    h(
      "button",
      {
        type: "button",
        class: "picture",
        title: "Compare its picture with the reference",
        "aria-label": `Pictures of ${row.title}`,
        onclick: () => openPictures(row),
      },
      "\u25d0",
    );
  const role = row.role === "contender" ? null : h("small", { class: "role" }, row.role);
  return h("th", { scope: "row", class: "text technique" }, h("div", {}, h("span", { class: "id" }, breakable(text)), role, button));
}

function supportCell(row, text) {
  const kind = isOk(row) ? (row.support ?? "none") : row.status;
  const pill = h("span", { class: `pill ${kind}` }, text);
  if (!row.reason || !isOk(row)) return h("td", { class: "text" }, pill);
  return h("td", { class: "text" }, h("details", { class: "why" }, h("summary", {}, pill), h("p", {}, row.reason)));
}

function cell(row, column, openPictures) {
  if (column === causesColumn) return h("td", { class: "text" }, causeBar(row));
  const text = textOf(row, column);
  if (column.name === "technique") return techniqueCell(row, text, openPictures);
  if (column.name === "support") return supportCell(row, text);
  if (row.values[column.index] === null) return h("td", { class: column.is_left ? "text null" : "null" }, text);
  const is_best = row.best.has(column.index),
    is_floored = row.floored.has(column.index),
    is_flagged = row.flagged.has(column.index);
  return h(
    "td",
    { class: [column.is_left && "text", is_best && "best", is_flagged && "flagged"].filter(Boolean).join(" ") || null },
    is_best &&
      h("span", { class: "mark", role: "img", "aria-label": "best of its group", title: "best of its group" }, "\u2605"),
    column.is_left ? breakable(text) : text,
    is_floored &&
      h("span", { class: "mark", role: "img", "aria-label": "within the reference's noise", title: "within the reference's noise of the best value" }, "\u00b0"),
    is_flagged &&
      h(
        "span",
        {
          class: "mark",
          role: "img",
          "aria-label": "too few pixels tested",
          title: "too few pixels tested: read the errors with care",
        },
        "\u2691",
      ),
    interval(row, column),
  );
}

/** Cells of a row; where a row that was not measured has nothing for columns on end, its reason stands there. */
function cells(row, columns, openPictures) {
  if (isOk(row) || !row.reason) return columns.map((column) => cell(row, column, openPictures));
  const isEmpty = (column) => column === causesColumn || row.values[column.index] === null;
  let best = { start: 0, length: 0 };
  for (let start = 0; start < columns.length;) {
    let end = start;
    while (end < columns.length && isEmpty(columns[end]) && columns[end].name !== "support") ++end;
    if (end - start > best.length) best = { start, length: end - start };
    start = Math.max(end, start + 1);
  }
  const reason = h("td", { class: "text reason", colspan: Math.max(1, best.length) }, row.reason);
  const rest = (from, to) => columns.slice(from, to).map((column) => cell(row, column, openPictures));
  if (best.length === 0) return [...rest(0, columns.length), reason];
  return [...rest(0, best.start), reason, ...rest(best.start + best.length, columns.length)];
}

function legend() {
  const marks = { best: "\u2605", floor: "\u00b0", flag: "\u2691" };
  return h(
    "ul",
    { class: "marks" },
    data.legend.map(([mark, text]) => h("li", {}, h("b", {}, marks[mark] ?? mark), " ", text)),
    h("li", {}, h("small", {}, "low \u2013 high"), " 95 % interval of the time above it"),
  );
}

/** Builds the section; `openPictures(row)` shows a row in the comparer. */
export function showTable(section, openPictures) {
  const columns = allColumns();
  const visible = new Set(columns.filter((column) => column.is_headline).map((column) => column.name));
  const order = { column: null, descending: false };

  const head = h("thead"),
    body = h("tbody");
  const table = h("table", {}, h("caption", { class: "hidden" }, "Every row of the run"), head, body);

  const sortBy = (column) => {
    const first = column.better === "higher";
    if (order.column !== column) Object.assign(order, { column, descending: first });
    else if (order.descending === first) order.descending = !first;
    else order.column = null;
    draw();
    head.querySelector(`[data-column="${CSS.escape(column.name)}"] button`)?.focus();
  };

  const headCell = (column) => {
    const is_sorted = order.column === column;
    return h(
      "th",
      {
        scope: "col",
        class: column.is_left ? "text" : null,
        "data-column": column.name,
        "data-heading": column.shown_unit ? `${column.heading} (${column.shown_unit})` : column.heading,
        "aria-sort": is_sorted ? (order.descending ? "descending" : "ascending") : null,
      },
      h(
        "button",
        { type: "button", title: column.sentence || null, onclick: () => sortBy(column) },
        h(
          "span",
          { class: "heading" },
          column.heading,
          h("span", { class: "arrow", "aria-hidden": "true" }, is_sorted ? (order.descending ? "\u25be" : "\u25b4") : ""),
        ),
        h("small", {}, column.shown_unit || "\u00a0"),
      ),
    );
  };

  function draw() {
    const shown = columns.filter((column) => visible.has(column.name));
    head.replaceChildren(h("tr", {}, shown.map(headCell)));
    let group = null;
    body.replaceChildren(
      ...sorted(filteredRows(), order).map((row) => {
        const is_new_group = !order.column && group !== null && group !== row.group;
        group = row.group;
        const names = [isOk(row) ? row.role : row.status, is_new_group && "first"].filter(Boolean).join(" ");
        return h("tr", { class: names, "data-row": row.index }, cells(row, shown, openPictures));
      }),
    );
    if (!body.firstChild)
      body.append(h("tr", {}, h("td", { class: "text nothing", colspan: shown.length || 1 }, "No row passes the filter.")));
  }

  const box = (column) => {
    const input = h("input", {
      type: "checkbox",
      name: column.name,
      checked: visible.has(column.name),
      onchange: () => (visible[input.checked ? "add" : "delete"](column.name), draw()),
    });
    return h(
      "label",
      { title: column.sentence || null },
      input,
      h("span", {}, column === causesColumn ? "causes" : column.name),
    );
  };
  section.append(
    filterBar(),
    h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of all rows" }, table),
    h(
      "div",
      { class: "below" },
      legend(),
      occurringCauses().length > 0 && causeLegend(),
      h("details", { class: "columns" }, h("summary", {}, "Choose columns"), h("div", {}, columns.map(box))),
    ),
  );
  onFilter(draw);
  draw();
}
