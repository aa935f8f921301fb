// Lines of equal visibility over a picture.

import { isFacing } from "./compose.js";
import { data } from "./data.js";
import { rgb, screenRatio } from "./dom.js";
import { isolines } from "./isolines.js";

/** Dashes of each level in CSS pixels. The middle of the penumbra is a whole line. */
const dashes = [[2, 3], [], [9, 4]];

export const levels = data.contours.levels.map((value, k) => ({ value, dash: dashes[k] }));

/** Widths in CSS pixels: the reference's lines show on both sides of a technique's that lie upon them. */
const inkOf = (ink, core, casing) => ({ ...ink, widths: [casing, core] });
export const inks = {
  reference: inkOf(data.contours.reference, 3.8, 6),
  a: inkOf(data.contours.techniques[0], 1.6, 3.2),
  b: inkOf(data.contours.techniques[1], 1.6, 3.2),
};

function pathOf(lines) {
  const path = new Path2D();
  for (const [[x, y], ...rest] of lines) {
    path.moveTo(x, y);
    rest.forEach(([x, y]) => path.lineTo(x, y));
  }
  return path;
}

const kept = new WeakMap();

/** Paths by level. A mask without values between its outer levels has the line of the middle level only: all three coincide. */
function pathsOf(frame, mask) {
  if (kept.has(mask)) return kept.get(mask);
  const is_hard = mask.every((value) => value <= levels[0].value || value >= levels.at(-1).value);
  const paths = levels
    .filter((_, k) => !is_hard || k === 1)
    .map(({ value, dash }) => ({ dash, path: pathOf(isolines(frame, mask, value, (i) => isFacing(frame, i))) }));
  kept.set(mask, paths);
  return paths;
}

/** Draws a mask's lines over the picture that `view` shows (see Viewport). */
export function drawContours(context, view, frame, mask, ink) {
  const ratio = screenRatio() / view.scale; // of a CSS pixel in the picture's
  const stroke = (path, color, width, dash) => {
    context.setLineDash(dash.map((part) => part * ratio));
    context.strokeStyle = rgb(color);
    context.lineWidth = width * ratio;
    context.stroke(path);
  };
  context.save();
  context.translate(view.x, view.y);
  context.scale(view.scale, view.scale);
  context.lineJoin = "round";
  for (const { dash, path } of pathsOf(frame, mask)) {
    stroke(path, ink.casing, ink.widths[0], []);
    stroke(path, ink.core, ink.widths[1], dash);
  }
  context.restore();
}
