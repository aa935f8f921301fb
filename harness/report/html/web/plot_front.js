// Error against cost: each point a setting, the line through those that no other beats in both.

import { dot, line, plot, ruleX, ruleY, text, tip, pointer } from "@observablehq/plot";

import { between, colorScale, frame, logAxis, symbolScale, usedBy } from "./axes.js";
import { distinct, isOk } from "./data.js";
import { chooser, plural } from "./dom.js";
import { placeList } from "./places.js";
import { events, memory, metrics, named, optionsOf, stages } from "./quantities.js";

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
      title: row.title,
      technique: row.technique,
      role: row.role,
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
      x: Math.exp(cost_sum / all.length),
      y: all.reduce((sum, point) => sum + point.y, 0) / all.length,
      low: null,
      high: null,
      note: "",
    };
  });
  return { points: groups.length ? points : [], groups };
}

/** Points whose names have room: none so near to the one before that its name would run into it. */
function labeled(front, left, top) {
  const kept = [];
  for (const point of front) {
    const is_near = (other) => Math.abs(left(point) - left(other)) < 130 && Math.abs(top(point) - top(other)) < 15;
    if (!kept.some(is_near)) kept.push(point);
  }
  return kept;
}

export function frontCard(redraw) {
  const costs = [...events, ...stages.filter((stage) => stage.name !== "resolve"), ...memory];
  if (costs.length === 0 || metrics.length === 0) return null;
  const where = placeList("where", isOk, redraw, true);
  if (!where) return null;
  const error = chooser("error", optionsOf(metrics), redraw, { name: "error" });
  const cost = chooser("cost", optionsOf(costs), redraw, { name: "cost" });
  error.value = "wrong_rate";
  cost.value = costs.some(({ name }) => name === "light") ? "light" : costs[0].name;

  function draw(width) {
    const x = named(costs, cost.value),
      y = named(metrics, error.value);
    const rows = where.rows();
    const over = where.isAll ? pointsOverAll(rows, x, y) : { points: rows.map((row) => pointOf(row, x, y)).filter(Boolean) };
    if (over.points.length === 0)
      return {
        empty:
          over.groups && rows.length
            ? "No scene and light were finished by every setting that passes the filter: choose one of them, or filter the settings."
            : "No row here has both.",
      };
    const flip = y.better === "higher" ? -1 : 1;
    over.points.forEach((point) => (point.error = flip * point.y));
    const front = frontOf(over.points.filter((point) => point.role === "contender"));
    const ends = over.points.flatMap((point) => [point.x, point.low, point.high].filter((value) => value !== null));
    const across = logAxis(ends),
      up = logAxis(over.points.map((point) => point.y));
    const at = { x: (point) => across.at(point.x), y: (point) => up.at(point.y) };
    const says = (point) =>
      [point.title, `${y.text}: ${y.shown(point.y)} ${y.unit}`, `${x.text}: ${x.shown(point.x)}${point.note} ${x.unit}`].join(
        "\n",
      );
    const height = Math.max(320, Math.min(480, width * 0.62));
    const labels = labeled(
      front,
      (point) => across.share(point.x) * width,
      (point) => up.share(point.y) * height,
    );
    const label = (points, place) =>
      text(points, {
        ...at,
        ...place,
        text: "title",
        fill: "var(--ink)",
        stroke: "var(--surface)",
        strokeWidth: 4,
        lineWidth: 17,
        textOverflow: "ellipsis",
      });
    return {
      plot: plot({
        ...frame(width),
        height,
        x: { ...across.options, label: `${x.label} \u2192`, labelAnchor: "right", labelArrow: "none", grid: true },
        y: {
          ...up.options,
          reverse: flip < 0,
          label: flip < 0 ? `${y.label}, higher is better` : `\u2191 ${y.label}`,
          labelArrow: "none",
          grid: true,
        },
        color: usedBy(over.points, colorScale),
        symbol: { ...usedBy(over.points, symbolScale), legend: true },
        marks: [
          up.zero !== null && ruleY([up.zero], { stroke: "var(--muted)", strokeDasharray: "2 4" }),
          across.zero !== null && ruleX([across.zero], { stroke: "var(--muted)", strokeDasharray: "2 4" }),
          line(front, { ...at, curve: "step-after", stroke: "var(--ink)", strokeOpacity: 0.55, strokeWidth: 1.5 }),
          ruleY(
            over.points.filter((point) => point.low !== null),
            {
              x1: (point) => across.at(point.low),
              x2: (point) => across.at(point.high),
              y: at.y,
              stroke: "technique",
              strokeWidth: 1.5,
              strokeOpacity: 0.8,
            },
          ),
          dot(over.points, {
            ...at,
            stroke: "technique",
            fill: "technique",
            fillOpacity: (point) => (point.role === "contender" ? 0.85 : 0.15),
            symbol: "technique",
            r: 5,
          }),
          label(
            labels.filter((point) => across.share(point.x) < 0.4),
            { dx: 8, dy: -10, textAnchor: "start" },
          ),
          label(
            labels.filter((point) => across.share(point.x) >= 0.4),
            { dx: -8, dy: 11, textAnchor: "end" },
          ),
          tip(over.points, pointer({ ...at, title: says, fontSize: 12 })),
        ].filter(Boolean),
      }),
      caption: [
        where.isAll
          ? `Mean error and geometric mean cost over ${plural(over.groups.length, "place", "places")} that every setting here finished. `
          : "",
        "The line joins contenders that none beats in both. ",
        over.points.some((point) => point.low !== null) ? "Bars are 95 % intervals. " : "",
        over.points.some((point) => point.role !== "contender") ? "Hollow: baseline and reference." : "",
      ].join(""),
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
