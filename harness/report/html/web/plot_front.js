// Error against cost: each point is a setting, the line joins those that no other beats in both.

import { dot, line, plot, ruleY, text } from "@observablehq/plot";

import { acrossOptions, between, floorLine, frame, logAxis, techniqueScales, tipOf, upOptions, zeroLines } from "./axes.js";
import { clamp, distinct, gainOverConstant, isOk, joined, mean, sum } from "./data.js";
import { chooser, plural } from "./dom.js";
import { placeList } from "./places.js";
import { events, levelsOf, memory, metrics, named, optionsOf, stages } from "./quantities.js";

/** Points that none beats in both, by cost. */
function frontOf(points) {
  const front = [];
  for (const point of [...points].sort((p, q) => p.x - q.x || p.error - q.error))
    if (front.length === 0 || point.error < front.at(-1).error) front.push(point);
  return front;
}

function pointOf(row, cost, metric) {
  const [x, y] = [cost.of(row), metric.of(row)];
  const setting = { rows: [row], title: row.title, technique: row.technique, role: row.role };
  const place = x && y && { x: x.value, low: x.low, high: x.high, y: y.value, note: between(x, cost.shown) };
  return place && { ...setting, ...place, gain: gainOverConstant(row) };
}

/** One point a setting: mean error and geometric mean cost over the groups that all settings finished. */
function pointsOverAll(rows, cost, metric) {
  const settings = new Map();
  for (const row of rows) {
    const point = pointOf(row, cost, metric);
    const key = `${row.technique}\n${row.title}`;
    if (!settings.has(key)) settings.set(key, new Map());
    if (point) settings.get(key).set(row.group, point);
  }
  const measured = [...settings.values()].filter((points) => points.size > 0);
  const groups = distinct(rows.map((row) => row.group)).filter((group) => measured.every((points) => points.has(group)));
  const points = measured.map((setting) => {
    const all = groups.map((group) => setting.get(group));
    const x = Math.exp(mean(all.map((point) => Math.log(Math.max(point.x, 1e-9)))));
    const [y, gain] = [mean(all.map((point) => point.y)), sum(all.map((point) => point.gain))];
    return { ...all[0], rows: all.flatMap((point) => point.rows), x, y, gain, low: null, high: null, note: "" };
  });
  return { points: groups.length ? points : [], groups };
}

/** Points whose names have room: none so near to the one before that its name would run into it. */
function labeled(front, left, top) {
  const chosen = [];
  for (const point of front) {
    const isNear = (other) => Math.abs(left(point) - left(other)) < 130 && Math.abs(top(point) - top(other)) < 15;
    if (!chosen.some(isNear)) chosen.push(point);
  }
  return chosen;
}

/** Names beside points: to the right of those on the left of the plot, to the left of the others. */
function nameMarks(points, at, isLeft) {
  const ink = { fill: "var(--ink)", stroke: "var(--surface)", strokeWidth: 4 };
  const mark = (some, place) => text(some, { ...at, ...place, ...ink, text: "title", lineWidth: 17, textOverflow: "ellipsis" });
  const right = points.filter((point) => !isLeft(point));
  return [
    mark(points.filter(isLeft), { dx: 8, dy: -10, textAnchor: "start" }),
    mark(right, { dx: -8, dy: 11, textAnchor: "end" }),
  ];
}

/** Points with their intervals, and the line through the front. `x` and `y` are the quantities, `levels` those of y. */
function frontPlot(points, x, y, { floor, constant }, width) {
  const isFlipped = y.better === "higher";
  // Errors up to the floor may be the reference's own noise: they count as equal.
  const ranked = (point) => (point.y <= (levelsOf(point.rows, y).floor ?? -Infinity) ? 0 : point.y);
  points.forEach((point) => (point.error = isFlipped ? -point.y : ranked(point)));
  const front = frontOf(points.filter((point) => point.role === "contender" && point.gain > 0));
  const across = logAxis(points.flatMap((point) => [point.x, point.low, point.high].filter((value) => value !== null)));
  const up = logAxis([...points.map((point) => point.y), ...[floor, constant].filter((level) => level > 0)]);
  const at = { x: (point) => across.at(point.x), y: (point) => up.at(point.y) };
  const height = clamp(width * 0.62, 320, 480);
  const [left, top] = [(point) => across.share(point.x) * width, (point) => up.share(point.y) * height];
  const barred = points.filter((point) => point.low !== null);
  const bars = { x1: (point) => across.at(point.low), x2: (point) => across.at(point.high), y: at.y };
  const fillOpacity = (point) => (point.role === "contender" ? 0.85 : 0.15);
  const { color, symbol } = techniqueScales(points);
  return plot({
    ...frame(width, height),
    x: acrossOptions(x.label, across.options),
    y: { ...upOptions(isFlipped ? `${y.label}, higher is better` : `\u2191 ${y.label}`, up.options), reverse: isFlipped },
    color,
    symbol: { ...symbol, legend: true },
    marks: [
      zeroLines(across, up),
      floor > 0 ? floorLine(up, floor) : null,
      constant > 0 ? ruleY([up.at(constant)], { stroke: "var(--ink)", strokeOpacity: 0.6, strokeDasharray: "6 4" }) : null,
      line(front, { ...at, curve: "step-after", stroke: "var(--ink)", strokeOpacity: 0.55, strokeWidth: 1.5 }),
      ruleY(barred, { ...bars, stroke: "technique", strokeWidth: 1.5, strokeOpacity: 0.8 }),
      dot(points, { ...at, stroke: "technique", fill: "technique", fillOpacity, symbol: "technique", r: 5 }),
      nameMarks(labeled(front, left, top), at, (point) => across.share(point.x) < 0.4),
      tipOf(points, at, (point) => [
        point.title,
        `${y.text}: ${y.shown(point.y)} ${y.unit}`,
        `${x.text}: ${x.shown(point.x)}${point.note} ${x.unit}`,
      ]),
    ],
  });
}

/** A sentence for each kind of mark in the plot; `groups` are those of means, undefined where a single place is shown. */
const captionOf = (points, groups, { floor, constant }) =>
  joined([
    groups && `Mean error and geometric mean cost over ${plural(groups.length, "place")} that every setting here finished.`,
    `The line joins contenders that none beats in both${constant > 0 ? ", of those that beat a constant mask" : ""}.`,
    points.some((point) => point.low !== null) && "Bars are 95 % intervals.",
    points.some((point) => point.role !== "contender") && "Hollow: baseline and reference.",
    floor > 0 && "Dotted: the error floor, what the reference's own noise makes.",
    constant > 0 && "Dashed: the best constant mask.",
  ]);

export function frontCard(redraw) {
  const costs = [...events, ...stages.filter((stage) => stage.name !== "resolve"), ...memory];
  if (costs.length === 0 || metrics.length === 0) return null;
  const where = placeList("where", isOk, redraw, true);
  if (!where) return null;
  const error = chooser("error", optionsOf(metrics), redraw);
  const cost = chooser("cost", optionsOf(costs), redraw);
  error.value = named(metrics, "error").name;
  cost.value = named(costs, "light").name;

  function draw(width) {
    const [x, y] = [named(costs, cost.value), named(metrics, error.value)];
    const rows = where.rows();
    const pointsHere = () => rows.map((row) => pointOf(row, x, y)).filter(Boolean);
    const { points, groups } = where.isAll() ? pointsOverAll(rows, x, y) : { points: pointsHere() };
    const levels = levelsOf(points.flatMap((point) => point.rows), y);
    if (points.length > 0) return { plot: frontPlot(points, x, y, levels, width), caption: captionOf(points, groups, levels) };
    if (!groups || rows.length === 0) return { empty: "No row here has both." };
    const unfinished = "No scene and light were finished by every setting that passes the filter";
    return { empty: `${unfinished}: choose one of them, or filter the settings.` };
  }
  const lead = "Which settings are worth having? Lower left is better.";
  return { name: "front", title: "Error against cost", lead, controls: [where.element, error.element, cost.element], draw };
}
