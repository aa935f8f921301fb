// How a cost or an error grows with triangles, pixels or a parameter.

import { dot, line, plot, ruleX, text } from "@observablehq/plot";

import { acrossOptions, between, floorLine, frame, logAxis, scalesOver, seriesOf, tipOf, upOptions, zeroLines } from "./axes.js";
import { clamp, data, distinct, groupName, isOk, isSoft, joined, mean, valueOf } from "./data.js";
import { tick } from "./digits.js";
import { chooser, plural } from "./dom.js";
import { filteredRows } from "./filter.js";
import { events, levelsOf, memory, metrics, named, optionsOf, stages } from "./quantities.js";

/** Along these the error of independent samples falls with the root of their number. */
const isSamples = (x) => /(^|_)samples$/.test(x.parameter ?? "");
const seed = "seed"; // rows that differ in this parameter alone have the same setting

/** What may grow: name, text, of(row) -> number or null, and whether it grows with the scene. */
function growing() {
  const ofParameter = (parameter) => {
    const of = ({ parameters }) => (typeof parameters[parameter] === "number" ? parameters[parameter] : null);
    return { name: `parameter.${parameter}`, text: parameter, parameter, of };
  };
  const all = [
    { name: "triangles", text: "triangles", of: (row) => valueOf(row, "triangles"), sweepsScene: true },
    { name: "pixels", text: "pixels", of: (row) => data.groups[row.group].width * data.groups[row.group].height || null },
    ...distinct(data.rows.flatMap((row) => Object.keys(row.parameters))).map(ofParameter),
  ];
  return all.filter((x) => lines(x, 2) > 0);
}

/** The number of lines with at least so many different x. */
function lines(x, least) {
  const places = new Map();
  for (const row of data.rows.filter(isOk)) {
    const value = x.of(row);
    if (value === null) continue;
    const key = lineOf(row, x);
    places.set(key, (places.get(key) ?? new Set()).add(value));
  }
  return [...places.values()].filter((values) => values.size >= least).length;
}

/** A key of the row's line: the rows of a line are equal but for x and the seed. */
function lineOf(row, x) {
  const parameters = Object.entries(row.parameters).filter(([name]) => name !== x.parameter && name !== seed);
  const { view, path, width, height, truth } = data.groups[row.group];
  const size = x.name === "pixels" ? "" : `${width}x${height}`;
  const scene = x.sweepsScene ? row.family : row.scene;
  return JSON.stringify([row.technique, parameters, scene, row.light, view, path, size, truth]);
}

/** What a line's rows have in common, by name. */
const nameOf = (row, x) =>
  row.title
    .replace(/:.*/, (settings) => ":" + settings.slice(1).split(",").filter((part) => !varies(part, x)).join())
    .replace(/:$/, "");
const varies = (setting, x) => [x.parameter, seed].includes(setting.split("=")[0]);

/** Points that differ in their seed alone become one: their mean, its interval from the smallest to the largest. */
function overSeeds(points) {
  const places = new Map();
  for (const point of points) {
    const key = `${point.x} ${point.line}`;
    places.set(key, [...(places.get(key) ?? []), point]);
  }
  return [...places.values()].map((same) => {
    if (same.length === 1) return { ...same[0], seeds: 1 };
    const values = same.map(({ estimate }) => estimate.value);
    const estimate = { value: mean(values), low: Math.min(...values), high: Math.max(...values) };
    return { ...same[0], seeds: same.length, estimate };
  });
}

/** The series that have colors: the lines by their names where one technique has few of them, else techniques or scenes. */
function tellApart(points, x) {
  const groups = distinct(points.map(({ row }) => row.group));
  for (const point of points)
    point.name = nameOf(point.row, x) + (groups.length > 1 ? `, ${groupName(point.row.group)}` : "");
  const names = distinct(points.map(({ name }) => name));
  const is_one = distinct(points.map(({ technique }) => technique)).length === 1;
  return is_one && !x.sweepsScene && names.length <= 16 ? { name: "name", ...scalesOver(names) } : seriesOf(points);
}

/** The error floor at each place, percent. */
const floorsOf = (points, y) =>
  distinct(points.map(({ row }) => row.group))
    .map((group) => levelsOf(points.map(({ row }) => row).filter((row) => row.group === group), y).floor)
    .filter((floor) => floor > 0);

/** From above the largest error of the fewest samples down with one over the root of their number; null of other quantities. */
function guideOf(points, x, y) {
  if (!isSamples(x) || !metrics.includes(y) || y.better !== "lower") return null;
  const xs = points.map((point) => point.x).filter((value) => value > 0);
  const [from, to] = [Math.min(...xs), Math.max(...xs)];
  const first = 1.4 * Math.max(...points.filter((point) => point.x === from).map(({ estimate }) => estimate.value));
  return first > 0 ? [from, to].map((value) => ({ x: value, y: first * Math.sqrt(from / value) })) : null;
}

/** Ticks at the numbers themselves, where they are few. */
function tickAt(axis, values) {
  if (values.length > 9 || values.some((value) => !(value > 0))) return;
  const ticks = new Map(values.map((value) => [axis.at(value), tick(value)]));
  axis.options.ticks = [...ticks.keys()];
  axis.options.tickFormat = (place) => ticks.get(place);
}

/** Points joined where only x differs, with their intervals. `x` is what grows along, `y` the quantity. */
function scalingPlot(points, across, up, x, y, { floors, guide }, width) {
  const at = { x: (point) => across.at(point.x), y: (point) => up.at(point.estimate.value) };
  const by = tellApart(points, x);
  const bars = { x: at.x, y1: ({ estimate }) => up.at(estimate.low), y2: ({ estimate }) => up.at(estimate.high) };
  const along = { x: at.x, y: (point) => up.at(point.y) };
  const beside = { fill: "var(--muted)", stroke: "var(--surface)", strokeWidth: 4, textAnchor: "start", dx: 10, dy: -9 };
  return plot({
    ...frame(width, clamp(width * 0.58, 300, 440)),
    x: acrossOptions(x.text, across.options),
    y: upOptions(`\u2191 ${y.label}`, up.options),
    color: by.color,
    symbol: { ...by.symbol, legend: true },
    marks: [
      zeroLines({ zero: null }, up),
      floors.map((floor) => floorLine(up, floor)),
      guide && line(guide, { ...along, stroke: "var(--muted)", strokeDasharray: "7 5", strokeWidth: 1.5 }),
      guide && text(guide.slice(0, 1), { ...along, ...beside, text: () => "slope \u22121/2" }),
      line(points, { ...at, z: "line", stroke: by.name, strokeOpacity: 0.65, strokeWidth: 1.5 }),
      ruleX(points.filter(hasInterval), { ...bars, stroke: by.name, strokeWidth: 1.5, strokeOpacity: 0.7 }),
      dot(points, { ...at, stroke: by.name, fill: by.name, fillOpacity: 0.6, symbol: by.name, r: 3.5 }),
      tipOf(points, at, ({ row, seeds, x: value, estimate }) => [
        seeds > 1 ? `${nameOf(row, x)}, mean of ${seeds} seeds` : row.title,
        `${row.scene}, ${row.light}`,
        `${x.text}: ${value.toLocaleString("en")}`,
        `${y.text}: ${y.shown(estimate.value)}${between(estimate, y.shown)} ${y.unit}`,
      ]),
    ],
  });
}

const hasInterval = ({ estimate }) => estimate.low !== null;

function captionOf(points, across, up, x, { floors, guide }) {
  const seeds = Math.max(...points.map((point) => point.seeds));
  return joined([
    across.isLog && up.isLog ? "Both axes are logarithmic." : across.isLog && "The horizontal axis is logarithmic.",
    `A line joins rows that differ in ${x.text} alone.`,
    seeds > 1
      ? `Points are means of up to ${plural(seeds, "seed")}, bars reach from the smallest to the largest.`
      : points.some(hasInterval) && "Bars are 95 % intervals.",
    floors.length > 0 && "Dotted: the error floor, what the reference's own noise makes; below it nothing can be told from 0.",
    guide && "Dashed: how the error of independent samples falls, with one over the root of their number.",
  ]);
}

export function scalingCard(redraw) {
  const xs = growing();
  const ys = [...stages, ...events.filter((event) => event.name !== "resolve"), ...memory, ...metrics];
  if (xs.length === 0 || ys.length === 0) return null;
  const lights = distinct(data.rows.filter(isOk).map((row) => row.light));
  const along = chooser("along", optionsOf(xs), redraw);
  const what = chooser("what", optionsOf(ys), redraw);
  const light = chooser("light", [{ value: "", text: "all" }, ...lights.map((value) => ({ value, text: value }))], redraw);
  // The first choice is x with the most lines.
  const most = (least) => xs.reduce((best, x) => (lines(x, least) > lines(best, least) ? x : best), xs[0]);
  along.value = (lines(most(3), 3) > 0 ? most(3) : most(2)).name;
  const has_error = data.rows.some(isSoft) && metrics.some(({ name }) => name === "error");
  const is_convergence = has_error && isSamples(named(xs, along.value));
  what.value = named(ys, is_convergence ? "error" : "resolve").name;

  function draw(width) {
    const [x, y] = [named(xs, along.value), named(ys, what.value)];
    const pointOf = (row) => {
      const place = { x: x.of(row), estimate: y.of(row), line: lineOf(row, x) };
      return { row, technique: row.technique, scene: row.scene, ...place };
    };
    const rows = filteredRows().filter((row) => isOk(row) && (!light.value || row.light === light.value));
    const all = rows.map(pointOf).filter((point) => point.x !== null && point.estimate);
    all.sort((p, q) => p.x - q.x);
    // A single point does not show growth.
    const points = overSeeds(all.filter(({ line, x: value }) => all.some((other) => other.line === line && other.x !== value)));
    if (points.length === 0) return { empty: "No row here has both." };
    const ends = points.flatMap(({ estimate: { value, low, high } }) => [value, low, high].filter((end) => end !== null));
    const floors = floorsOf(points, y);
    const across = logAxis(points.map((point) => point.x));
    const wished = guideOf(points, x, y);
    const axis = logAxis([...ends, ...floors, ...(wished ?? []).map((end) => end.y)]);
    if (isSamples(x) && across.isLog) tickAt(across, distinct(points.map((point) => point.x)));
    // The guide is straight where both axes are logarithmic.
    const guide = across.isLog && axis.isLog ? wished : null;
    const up = guide || !wished ? axis : logAxis([...ends, ...floors]);
    const lines = { floors, guide };
    return { plot: scalingPlot(points, across, up, x, y, lines, width), caption: captionOf(points, across, up, x, lines) };
  }
  const lead = "How cost grows, and how error falls with samples.";
  return { name: "scaling", title: "Scaling", lead, controls: [along.element, what.element, light.element], draw };
}
