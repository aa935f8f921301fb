// Rows that follow a path: what changes from frame to frame.

import { dot, line, plot } from "@observablehq/plot";

import { frame, settingsOf, tipOf } from "./axes.js";
import { columnNamed, data, distinct, isOk } from "./data.js";
import { measured, tick } from "./digits.js";
import { chooser } from "./dom.js";
import { placeList } from "./places.js";

export function framesCard(redraw) {
  const names = distinct(
    data.rows.flatMap((row) => Object.keys(row.frames).filter((name) => row.frames[name].some((value) => value !== null))),
  );
  const ordered = data.metrics.map((metric) => metric.name).filter((name) => names.includes(name));
  const where = placeList("path", (row) => isOk(row) && Object.keys(row.frames).length > 0, redraw);
  if (!where || ordered.length === 0) return null;
  const metric = chooser(
    "metric",
    ordered.map((name) => ({ value: name, text: columnNamed(name)?.heading ?? name })),
    redraw,
    { name: "metric" },
  );
  metric.value = ordered.includes("instability") ? "instability" : ordered.includes("error") ? "error" : ordered[0];

  function draw(width) {
    const column = columnNamed(metric.value);
    const scale = column?.scale ?? 1,
      unit = column?.shown_unit ?? "";
    const points = where
      .rows()
      .filter((row) => row.frames[metric.value])
      .flatMap((row) =>
        row.frames[metric.value].map((value, index) => ({
          row,
          technique: row.technique,
          scene: row.scene,
          title: row.title,
          frame: index,
          value: value === null ? NaN : value * scale,
        })),
      );
    const there = points.filter((point) => !Number.isNaN(point.value));
    if (there.length === 0) return { empty: "No row here has frames of this metric." };
    const by = settingsOf(there);
    const name = column?.heading ?? metric.value;
    return {
      plot: plot({
        ...frame(width),
        height: Math.max(280, Math.min(400, width * 0.5)),
        x: {
          label: "frame \u2192",
          labelAnchor: "right",
          labelArrow: "none",
          tickFormat: (value) => (Number.isInteger(value) ? String(value) : ""),
        },
        y: {
          label: `\u2191 ${name}${unit ? ` (${unit})` : ""}`,
          labelArrow: "none",
          grid: true,
          zero: true,
          nice: true,
          tickFormat: tick,
        },
        color: by.color,
        symbol: { ...by.symbol, legend: true },
        marks: [
          line(points, { x: "frame", y: "value", z: (point) => point.row.index, stroke: by.name, strokeWidth: 1.75 }),
          dot(there, { x: "frame", y: "value", stroke: by.name, fill: by.name, symbol: by.name, r: 2.5 }),
          tipOf(there, { x: "frame", y: "value" }, ({ row, frame: index, value }) => [
            row.title,
            `frame ${index}`,
            `${measured(value)} ${unit}`,
          ]),
        ],
      }),
      caption: "Frames count from 0. A metric that looks at the frame before has no value at the first.",
    };
  }
  return {
    name: "frames",
    title: "Along the path",
    lead: "What flickers while camera or light moves.",
    controls: [where.element, metric.element],
    draw,
  };
}
