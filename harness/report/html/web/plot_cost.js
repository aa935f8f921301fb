// What a mask costs, by the stage that is paid for it.

import { barX, plot, pointerY, stackX, text, tip } from "@observablehq/plot";

import { acrossOptions, between, frame } from "./axes.js";
import { data, isOk, sum } from "./data.js";
import { milliseconds, tick } from "./digits.js";
import { linesOf, toggle } from "./dom.js";
import { placeList } from "./places.js";
import { stages } from "./quantities.js";

/** What is paid in a frame in which geometry moves, in the place of build, relight and resolve. */
const paid_by_motion = new Set(["update", "moving_relight", "moving_resolve"]);

export function costCard(redraw) {
  let with_setup = false;
  let is_moving = false;
  const where = placeList("where", (row) => isOk(row) && row.stages.resolve, redraw);
  if (!where) return null;

  function draw(width) {
    const rows = where.rows().filter((row) => !is_moving || row.costs.motion);
    if (rows.length === 0) return { empty: is_moving ? "No row here has a time of moving geometry." : "No row here passes the filter." };
    const shown = stages.filter(({ name }) => (name === "setup" ? with_setup : paid_by_motion.has(name) === is_moving));
    const names = shown.map((stage) => stage.name);
    const partsOf = (row) => shown.map((stage) => ({ key: String(row.index), stage: stage.name, estimate: stage.of(row) }));
    const parts = rows.flatMap(partsOf).filter((part) => part.estimate);
    const partsAt = (key) => parts.filter((part) => part.key === key);
    const keys = rows.map((row) => String(row.index));
    const total = new Map(keys.map((key) => [key, sum(partsAt(key).map((part) => part.estimate.value))]));
    const order = keys.sort((p, q) => total.get(p) - total.get(q));
    const title = (key) => data.rows[key].title;
    const longest = Math.max(...rows.map((row) => row.title.length));
    const margin = Math.min(Math.max(70, longest * 6.6 + 16), width * 0.42);
    const letters = Math.floor((margin - 14) / 6.6);
    const wrapped = (key) => linesOf(title(key), letters);
    const height = Math.max(24, 6 + 14 * Math.max(...keys.map((key) => wrapped(key).length)));
    const inset = Math.max(1, (height - 22) / 2);
    const said = ({ stage, estimate }) => `${stage}: ${milliseconds(estimate.value)}${between(estimate, milliseconds)} ms`;
    const says = (key) => [title(key), ...partsAt(key).map(said)].join("\n");
    const bars = stackX({ x: (part) => part.estimate.value, y: "key", fill: "stage", order: names });
    const at = { x: (key) => total.get(key), y: (key) => key };
    const beside = { dx: 6, textAnchor: "start", fill: "var(--ink)" };
    return {
      plot: plot({
        ...frame(width, 54 + height * rows.length),
        marginLeft: margin,
        marginRight: 64,
        marginTop: 8,
        x: acrossOptions("milliseconds", { tickFormat: tick, ticks: Math.max(3, Math.floor((width - margin) / 90)) }),
        y: { domain: order, label: null, tickFormat: (key) => wrapped(key).join("\n"), tickSize: 0 },
        color: { domain: names, range: names.map((name) => `var(--stage-${name.replace("moving_", "")})`), legend: true },
        marks: [
          barX(parts, { ...bars, insetTop: inset, insetBottom: inset }),
          text(order, { ...at, ...beside, text: (key) => milliseconds(total.get(key)) }),
          tip(order, pointerY({ ...at, title: says, fontSize: 12 })),
        ],
      }),
      caption: is_moving
        ? "Update, relight and resolve are paid in every frame in which geometry moves."
        : "Build is paid for another scene, relight when the light moves, resolve when the camera moves.",
    };
  }
  const setup = toggle("with setup", (on) => { with_setup = on; redraw(); });
  const moving = toggle("geometry moves", (on) => { is_moving = on; redraw(); });
  const can_move = data.rows.some((row) => row.costs.motion);
  const lead = "What is paid when, for one scene and light.";
  return { name: "cost", title: "Cost by stage", lead, controls: [where.element, setup, ...(can_move ? [moving] : [])], draw };
}
