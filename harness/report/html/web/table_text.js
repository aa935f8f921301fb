// The table as text, fields separated by tabs, as spreadsheets and mails take it.

import { percent } from "./digits.js";
import { data, textOf } from "./data.js";
import { h, plural, words } from "./dom.js";

/** One field: no tabs and line breaks within. */
const field = (text) => String(text).replace(/\s+/g, " ").trim();

function causesText(row) {
  const parts = data.causes.map(({ name }, index) => [words(name), row.causes?.[index] ?? 0]).filter(([, share]) => share > 0);
  return parts.map(([name, share]) => `${name} ${percent(share)}`).join(", ") || "-";
}

const textIn = (row, column) => (column.index === undefined ? causesText(row) : textOf(row, column));

/** The text of these columns and rows, headings with their units first. */
export function tabbed(columns, rows) {
  const heading = ({ heading, shown_unit: unit }) => (unit ? `${heading} (${unit})` : heading);
  const lines = [columns.map(heading), ...rows.map((row) => columns.map((column) => textIn(row, column)))];
  return lines.map((line) => line.map(field).join("\t") + "\n").join("");
}

/** A part of the page that opens to the text; `shown()` gives columns and rows. `update()` follows the table. */
export function tableText(shown) {
  const text = h("textarea", { readonly: true, rows: "8", spellcheck: "false", "aria-label": "The table as text" });
  const said = h("output", { class: "count", "aria-live": "polite" });
  async function copy() {
    text.select();
    const rows = plural(shown()[1].length, "row");
    try {
      await navigator.clipboard.writeText(text.value);
      said.textContent = `${rows} copied`;
    } catch {
      said.textContent = `${rows} selected: the browser lets no page copy here, but its own copy key`;
    }
  }
  const update = () => {
    said.textContent = "";
    if (element.open) text.value = tabbed(...shown());
  };
  const button = h("button", { type: "button", onclick: copy }, "Copy");
  const element = h(
    "details",
    { class: "columns as-text", ontoggle: update },
    h("summary", {}, "Table as text"),
    h("p", { class: "bar" }, button, said),
    text,
  );
  return { element, update };
}
