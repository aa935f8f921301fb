// What the plots share: axes that stay readable over decades, colors and symbols of techniques, tips.

import { pointer, ruleX, ruleY, tip } from "@observablehq/plot";

import { techniques } from "./data.js";
import { tick } from "./digits.js";

/**
 * A logarithmic axis for values that may be 0: zeros stand on the low end, below everything else, under the tick "0". Linear
 * when values differ by less than a factor of 3, or when nothing is positive. `at(value)` is where a value goes on the axis,
 * `share(value)` the same as a part of its length, `zero` the place of zeros or null, `isLog` which of both it is. The scale
 * itself is linear, over logarithms: the plotting library leaves out labels of logarithmic scales as it sees fit.
 */
export function logAxis(values) {
  const positive = values.filter((value) => value > 0);
  const low = Math.min(...positive),
    high = Math.max(...positive);
  const has_zero = positive.length < values.length;
  if (positive.length === 0) return axis(0, 1, { ticks: [0], tickFormat: tick }, (value) => value, null);
  if (high < 3 * low && !has_zero) {
    const room = 0.06 * (high - low || low);
    return axis(low - room, high + room, { tickFormat: tick }, (value) => value, null);
  }
  const from = Math.log10(low) - 0.08,
    to = Math.log10(high) + 0.08;
  const zero = has_zero ? from - Math.max(0.2, 0.1 * (to - from)) : null;
  const decades = to - from;
  const steps = decades < 1.2 ? [1, 1.5, 2, 3, 5, 7] : decades < 3 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / 7));
  const ticks = new Map(has_zero ? [[zero, "0"]] : []);
  for (let power = Math.floor(from); power <= Math.ceil(to); ++power)
    for (const step of steps) {
      const value = Number(`${step}e${power}`),
        place = Math.log10(value);
      if (place >= from && place <= to && (steps.length > 1 || power % every === 0)) ticks.set(place, tick(value));
    }
  const options = { ticks: [...ticks.keys()], tickFormat: (place) => ticks.get(place) ?? "" };
  return axis(
    zero === null ? from : zero - 0.06 * (to - zero),
    to,
    options,
    (value) => (value > 0 ? Math.log10(value) : zero),
    zero,
    true,
  );
}

function axis(from, to, options, at, zero, isLog = false) {
  return {
    options: { type: "linear", domain: [from, to], ...options },
    at,
    zero,
    isLog,
    share: (value) => (at(value) - from) / (to - from),
  };
}

const colorCount = 8;
const symbols = ["circle", "square2", "triangle2", "diamond2", "star", "wye", "cross"];

/** Scales over names in this order. */
export const scalesOver = (domain) => ({
  color: { domain, range: domain.map((_, index) => `var(--series-${index % colorCount})`) },
  symbol: { domain, range: domain.map((_, index) => symbols[index % symbols.length]) },
});

/** Scales by technique: 8 colors and 7 symbols give 56 pairs, the same in every plot. */
export const { color: colorScale, symbol: symbolScale } = scalesOver(techniques);

/** What colors and symbols of points tell apart: techniques, or scenes when there is only one technique. */
export function seriesOf(points) {
  const is_one = new Set(points.map((point) => point.technique)).size === 1;
  if (is_one) return { name: "scene", ...scalesOver([...new Set(points.map((point) => point.scene))]) };
  return { name: "technique", color: usedBy(points, colorScale), symbol: usedBy(points, symbolScale) };
}

/** The same, but settings are told apart while there are colors for them. */
export function settingsOf(points) {
  const titles = [...new Set(points.map((point) => point.row.title))];
  return titles.length > 16 ? seriesOf(points) : { name: "title", ...scalesOver(titles) };
}

/** The part of a scale that the techniques of some points use. */
export function usedBy(points, { domain, range }) {
  const used = new Set(points.map((point) => point.technique));
  const isUsed = (_, index) => used.has(domain[index]);
  return { domain: domain.filter(isUsed), range: range.filter(isUsed) };
}

/** Options of an axis with its name: `acrossOptions` for x, `upOptions` for y. */
export const acrossOptions = (axis, label) => ({
  ...axis.options,
  label: `${label} \u2192`,
  labelAnchor: "right",
  labelArrow: "none",
  grid: true,
});
export const upOptions = (axis, label) => ({ ...axis.options, label, labelArrow: "none", grid: true });

/** Dashed lines where zeros stand on logarithmic axes. */
export function zeroLines(across, up) {
  const style = { stroke: "var(--muted)", strokeDasharray: "2 4" };
  return [
    ...(up.zero === null ? [] : [ruleY([up.zero], style)]),
    ...(across.zero === null ? [] : [ruleX([across.zero], style)]),
  ];
}

/** Tells about the point under the pointer: `says(point)` are its lines. */
export const tipOf = (points, at, says) => tip(points, pointer({ ...at, title: (point) => says(point).join("\n"), fontSize: 12 }));

/** Options of every plot. */
export function frame(width) {
  return {
    width,
    style: { fontSize: "12px", fontFamily: "inherit", overflow: "visible" },
    marginTop: 28,
    marginLeft: 58,
    marginRight: 20,
    marginBottom: 46,
  };
}

/** An interval for a tip; empty where there is none. */
export const between = (estimate, shown) =>
  estimate.low === null ? "" : ` (${shown(estimate.low)} \u2013 ${shown(estimate.high)})`;
