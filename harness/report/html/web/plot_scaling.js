// How a cost or an error grows with triangles, pixels or a parameter.

import { dot, line, plot, ruleX, ruleY, text } from "@observablehq/plot";

import { acrossOptions, between, frame, logAxis, scalesOver, seriesOf, tipOf, upOptions, zeroLines } from "./axes.js";
import { data, distinct, groupName, isOk, isSoft, valueOf } from "./data.js";
import { tick } from "./digits.js";
import { chooser, plural } from "./dom.js";
import { filteredRows } from "./filter.js";
import { events, levelsOf, memory, metrics, named, optionsOf, stages } from "./quantities.js";

/** Along these the error of independent samples falls with the root of their number. */
const isSamples = (x) => /(^|_)samples$/.test(x.parameter ?? "");
const seed = "seed"; // the parameter that rows may differ in and be the same setting

/** What may grow: name, text, of(row) -> number or null, and whether it grows with the scene. */
function growing() {
  const parameters = distinct(data.rows.flatMap((row) => Object.keys(row.parameters)));
  const all = [
    { name: "triangles", text: "triangles", of: (row) => valueOf(row, "triangles"), sweepsScene: true },
    { name: "pixels", text: "pixels", of: (row) => data.groups[row.group].width * data.groups[row.group].height || null },
    ...parameters.map((name) => ({
      name: `parameter.${name}`,
      text: name,
      parameter: name,
      of: (row) => (typeof row.parameters[name] === "number" ? row.parameters[name] : null),
    })),
  ];
  return all.filter((x) => lines(x, 2) > 0);
}

/** How many lines along x have at least so many places on it. */
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

/** Rows of one line: all is equal but what grows, and the seed. */
function lineOf(row, x) {
  const parameters = Object.entries(row.parameters).filter(([name]) => name !== x.parameter && name !== seed);
  const { view, path, width, height, truth } = data.groups[row.group];
  const size = x.name === "pixels" ? "" : `${width}x${height}`;
  return JSON.stringify([
    row.technique,
    parameters,
    x.sweepsScene ? row.family : row.scene,
    row.light,
    view,
    path,
    size,
    truth,
  ]);
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
    const value = values.reduce((sum, one) => sum + one, 0) / values.length;
    return { ...same[0], seeds: same.length, estimate: { value, low: Math.min(...values), high: Math.max(...values) } };
  });
}

/** What colors tell apart: the lines by their names where one technique has few of them, else techniques or scenes. */
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
  const xs = points.map((point) => point.x).filter((value) => value > 0),
    from = Math.min(...xs),
    to = Math.max(...xs);
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
  const along = { x: (point) => across.at(point.x), y: (point) => up.at(point.y) };
  const said = { fill: "var(--muted)", stroke: "var(--surface)", strokeWidth: 4, textAnchor: "start", dx: 10, dy: -9 };
  return plot({
    ...frame(width),
    height: Math.max(300, Math.min(440, width * 0.58)),
    x: acrossOptions(across, x.text),
    y: upOptions(up, `\u2191 ${y.label}`),
    color: by.color,
    symbol: { ...by.symbol, legend: true },
    marks: [
      ...zeroLines({ zero: null }, up),
      ...floors.map((floor) => ruleY([up.at(floor)], { stroke: "var(--ink)", strokeDasharray: "1 4" })),
      ...(guide ? [line(guide, { ...along, stroke: "var(--muted)", strokeDasharray: "7 5", strokeWidth: 1.5 })] : []),
      ...(guide ? [text(guide.slice(0, 1), { ...along, ...said, text: () => "slope \u22121/2" })] : []),
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
  return [
    across.isLog && up.isLog ? "Both axes are logarithmic." : across.isLog && "The horizontal axis is logarithmic.",
    `A line joins rows that differ in ${x.text} alone.`,
    seeds > 1
      ? `Points are means of up to ${plural(seeds, "seed")}, bars reach from the smallest to the largest.`
      : points.some(hasInterval) && "Bars are 95 % intervals.",
    floors.length > 0 && "Dotted: the error floor, what the reference's own noise makes; below it nothing can be told from 0.",
    guide && `Dashed: how the error of independent samples falls, with one over the root of their number.`,
  ]
    .filter(Boolean)
    .join(" ");
}

export function scalingCard(redraw) {
  const xs = growing();
  const ys = [...stages, ...events.filter((event) => event.name !== "resolve"), ...memory, ...metrics];
  if (xs.length === 0 || ys.length === 0) return null;
  const lights = distinct(data.rows.filter(isOk).map((row) => row.light));
  const along = chooser("along", optionsOf(xs), redraw, { name: "along" });
  const what = chooser("what", optionsOf(ys), redraw, { name: "what" });
  const light = chooser("light", [{ value: "", text: "all" }, ...lights.map((value) => ({ value, text: value }))], redraw, {
    name: "light",
  });
  // What was swept most.
  const most = (least) => xs.reduce((best, x) => (lines(x, least) > lines(best, least) ? x : best), xs[0]);
  along.value = (lines(most(3), 3) > 0 ? most(3) : most(2)).name;
  const is_convergence = isSamples(named(xs, along.value)) && data.rows.some(isSoft) && metrics.some(({ name }) => name === "error");
  const wanted = is_convergence ? "error" : "resolve";
  what.value = ys.some(({ name }) => name === wanted) ? wanted : ys[0].name;

  function draw(width) {
    const x = xs.find(({ name }) => name === along.value),
      y = named(ys, what.value);
    const all = filteredRows()
      .filter((row) => isOk(row) && (!light.value || row.light === light.value))
      .map((row) => ({
        row,
        technique: row.technique,
        scene: row.scene,
        x: x.of(row),
        estimate: y.of(row),
        line: lineOf(row, x),
      }))
      .filter((point) => point.x !== null && point.estimate)
      .sort((p, q) => p.x - q.x);
    // A single point says nothing of growth.
    const points = overSeeds(all.filter(({ line, x: value }) => all.some((other) => other.line === line && other.x !== value)));
    if (points.length === 0) return { empty: "No row here has both." };
    const ends = points.flatMap(({ estimate }) =>
      [estimate.value, estimate.low, estimate.high].filter((value) => value !== null),
    );
    const floors = floorsOf(points, y);
    const across = logAxis(points.map((point) => point.x)),
      wished = guideOf(points, x, y),
      axis = logAxis([...ends, ...floors, ...(wished ?? []).map((end) => end.y)]);
    if (isSamples(x) && across.isLog) tickAt(across, distinct(points.map((point) => point.x)));
    // A slope is one where both axes are logarithmic.
    const guide = across.isLog && axis.isLog ? wished : null,
      up = guide || !wished ? axis : logAxis([...ends, ...floors]);
    const lines = { floors, guide };
    return {
      plot: scalingPlot(points, across, up, x, y, lines, width),
      caption: captionOf(points, across, up, x, lines),
    };
  }
  return {
    name: "scaling",
    title: "Scaling",
    lead: "How cost grows, and how error falls with samples.",
    controls: [along.element, what.element, light.element],
    draw,
  };
}
