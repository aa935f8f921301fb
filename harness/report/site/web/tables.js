// Tables that the program wrote: headings sort, a field filters, and the address says how.

import { h, plural } from "../../html/web/dom.js";
import { onRecall, recalled, remember } from "../../html/web/page_state.js";

const valueOf = (row, column) => row.cells[column]?.dataset.v ?? null;

function compare(a, b) {
  const [x, y] = [Number(a), Number(b)];
  if (a.trim() !== "" && b.trim() !== "" && Number.isFinite(x) && Number.isFinite(y)) return x - y;
  return a.localeCompare(b, "en", { numeric: true });
}

/** Rows in order, those without a value at the end. */
function sorted(rows, column, is_down) {
  const sign = is_down ? -1 : 1;
  return rows
    .map((row, index) => ({ row, index, value: valueOf(row, column) }))
    .sort((p, q) => {
      if (p.value === null || q.value === null) return (p.value === null) - (q.value === null) || p.index - q.index;
      return sign * compare(p.value, q.value) || p.index - q.index;
    })
    .map(({ row }) => row);
}

function enhance(table, index) {
  const name = table.dataset.name ?? `t${index}`;
  const key = (what) => `${name}.${what}`;
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const texts = rows.map((row) => row.textContent.toLowerCase());
  const heads = [...table.tHead.rows[0].cells];
  const state = { sort: null, down: false, filter: "" };
  let field = null;
  let count = null;

  function draw() {
    const words = state.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const isShown = (_, k) => words.every((word) => texts[k].includes(word));
    const shown = rows.filter(isShown);
    body.replaceChildren(...(state.sort === null ? shown : sorted(shown, state.sort, state.down)));
    heads.forEach((head, k) => {
      const sort = state.sort === k ? (state.down ? "descending" : "ascending") : null;
      if (sort) head.setAttribute("aria-sort", sort);
      else head.removeAttribute("aria-sort");
      head.querySelector(".arrow").textContent = sort ? (state.down ? "\u25be" : "\u25b4") : "";
    });
    if (count) count.textContent = `${shown.length} of ${plural(rows.length, "row")}`;
  }

  function keep() {
    remember({ [key("sort")]: state.sort, [key("down")]: state.sort !== null && state.down ? 1 : null, [key("filter")]: state.filter });
    draw();
  }

  function sortBy(k) {
    if (state.sort !== k) Object.assign(state, { sort: k, down: false });
    else if (!state.down) state.down = true;
    else Object.assign(state, { sort: null, down: false });
    keep();
  }

  function recall() {
    const sort = recalled(key("sort"));
    state.sort = /^\d+$/.test(sort ?? "") && Number(sort) < heads.length ? Number(sort) : null;
    state.down = recalled(key("down")) !== null;
    state.filter = recalled(key("filter")) ?? "";
    if (field) field.value = state.filter;
    draw();
  }

  heads.forEach((head, k) => {
    const arrow = h("span", { class: "arrow", "aria-hidden": "true" });
    head.replaceChildren(h("button", { type: "button", onclick: () => sortBy(k) }, h("span", {}, [...head.childNodes], arrow)));
  });
  if (table.dataset.filter !== undefined) {
    const set = () => {
      state.filter = field.value;
      keep();
    };
    field = h("input", { type: "search", spellcheck: "false", autocomplete: "off", oninput: set });
    count = h("output", { class: "count", "aria-live": "polite" });
    const label = h("label", { class: "field grows" }, h("span", {}, "filter"), field);
    table.parentElement.before(h("div", { class: "bar filters" }, label, count));
  }
  recall();
  onRecall(recall);
}

export function enhanceTables() {
  document.querySelectorAll("table.sortable").forEach(enhance);
}
