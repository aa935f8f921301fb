// Error against cost: each point a setting, the line through those that no other beats in both.

import { dot, line, plot, ruleY, text } from "@observablehq/plot";

import { acrossOptions, between, colorScale, frame, logAxis, symbolScale, tipOf, upOptions, usedBy, zeroLines } from "./axes.js";
import { distinct, gainOverConstant, isOk } from "./data.js";
import { chooser, plural } from "./dom.js";
import { placeList } from "./places.js";
import { events, levelsOf, memory, metrics, named, optionsOf, stages } from "./quantities.js";

/** Points that none beats in both, by cost. */
export function frontOf(points) {
  const front = [];
  for (const point of [...points].sort((p, q) => p.x - q.x || p.error - q.error))
    if (front.length === 0 || point.error < front.at(-1).error) front.push(point);
  return front;
}

function pointOf(row, cost, metric) {
  const x = cost.of(row),
    y = metric.of(row);
  return (
    x &&
    y && {
      row,
      rows: [row],
      title: row.title,
      technique: row.technique,
      role: row.role,
      gain: gainOverConstant(row),
      x: x.value,
      low: x.low,
      high: x.high,
      y: y.value,
      note: between(x, cost.shown),
    }
  );
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
    const cost_sum = all.reduce((sum, point) => sum + Math.log(Math.max(point.x, 1e-9)), 0);
    return {
      ...all[0],
      rows: all.map((point) => point.row),
      x: Math.exp(cost_sum / all.length),
      y: all.reduce((sum, point) => sum + point.y, 0) / all.length,
      gain: all.reduce((sum, point) => sum + point.gain, 0),
      low: null,
      high: null,
      note: "",
    };
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
  const mark = (some, place) =>
    text(some, {
      ...at,
      ...place,
      text: "title",
      fill: "var(--ink)",
      stroke: "var(--surface)",
      strokeWidth: 4,
      lineWidth: 17,
      textOverflow: "ellipsis",
    });
  return [
    mark(points.filter(isLeft), { dx: 8, dy: -10, textAnchor: "start" }),
    mark(
      points.filter((point) => !isLeft(point)),
      { dx: -8, dy: 11, textAnchor: "end" },
    ),
  ];
}

/** Points with their intervals, and the line through the front. `x` and `y` are the quantities, `levels` those of y. */
function frontPlot(points, x, y, { floor, constant }, width) {
  const isFlipped = y.better === "higher";
  // Errors that the reference's own noise may make are alike.
  const ranked = (point) => (point.y <= (levelsOf(point.rows, y).floor ?? -Infinity) ? 0 : point.y);
  points.forEach((point) => (point.error = isFlipped ? -point.y : ranked(point)));
  const front = frontOf(points.filter((point) => point.role === "contender" && point.gain > 0));
  const across = logAxis(points.flatMap((point) => [point.x, point.low, point.high].filter((value) => value !== null))),
    up = logAxis([...points.map((point) => point.y), ...[floor, constant].filter((level) => level > 0)]);
  const at = { x: (point) => across.at(point.x), y: (point) => up.at(point.y) };
  const height = Math.max(320, Math.min(480, width * 0.62));
  const names = labeled(
    front,
    (point) => across.share(point.x) * width,
    (point) => up.share(point.y) * height,
  );
  const bars = { x1: (point) => across.at(point.low), x2: (point) => across.at(point.high), y: at.y };
  return plot({
    ...frame(width),
    height,
    x: acrossOptions(across, x.label),
    y: { ...upOptions(up, isFlipped ? `${y.label}, higher is better` : `\u2191 ${y.label}`), reverse: isFlipped },
    color: usedBy(points, colorScale),
    symbol: { ...usedBy(points, symbolScale), legend: true },
    marks: [
      ...zeroLines(across, up),
      ...(floor > 0 ? [ruleY([up.at(floor)], { stroke: "var(--ink)", strokeDasharray: "1 4" })] : []),
      ...(constant > 0 ? [ruleY([up.at(constant)], { stroke: "var(--ink)", strokeOpacity: 0.6, strokeDasharray: "6 4" })] : []),
      line(front, { ...at, curve: "step-after", stroke: "var(--ink)", strokeOpacity: 0.55, strokeWidth: 1.5 }),
      ruleY(
        points.filter((point) => point.low !== null),
        { ...bars, stroke: "technique", strokeWidth: 1.5, strokeOpacity: 0.8 },
      ),
      dot(points, {
        ...at,
        stroke: "technique",
        fill: "technique",
        fillOpacity: (point) => (point.role === "contender" ? 0.85 : 0.15),
        symbol: "technique",
        r: 5,
      }),
      ...nameMarks(names, at, (point) => across.share(point.x) < 0.4),
      tipOf(points, at, (point) => [
        point.title,
        `${y.text}: ${y.shown(point.y)} ${y.unit}`,
        `${x.text}: ${x.shown(point.x)}${point.note} ${x.unit}`,
      ]),
    ],
  });
}

/** What the plot shows; `groups` are those of means, undefined where a single place is shown. */
const captionOf = (points, groups, { floor, constant }) =>
  [
    groups
      ? `Mean error and geometric mean cost over ${plural(groups.length, "place", "places")} that every setting here finished. `
      : "",
    `The line joins contenders that none beats in both${constant > 0 ? ", of those that beat a constant mask" : ""}. `,
    points.some((point) => point.low !== null) ? "Bars are 95 % intervals. " : "",
    points.some((point) => point.role !== "contender") ? "Hollow: baseline and reference. " : "",
    floor > 0 ? "Dotted: the error floor, what the reference's own noise makes. " : "",
    constant > 0 ? "Dashed: the best constant mask." : "",
  ].join("");

export function frontCard(redraw) {
  const costs = [...events, ...stages.filter((stage) => stage.name !== "resolve"), ...memory];
  if (costs.length === 0 || metrics.length === 0) return null;
  const where = placeList("where", isOk, redraw, true);
  if (!where) return null;
  const error = chooser("error", optionsOf(metrics), redraw, { name: "error" });
  const cost = chooser("cost", optionsOf(costs), redraw, { name: "cost" });
  error.value = metrics.some(({ name }) => name === "error") ? "error" : metrics[0].name;
  cost.value = costs.some(({ name }) => name === "light") ? "light" : costs[0].name;

  function draw(width) {
    const x = named(costs, cost.value),
      y = named(metrics, error.value);
    const rows = where.rows();
    const { points, groups } = where.isAll
      ? pointsOverAll(rows, x, y)
      : { points: rows.map((row) => pointOf(row, x, y)).filter(Boolean) };
    const levels = levelsOf(
      points.flatMap((point) => point.rows),
      y,
    );
    if (points.length > 0) return { plot: frontPlot(points, x, y, levels, width), caption: captionOf(points, groups, levels) };
    return {
      empty:
        groups && rows.length
          ? "No scene and light were finished by every setting that passes the filter: choose one of them, or filter the settings."
          : "No row here has both.",
    };
  }
  return {
    name: "front",
    title: "Error against cost",
    lead: "Which settings are worth having? Lower left is better.",
    controls: [where.element, error.element, cost.element],
    draw,
  };
}
