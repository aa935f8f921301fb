// How a cost or an error grows with triangles, pixels or a parameter.

import { dot, line, plot, ruleX } from "@observablehq/plot";

import { acrossOptions, between, frame, logAxis, seriesOf, tipOf, upOptions, zeroLines } from "./axes.js";
import { data, distinct, isOk, valueOf } from "./data.js";
import { chooser } from "./dom.js";
import { filteredRows } from "./filter.js";
import { calledFor, events, memory, metrics, named, optionsOf, stages } from "./quantities.js";

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

/** Rows of one line: all is equal but what grows. */
function lineOf(row, x) {
  const parameters = Object.entries(row.parameters).filter(([name]) => name !== x.parameter);
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

/** Points joined where only x differs, with their intervals. `x` is what grows along, `y` the quantity. */
function scalingPlot(points, across, up, x, y, width) {
  const at = { x: (point) => across.at(point.x), y: (point) => up.at(point.estimate.value) };
  const by = seriesOf(points);
  const bars = { x: at.x, y1: ({ estimate }) => up.at(estimate.low), y2: ({ estimate }) => up.at(estimate.high) };
  return plot({
    ...frame(width),
    height: Math.max(300, Math.min(440, width * 0.58)),
    x: acrossOptions(across, x.text),
    y: upOptions(up, `\u2191 ${y.label}`),
    color: by.color,
    symbol: { ...by.symbol, legend: true },
    marks: [
      ...zeroLines({ zero: null }, up),
      line(points, { ...at, z: "line", stroke: by.name, strokeOpacity: 0.65, strokeWidth: 1.5 }),
      ruleX(points.filter(hasInterval), { ...bars, stroke: by.name, strokeWidth: 1.5, strokeOpacity: 0.7 }),
      dot(points, { ...at, stroke: by.name, fill: by.name, fillOpacity: 0.6, symbol: by.name, r: 3.5 }),
      tipOf(points, at, ({ row, x: value, estimate }) => [
        row.title,
        `${row.scene}, ${row.light}`,
        `${x.text}: ${value.toLocaleString("en")}`,
        `${y.text}: ${y.shown(estimate.value)}${between(estimate, y.shown)} ${y.unit}`,
      ]),
    ],
  });
}

const hasInterval = ({ estimate }) => estimate.low !== null;

function captionOf(points, across, up, x) {
  const logarithmic =
    across.isLog && up.isLog ? "Both axes are logarithmic. " : across.isLog ? "The horizontal axis is logarithmic. " : "";
  const bars = points.some(hasInterval) ? " Bars are 95 % intervals." : "";
  return `${logarithmic}A line joins rows that differ in ${x.text} alone.${bars}`;
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
  what.value = ys.some(({ name }) => name === "resolve") ? "resolve" : ys[0].name;

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
    const points = all.filter(({ line, x: value }) => all.some((other) => other.line === line && other.x !== value));
    if (points.length === 0) return { empty: "No row here has both." };
    const ends = points.flatMap(({ estimate }) =>
      [estimate.value, estimate.low, estimate.high].filter((value) => value !== null),
    );
    const across = logAxis(points.map((point) => point.x)),
      up = logAxis(ends);
    const called = calledFor(
      y,
      points.map((point) => point.row),
    );
    return { plot: scalingPlot(points, across, up, x, called, width), caption: captionOf(points, across, up, x) };
  }
  return {
    name: "scaling",
    title: "Scaling",
    lead: "How cost and error grow.",
    controls: [along.element, what.element, light.element],
    draw,
  };
}
