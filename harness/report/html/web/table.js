// The table of all rows: sorted by any column, filtered, with columns to choose.

import { causeBar, causeLegend, occurringCauses, wrongShare } from "./causes.js";
import { columnNamed, data, isOk, isSoft, joined, textOf } from "./data.js";
import { breakable, h, plural } from "./dom.js";
import { filteredRows, filterBar, onFilter } from "./filter.js";
import { onRecall, recalled, remember } from "./page_state.js";
import { tableText } from "./table_text.js";

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

/** Rows that are drawn at once. */
const batch = 300;

/** Columns that stay in sight when the table is scrolled sideways: which row this is. */
const staying = ["scene", "light", "technique"];

/**
 * Columns that may be shown: first those that say which row this is, then its error, the causes, and the error's floors.
 * Intervals are in the cells of their times.
 */
function allColumns() {
  const columns = data.columns.filter((column) => !isInterval(column) && column.name !== "causes");
  const named = (names) => names.map((name) => columns.find((column) => column.name === name)).filter(Boolean);
  const [error, floors] = [["error"], ["error_floor", "snapping_floor", "constant_error"]].map((names) =>
    named(names).filter((column) => column.is_headline),
  );
  const first = [...named(staying), ...error, ...(withCauses.length > 0 ? [causesColumn] : []), ...floors];
  return [...first, ...columns.filter((column) => !first.includes(column))];
}

const sortValue = (row, column) => (column === causesColumn ? wrongShare(row) : row.values[column.index]);

function compare(a, b) {
  return typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
}

/** Rows in order; those without a value are at the end. */
function sorted(rows, { column, descending }) {
  if (!column) return rows;
  const sign = descending ? -1 : 1;
  return [...rows].sort((p, q) => {
    const a = sortValue(p, column);
    const b = sortValue(q, column);
    if (a === null || b === null) return (a === null) - (b === null) || p.index - q.index;
    return sign * compare(a, b) || p.index - q.index;
  });
}

function interval(row, column) {
  const ends = ["_low", "_high"].map((end) => columnNamed(column.name + end));
  if (ends.some((end) => !end || row.values[end.index] === null)) return null;
  const [low, high] = ends.map((end) => textOf(row, end));
  return low === high ? null : h("small", { class: "interval" }, `${low} \u2013 ${high}`);
}

/** A name, in a site with a link to its page. */
function named(key, name, text) {
  const href = data.links?.[key]?.[name];
  return href ? h("a", { href }, breakable(text)) : breakable(text);
}

function techniqueCell(row, text, openPictures) {
  const title = "Compare its picture with the reference";
  const act = { type: "button", onclick: () => openPictures(row) };
  const button = h("button", { class: "picture", title, "aria-label": `Pictures of ${row.title}`, ...act }, "\u25d0");
  const id = h("span", { class: "id" }, named("techniques", row.technique, text));
  const role = row.role !== "contender" && h("small", { class: "role" }, row.role);
  return h("th", { scope: "row", class: "text technique stays", "data-stays": "technique" }, h("div", {}, id, role, row.pictures && button));
}

function supportCell(row, text) {
  const kind = isOk(row) ? (row.support ?? "none") : row.status;
  const pill = h("span", { class: `pill ${kind}` }, text);
  const why = () => h("details", { class: "why" }, h("summary", {}, pill), h("p", {}, row.reason));
  return h("td", { class: "text" }, row.reason && isOk(row) ? why() : pill);
}

const mark = (sign, label, title = label) => h("span", { class: "mark", role: "img", "aria-label": label, title }, sign);

function cell(row, column, openPictures) {
  if (column === causesColumn) return h("td", { class: "text" }, causeBar(row));
  const text = textOf(row, column);
  if (column.name === "technique") return techniqueCell(row, text, openPictures);
  if (column.name === "support") return supportCell(row, text);
  if (row.values[column.index] === null) return h("td", { class: column.is_left ? "text null" : "null" }, text);
  const [is_best, is_floored, is_flagged] = [row.best, row.floored, row.flagged].map((marked) => marked.has(column.index));
  const noise = "within the reference's noise";
  const few = "too few pixels tested";
  const stays = staying.includes(column.name);
  const names = joined([column.is_left && "text", is_best && "best", is_flagged && "flagged", stays && "stays"]);
  return h(
    "td",
    { class: names || null, "data-stays": stays ? column.name : null },
    is_best && mark("\u2605", "best of its group"),
    column.name === "scene" ? named("scenes", row.scene, text) : column.is_left ? breakable(text) : text,
    is_floored && mark("\u00b0", noise, `${noise} of the best value`),
    is_flagged && mark("\u2691", few, `${few}: read the errors with care`),
    interval(row, column),
  );
}

/** Cells of a row. The reason of a row that was not measured fills its longest run of columns without values. */
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
  const start = best.length === 0 ? columns.length : best.start;
  const rest = (from, to) => columns.slice(from, to).map((column) => cell(row, column, openPictures));
  return [...rest(0, start), reason, ...rest(start + best.length)];
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

/** Builds the section; `open(row)` shows a row in the comparer. */
export function showTable(section, open) {
  const columns = allColumns();
  const visible = new Set(columns.filter((column) => column.is_headline).map((column) => column.name));
  const order = { column: null, descending: false };

  const [head, body] = [h("thead"), h("tbody")];
  let drawMore = () => {};
  const openPictures = (row) => {
    open(row);
    body.querySelector("tr[aria-current]")?.removeAttribute("aria-current");
    body.querySelector(`tr[data-row="${row.index}"]`)?.setAttribute("aria-current", "true");
  };
  const table = h("table", {}, h("caption", { class: "hidden" }, "Every row of the run"), head, body);

  const sortBy = (column) => {
    const first = column.better === "higher";
    if (order.column !== column) Object.assign(order, { column, descending: first });
    else if (order.descending === first) order.descending = !first;
    else order.column = null;
    remember({ sort: order.column?.name ?? null, down: order.column && order.descending ? 1 : null });
    draw();
    head.querySelector(`[data-column="${CSS.escape(column.name)}"] button`)?.focus();
  };

  const headCell = (column) => {
    const { heading, shown_unit: unit, sentence } = column;
    const direction = order.descending ? ["descending", "\u25be"] : ["ascending", "\u25b4"];
    const [sort, arrow] = order.column === column ? direction : [null, ""];
    const attributes = {
      scope: "col",
      class: joined([column.is_left && "text", staying.includes(column.name) && "stays"]) || null,
      "data-stays": staying.includes(column.name) ? column.name : null,
      "data-column": column.name,
      "data-heading": unit ? `${heading} (${unit})` : heading,
      "aria-sort": sort,
    };
    const button = h(
      "button",
      { type: "button", title: sentence || null, onclick: () => sortBy(column) },
      h("span", {}, heading, h("span", { class: "arrow", "aria-hidden": "true" }, arrow)),
      h("small", {}, unit || "\u00a0"),
    );
    return h("th", attributes, button);
  };

  function draw() {
    const shown = shownColumns();
    head.replaceChildren(h("tr", {}, shown.map(headCell)));
    const rows = sorted(filteredRows(), order);
    const lineOf = (row, index) => {
      const is_new_group = !order.column && index > 0 && rows[index - 1].group !== row.group;
      const names = joined([isOk(row) ? row.role : row.status, is_new_group && "first"]);
      const current = String(row.index) === recalled("row") ? "true" : null;
      return h("tr", { class: names, "data-row": row.index, "aria-current": current }, cells(row, shown, openPictures));
    };
    const across = (className, ...content) => h("tr", {}, h("td", { class: `text ${className}`, colspan: shown.length || 1 }, content));
    // A browser takes seconds for thousands of rows: those that are far below come when they are scrolled to.
    let drawn = 0;
    const more = h("button", { type: "button", onclick: () => drawMore(Infinity) }, "Show all rows");
    const rest = across("rest", more);
    drawMore = (count = batch) => {
      const lines = rows.slice(drawn, drawn + count).map((row, k) => lineOf(row, drawn + k));
      drawn += lines.length;
      rest.remove();
      body.append(...lines, ...(drawn < rows.length ? [rest] : []));
      more.textContent = `Show the other ${plural(rows.length - drawn, "row")} too`;
    };
    body.replaceChildren();
    drawMore();
    if (rows.length === 0) body.append(across("nothing", "No row passes the filter."));
    place();
    text.update();
  }

  /** Columns that stay lie beside one another, each behind those before it. */
  function place() {
    let left = 0;
    for (const cell of head.querySelectorAll("[data-stays]")) {
      table.style.setProperty(`--left-${cell.dataset.stays}`, `${left}px`);
      left += cell.getBoundingClientRect().width;
    }
  }

  function recallOrder() {
    const column = columns.find(({ name }) => name === recalled("sort")) ?? null;
    Object.assign(order, { column, descending: recalled("down") !== null });
  }

  const shownColumns = () => columns.filter((column) => visible.has(column.name));
  const text = tableText(() => [shownColumns(), sorted(filteredRows(), order)]);

  const box = (column) => {
    const { name, sentence } = column;
    const onchange = () => {
      visible[input.checked ? "add" : "delete"](name);
      draw();
    };
    const input = h("input", { type: "checkbox", name, checked: visible.has(name), onchange });
    return h("label", { title: sentence || null }, input, h("span", {}, name));
  };
  const scroll = h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table of all rows" }, table);
  scroll.addEventListener("scroll", () => {
    if (scroll.scrollTop + 3 * scroll.clientHeight > scroll.scrollHeight && body.querySelector(".rest")) drawMore();
  });
  addEventListener("beforeprint", () => body.querySelector(".rest") && drawMore(Infinity));
  section.append(
    filterBar(),
    scroll,
    h(
      "div",
      { class: "below" },
      legend(),
      occurringCauses().length > 0 && causeLegend(),
      text.element,
      h("details", { class: "columns" }, h("summary", {}, "Choose columns"), h("div", {}, columns.map(box))),
    ),
  );
  recallOrder();
  onFilter(draw);
  onRecall(() => {
    recallOrder();
    draw();
  });
  draw();
  new ResizeObserver(place).observe(table);
}
