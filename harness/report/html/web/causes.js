// Causes of wrong pixels: a stacked bar for a row, and the legend of the colors.

import { causeShares, data, isOk, isSoft } from "./data.js";
import { h, rgb } from "./dom.js";
import { percent } from "./digits.js";

const words = (name) => name.replaceAll("_", " ");

/** Causes that occur in some row, in order. */
export const occurringCauses = () => data.causes.filter((_, index) => data.rows.some((row) => row.causes?.[index] > 0));

export const wrongShare = (row) => causeShares(row)?.reduce((sum, share) => sum + share, 0) ?? null;

/** Widths are shares of the row's wrong pixels; how many these are is said in the other columns. */
export function causeBar(row) {
  const shares = isOk(row) ? causeShares(row) : null;
  if (!shares) return h("span", { class: "null" }, "-");
  const total = shares.reduce((sum, share) => sum + share, 0);
  if (total === 0) return h("span", { class: "none" }, isSoft(row) ? "no error" : "no wrong pixel");
  const parts = data.causes
    .map((cause, index) => ({ cause, share: shares[index] }))
    .filter(({ share }) => share > 0)
    .map((part) => ({ ...part, text: `${words(part.cause.name)} ${percent(part.share)}` }));
  const text = parts.map((part) => part.text).join(", ");
  return h(
    "span",
    { class: "causes", role: "img", "aria-label": text, title: parts.map((part) => part.text).join("\n") },
    parts.map(({ cause, share }) => h("i", { style: { "flex-grow": String(share / total), background: rgb(cause.color) } })),
  );
}

/** Colors of the causes that occur. */
export function causeLegend() {
  return h(
    "ul",
    { class: "swatches", "aria-label": "Colors of the causes" },
    occurringCauses().map((cause) =>
      h("li", { title: cause.sentence }, h("i", { style: { background: rgb(cause.color) } }), words(cause.name)),
    ),
  );
}
