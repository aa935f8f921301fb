// What the plots share: axes that stay readable over decades, colors and symbols of techniques, tips.

import { pointer, ruleX, ruleY, tip } from "@observablehq/plot";

import { distinct, techniques } from "./data.js";
import { tick } from "./digits.js";

/**
 * A logarithmic axis for values that may be 0: zeros are at the low end, below all other values, with the tick "0". Linear when
 * values differ by less than a factor of 3, or when none is positive. `at(value)` is the value's place on the axis,
 * `share(value)` the same as a part of its length, `zero` the place of zeros or null, `isLog` whether it is logarithmic. The
 * scale itself is linear, over logarithms: of logarithmic scales the plotting library leaves out labels.
 */
export function logAxis(values) {
  const positive = values.filter((value) => value > 0);
  const [low, high] = [Math.min(...positive), Math.max(...positive)];
  const has_zero = positive.length < values.length;
  if (positive.length === 0) return axis(0, 1, { ticks: [0], tickFormat: tick }, (value) => value, null);
  if (high < 3 * low && !has_zero) {
    const room = 0.06 * (high - low || low);
    return axis(low - room, high + room, { tickFormat: tick }, (value) => value, null);
  }
  const [from, to] = [Math.log10(low) - 0.08, Math.log10(high) + 0.08];
  const zero = has_zero ? from - Math.max(0.2, 0.1 * (to - from)) : null;
  const decades = to - from;
  const steps = decades < 1.2 ? [1, 1.5, 2, 3, 5, 7] : decades < 3 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / 7));
  const ticks = new Map(has_zero ? [[zero, "0"]] : []);
  for (let power = Math.floor(from); power <= Math.ceil(to); ++power)
    for (const step of steps) {
      const value = Number(`${step}e${power}`);
      const place = Math.log10(value);
      if (place >= from && place <= to && (steps.length > 1 || power % every === 0)) ticks.set(place, tick(value));
    }
  const options = { ticks: [...ticks.keys()], tickFormat: (place) => ticks.get(place) ?? "" };
  const start = zero === null ? from : zero - 0.06 * (to - zero);
  return axis(start, to, options, (value) => (value > 0 ? Math.log10(value) : zero), zero, true);
}

function axis(from, to, options, at, zero, isLog = false) {
  const share = (value) => (at(value) - from) / (to - from);
  return { options: { type: "linear", domain: [from, to], ...options }, at, zero, isLog, share };
}

const colorCount = 8;
const symbols = ["circle", "square2", "triangle2", "diamond2", "star", "wye", "cross"];

/** Scales over names in this order. */
export const scalesOver = (domain) => ({
  color: { domain, range: domain.map((_, index) => `var(--series-${index % colorCount})`) },
  symbol: { domain, range: domain.map((_, index) => symbols[index % symbols.length]) },
});

/**
 * Scales of the techniques of some points, in the order of the run: 8 colors and 7 symbols give 56 pairs. Only those that the
 * plot shows have one, so that no two of up to 8 have the same color.
 */
export function techniqueScales(points) {
  const used = new Set(points.map((point) => point.technique));
  return scalesOver(techniques.filter((technique) => used.has(technique)));
}

/** Colors and symbols of points by technique, or by scene when there is only one technique. */
export function seriesOf(points) {
  const is_one = distinct(points.map((point) => point.technique)).length === 1;
  if (is_one) return { name: "scene", ...scalesOver(distinct(points.map((point) => point.scene))) };
  return { name: "technique", ...techniqueScales(points) };
}

/** The same, but by setting while there are colors for them. */
export function settingsOf(points) {
  const titles = distinct(points.map((point) => point.row.title));
  return titles.length > 16 ? seriesOf(points) : { name: "title", ...scalesOver(titles) };
}

/** Options of a plot's axis with its name: `acrossOptions` for x, `upOptions` for y. */
export const upOptions = (label, options) => ({ label, labelArrow: "none", grid: true, ...options });
export const acrossOptions = (label, options) => upOptions(`${label} \u2192`, { labelAnchor: "right", ...options });

/** Dashed lines at the places of zeros. */
export function zeroLines(across, up) {
  const style = { stroke: "var(--muted)", strokeDasharray: "2 4" };
  return [up.zero === null ? null : ruleY([up.zero], style), across.zero === null ? null : ruleX([across.zero], style)];
}

/** A dotted line at an error floor. */
export const floorLine = (up, floor) => ruleY([up.at(floor)], { stroke: "var(--ink)", strokeDasharray: "1 4" });

/** A tip for the point under the pointer, with the lines `says(point)`. */
export const tipOf = (points, at, says) => tip(points, pointer({ ...at, title: (point) => says(point).join("\n"), fontSize: 12 }));

/** Options of every plot. */
export function frame(width, height) {
  const style = { fontSize: "12px", fontFamily: "inherit", overflow: "visible" };
  return { width, height, style, marginTop: 28, marginLeft: 58, marginRight: 20, marginBottom: 46 };
}

/** The library's names of a plot's parts become data-mark: they mean nothing to those who have the page read to them. */
export function unname(plot) {
  for (const part of plot.querySelectorAll("[aria-label]")) {
    part.dataset.mark = part.getAttribute("aria-label");
    part.removeAttribute("aria-label");
  }
}

/** Gives a plot a name as one picture; returns its SVG element. */
export function describe(plot, name) {
  unname(plot);
  const picture = [plot, ...plot.querySelectorAll("svg")].filter((element) => element.localName === "svg").at(-1);
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", name);
  return picture;
}

/** An interval for a tip; empty where there is none. */
export const between = (estimate, shown) =>
  estimate.low === null ? "" : ` (${shown(estimate.low)} \u2013 ${shown(estimate.high)})`;
