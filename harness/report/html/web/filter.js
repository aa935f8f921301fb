// Which rows are shown: one filter for the table and every plot.

import { data, distinct } from "./data.js";
import { chooser, h, plural } from "./dom.js";

const listeners = [];
const state = { text: "", scene: "", light: "", technique: "", status: "" };

const wordsOf = (row) =>
  [
    row.title,
    row.technique,
    row.settings,
    row.scene,
    row.light,
    row.view,
    row.path,
    row.role,
    row.status,
    row.support,
    row.reason,
  ]
    .join(" ")
    .toLowerCase();
const words = data.rows.map(wordsOf);

function matches(row) {
  const wanted = state.text.toLowerCase().split(/\s+/).filter(Boolean);
  return (
    wanted.every((word) => words[row.index].includes(word)) &&
    ["scene", "light", "technique", "status"].every((key) => !state[key] || row[key] === state[key])
  );
}

/** Rows that pass, in the order of the run. */
export const filteredRows = () => data.rows.filter(matches);

/** Calls back after every change of the filter. */
export const onFilter = (listener) => listeners.push(listener);

/** The controls. */
export function filterBar() {
  const changed = () => {
    count.textContent = `${filteredRows().length} of ${plural(data.rows.length, "row")}`;
    reset.disabled = Object.values(state).every((value) => !value);
    listeners.forEach((listener) => listener());
  };
  const text = h("input", {
    type: "search",
    placeholder: "any words",
    spellcheck: "false",
    autocomplete: "off",
    oninput: () => ((state.text = text.value), changed()),
  });
  const lists = ["scene", "light", "technique", "status"].map((key) => {
    const values = distinct(data.rows.map((row) => row[key]));
    const options = values.map((value) => ({
      value,
      text: `${value} (${data.rows.filter((row) => row[key] === value).length})`,
    }));
    return chooser(key, [{ value: "", text: "all" }, ...options], (value) => ((state[key] = value), changed()), { name: key });
  });
  const clear = () => {
    for (const key of Object.keys(state)) state[key] = "";
    text.value = "";
    lists.forEach((list) => (list.value = ""));
    changed();
  };
  const reset = h("button", { type: "button", class: "quiet", onclick: clear, disabled: true }, "Reset");
  const count = h("output", { class: "count", "aria-live": "polite" }, plural(data.rows.length, "row"));
  const bar = h(
    "div",
    { class: "bar filters", role: "search", "aria-label": "Filter the rows of the table and of the plots" },
    h("label", { class: "field grows" }, h("span", {}, "filter"), text),
    lists.map((list) => list.element),
    reset,
    count,
  );
  return bar;
}
