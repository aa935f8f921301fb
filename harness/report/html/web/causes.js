// Causes of wrong pixels: a stacked bar for a row, and the legend of the colors.

import { data, isOk, isSoft, sum } from "./data.js";
import { h, rgb, swatch, words } from "./dom.js";
import { percent } from "./digits.js";

/** Causes that occur in some row, in order. */
export const occurringCauses = () => data.causes.filter((_, index) => data.rows.some((row) => row.causes?.[index] > 0));

export const wrongShare = (row) => (row.causes ? sum(row.causes) : null);

/** Widths are shares of the row's wrong pixels. Other columns contain their number. */
export function causeBar(row) {
  if (!isOk(row) || !row.causes) return h("span", { class: "null" }, "-");
  const total = wrongShare(row);
  if (total === 0) return h("span", { class: "none" }, isSoft(row) ? "no error" : "no wrong pixel");
  const causes = data.causes.map((cause, index) => ({ ...cause, share: row.causes[index] }));
  const parts = causes.filter(({ share }) => share > 0);
  const texts = parts.map(({ name, share }) => `${words(name)} ${percent(share)}`);
  return h(
    "span",
    { class: "causes", role: "img", "aria-label": texts.join(", "), title: texts.join("\n") },
    parts.map(({ color, share }) => h("i", { style: { "flex-grow": String(share / total), background: rgb(color) } })),
  );
}

/** Colors of the causes that occur. */
export function causeLegend() {
  const entry = (cause) => h("li", { title: cause.sentence }, swatch(rgb(cause.color)), words(cause.name));
  return h("ul", { class: "swatches", "aria-label": "Colors of the causes" }, occurringCauses().map(entry));
}
