// What a plot can put on an axis: costs with their intervals, memory, metrics.

import { columnNamed, data, mean, valueOf } from "./data.js";
import { measured, milliseconds } from "./digits.js";

/** A quantity: name, text for the list, label of the axis, of(row) -> {value, low, high} in the axis' unit or null, shown(). */
function ofTimes(name, text, times) {
  const of = (row) => {
    const estimate = times(row) ?? null;
    return estimate && { value: estimate[0], low: estimate[1] ?? null, high: estimate[2] ?? null };
  };
  return { name, text, label: `${text} (ms)`, unit: "ms", shown: milliseconds, of };
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
/** Times of stages; those that begin with `moving_` are of the frames after an update. */
export const stages = data.stages
  .map((name) => ofTimes(name, name.replace("_", " "), (row) => row.stages[name]))
  .filter(occurs);
export const memory = ["bytes", "peak_bytes"].map(columnNamed).filter(Boolean).map(ofColumn).filter(occurs);
/** Metrics that have a better side. */
export const metrics = data.metrics
  .filter((metric) => metric.better && columnNamed(metric.name))
  .map((metric) => ({ ...ofColumn(columnNamed(metric.name)), better: metric.better, sentence: metric.sentence }))
  .filter(occurs);

/**
 * Means over the rows to compare a metric with, in its unit: its floor, which is what the reference's own noise makes of it, and
 * of `error` that of the best constant mask; null where there is none.
 */
export function levelsOf(rows, metric) {
  const level = (name) => {
    const column = columnNamed(name);
    const values = column ? rows.map((row) => valueOf(row, name)).filter((value) => value !== null) : [];
    return values.length > 0 ? column.scale * mean(values) : null;
  };
  return { floor: level(`${metric.name}_floor`), constant: metric.name === "error" ? level("constant_error") : null };
}

export const optionsOf = (quantities) => quantities.map(({ name, text }) => ({ value: name, text }));
export const named = (quantities, name) => quantities.find((quantity) => quantity.name === name) ?? quantities[0];
