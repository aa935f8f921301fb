// What a mask costs, by the stage that is paid for it.

import { barX, plot, pointerY, stackX, text, tip } from "@observablehq/plot";

import { between, frame } from "./axes.js";
import { data, isOk } from "./data.js";
import { milliseconds, tick } from "./digits.js";
import { toggle } from "./dom.js";
import { placeList } from "./places.js";
import { stages } from "./quantities.js";

export function costCard(redraw) {
  let with_setup = false;
  const where = placeList("where", (row) => isOk(row) && row.stages.resolve, redraw);
  if (!where) return null;

  function draw(width) {
    const rows = where.rows();
    if (rows.length === 0) return { empty: "No row here passes the filter." };
    const shown = stages.filter((stage) => with_setup || stage.name !== "setup");
    const parts = rows.flatMap((row) =>
      shown
        .map((stage) => ({ row, key: String(row.index), stage: stage.name, estimate: stage.of(row) }))
        .filter((part) => part.estimate),
    );
    const total = new Map(
      rows.map((row) => [
        String(row.index),
        parts.filter((part) => part.row === row).reduce((sum, part) => sum + part.estimate.value, 0),
      ]),
    );
    const order = [...total.keys()].sort((p, q) => total.get(p) - total.get(q));
    const title = (key) => data.rows[key].title;
    const longest = Math.max(...rows.map((row) => row.title.length));
    const margin = Math.min(Math.max(70, longest * 6.6 + 16), width * 0.42);
    const letters = Math.floor((margin - 14) / 6.6);
    const short = (name) => (name.length > letters ? `${name.slice(0, letters - 1)}\u2026` : name);
    const says = (key) =>
      [
        title(key),
        ...parts
          .filter((part) => part.key === key)
          .map(({ stage, estimate }) => `${stage}: ${milliseconds(estimate.value)}${between(estimate, milliseconds)} ms`),
      ].join("\n");
    const bars = stackX({ x: (part) => part.estimate.value, y: "key", fill: "stage", order: shown.map((stage) => stage.name) });
    return {
      plot: plot({
        ...frame(width),
        marginLeft: margin,
        marginRight: 64,
        marginTop: 8,
        height: 54 + 24 * rows.length,
        x: {
          label: "milliseconds \u2192",
          labelAnchor: "right",
          labelArrow: "none",
          grid: true,
          tickFormat: tick,
          ticks: Math.max(3, Math.floor((width - margin) / 90)),
        },
        y: { domain: order, label: null, tickFormat: (key) => short(title(key)), tickSize: 0 },
        color: {
          domain: shown.map((stage) => stage.name),
          range: shown.map((stage) => `var(--stage-${stage.name})`),
          legend: true,
        },
        marks: [
          barX(parts, { ...bars, insetTop: 1, insetBottom: 1 }),
          text(order, {
            x: (key) => total.get(key),
            y: (key) => key,
            text: (key) => milliseconds(total.get(key)),
            dx: 6,
            textAnchor: "start",
            fill: "var(--ink)",
          }),
          tip(order, pointerY({ x: (key) => total.get(key), y: (key) => key, title: says, fontSize: 12 })),
        ],
      }),
      caption: "Build is paid when the geometry changes, relight when the light moves, resolve when the camera moves.",
    };
  }
  return {
    name: "cost",
    title: "Cost by stage",
    lead: "What is paid when, for one scene and light.",
    controls: [where.element, toggle("with setup", false, (on) => ((with_setup = on), redraw()))],
    draw,
  };
}
