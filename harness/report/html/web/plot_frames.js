// Rows that follow a path: what changes from frame to frame.

import { dot, line, plot } from "@observablehq/plot";

import { acrossOptions, frame, settingsOf, tipOf, upOptions } from "./axes.js";
import { clamp, columnNamed, data, isOk } from "./data.js";
import { measured, tick } from "./digits.js";
import { chooser } from "./dom.js";
import { placeList } from "./places.js";

export function framesCard(redraw) {
  const hasFrames = (name) => data.rows.some((row) => row.frames[name]?.some((value) => value !== null));
  const names = data.metrics.map((metric) => metric.name).filter(hasFrames);
  const where = placeList("path", (row) => isOk(row) && Object.keys(row.frames).length > 0, redraw);
  if (!where || names.length === 0) return null;
  const options = names.map((name) => ({ value: name, text: columnNamed(name)?.heading ?? name }));
  const metric = chooser("metric", options, redraw);
  metric.value = ["instability", "error"].find((name) => names.includes(name)) ?? names[0];

  function draw(width) {
    const column = columnNamed(metric.value);
    const unit = column?.shown_unit ?? "";
    const pointsOf = (row) => {
      const setting = { row, technique: row.technique, scene: row.scene, title: row.title };
      const scaled = (value) => (value === null ? NaN : value * (column?.scale ?? 1));
      return (row.frames[metric.value] ?? []).map((value, index) => ({ ...setting, frame: index, value: scaled(value) }));
    };
    const points = where.rows().flatMap(pointsOf);
    const there = points.filter((point) => !Number.isNaN(point.value));
    if (there.length === 0) return { empty: "No row here has frames of this metric." };
    const by = settingsOf(there);
    const name = column?.heading ?? metric.value;
    return {
      plot: plot({
        ...frame(width, clamp(width * 0.5, 280, 400)),
        x: acrossOptions("frame", { grid: false, tickFormat: (value) => (Number.isInteger(value) ? String(value) : "") }),
        y: upOptions(`\u2191 ${name}${unit ? ` (${unit})` : ""}`, { zero: true, nice: true, tickFormat: tick }),
        color: by.color,
        symbol: { ...by.symbol, legend: true },
        marks: [
          line(points, { x: "frame", y: "value", z: (point) => point.row.index, stroke: by.name, strokeWidth: 1.75 }),
          dot(there, { x: "frame", y: "value", stroke: by.name, fill: by.name, symbol: by.name, r: 2.5 }),
          tipOf(there, { x: "frame", y: "value" }, (point) => [
            point.title,
            `frame ${point.frame}`,
            `${measured(point.value)} ${unit}`,
          ]),
        ],
      }),
      caption: "Frames count from 0. A metric that looks at the frame before has no value at the first.",
    };
  }
  const lead = "What flickers while something moves.";
  return { name: "frames", title: "Along the path", lead, controls: [where.element, metric.element], draw };
}
