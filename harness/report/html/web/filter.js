// Which rows are shown: one filter for the table and every plot.

import { data, distinct } from "./data.js";
import { chooser, h, plural, words } from "./dom.js";
import { onRecall, recalled, remember } from "./page_state.js";

const listeners = [];
const listed = ["scene", "light", "technique", "status"];
const searched = [...listed, "title", "settings", "view", "path", "role", "support", "reason"];
const state = { text: "", scene: "", light: "", technique: "", status: "" };
/** Causes that a row has, "peter_panning" and "peter panning". */
const causesOf = (row) => data.causes.filter((_, index) => row.causes?.[index] > 0).flatMap(({ name }) => [name, words(name)]);
const texts = data.rows.map((row) => [...searched.map((key) => row[key]), ...causesOf(row)].join(" ").toLowerCase());

function matches(row) {
  const wanted = state.text.toLowerCase().split(/\s+/).filter(Boolean);
  const isChosen = (key) => !state[key] || row[key] === state[key];
  return wanted.every((word) => texts[row.index].includes(word)) && listed.every(isChosen);
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
    remember({ ...state, text: null, filter: state.text });
    listeners.forEach((listener) => listener());
  };
  const set = (key, value) => {
    state[key] = value;
    changed();
  };
  const plain = { placeholder: "any words, causes too", spellcheck: "false", autocomplete: "off" };
  const text = h("input", { type: "search", ...plain, oninput: () => set("text", text.value) });
  const lists = listed.map((key) => {
    const countOf = (value) => data.rows.filter((row) => row[key] === value).length;
    const values = distinct(data.rows.map((row) => row[key]));
    const options = values.map((value) => ({ value, text: `${value} (${countOf(value)})` }));
    return chooser(key, [{ value: "", text: "all" }, ...options], (value) => set(key, value));
  });
  const setAll = (valueOf) => {
    for (const key of Object.keys(state)) state[key] = valueOf(key);
    text.value = state.text;
    lists.forEach((list, index) => {
      list.value = state[listed[index]];
      state[listed[index]] = list.value; // "" of a value that no row has
    });
    changed();
  };
  const clear = () => setAll(() => "");
  const recall = () => setAll((key) => recalled(key === "text" ? "filter" : key) ?? "");
  const reset = h("button", { type: "button", onclick: clear, disabled: true }, "Reset");
  const count = h("output", { class: "count", "aria-live": "polite" }, plural(data.rows.length, "row"));
  recall();
  onRecall(recall);
  return h(
    "div",
    { class: "bar filters", role: "search", "aria-label": "Filter the rows of the table and of the plots" },
    h("label", { class: "field grows" }, h("span", {}, "filter"), text),
    lists.map((list) => list.element),
    reset,
    count,
  );
}
