// What a plot can put on an axis: costs with their intervals, memory, metrics.

import { columnNamed, data, errorName, isSoft, valueOf } from "./data.js";
import { measured, milliseconds } from "./digits.js";

/** A quantity: name, text for the list, label of the axis, of(row) -> {value, low, high} in the axis' unit or null, shown(value). */
function ofTimes(name, text, times) {
  const of = (row) => {
    const estimate = times(row);
    return estimate && { value: estimate[0], low: estimate[1] ?? null, high: estimate[2] ?? null };
  };
  return { name, text, label: `${text} (ms)`, unit: "ms", shown: milliseconds, of, isTime: true };
}

function ofColumn(column) {
  const label = column.heading + (column.shown_unit ? ` (${column.shown_unit})` : "");
  const of = (row) => {
    const value = row.values[column.index];
    return typeof value === "number" ? { value: value * column.scale, low: null, high: null } : null;
  };
  return { name: column.name, text: column.heading, label, unit: column.shown_unit, shown: measured, of, column };
}

const occurs = (quantity) => data.rows.some((row) => quantity.of(row));

/** Times of events. */
export const events = data.costs.map((cost) => ofTimes(cost.name, cost.heading, (row) => row.costs[cost.name])).filter(occurs);
export const stages = data.stages.map((name) => ofTimes(name, name, (row) => row.stages[name])).filter(occurs);
export const memory = ["bytes", "peak_bytes"].map(columnNamed).filter(Boolean).map(ofColumn).filter(occurs);
/** Metrics that have a better side. `error` is another word for the wrong rate where no light has an area. */
export const metrics = data.metrics
  .filter((metric) => metric.better && columnNamed(metric.name))
  .filter((metric) => metric.name !== "error" || data.rows.some(isSoft))
  .map((metric) => ({ ...ofColumn(columnNamed(metric.name)), better: metric.better, sentence: metric.sentence }))
  .filter(occurs);

/** What rows are judged by. */
export const judgedBy = data.rows.some(isSoft) ? "error" : "wrong_rate";

/** The quantity by the name that it has for these rows. */
export function calledFor(quantity, rows) {
  if (quantity.name !== "error") return quantity;
  const text = errorName(rows);
  return { ...quantity, text, label: `${text} (${quantity.unit})` };
}

/** Of mean errors the reference's own in percent, over the rows; null of other quantities and lights. */
export function floorOf(rows, metric) {
  if (metric.name !== "error" && metric.name !== "error_mean") return null;
  const floors = rows.map((row) => valueOf(row, "reference_error_mean")).filter((value) => value !== null);
  return floors.length > 0 ? (100 * floors.reduce((sum, value) => sum + value, 0)) / floors.length : null;
}

export const optionsOf = (quantities) => quantities.map(({ name, text }) => ({ value: name, text }));
export const named = (quantities, name) => quantities.find((quantity) => quantity.name === name) ?? quantities[0];
