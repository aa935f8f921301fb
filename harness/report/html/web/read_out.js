// What is known of one pixel, as words.

import { isWrong } from "./compose.js";
import { data } from "./data.js";

const dash = "-";
const words = (name) => name.replaceAll("_", " ");

/** Under a light with area how far it is off, else whether it is wrong. */
function judged(frame, side, i) {
  const off = Number((side.mask[i] - side.reference[i]).toFixed(2));
  if (frame.is_soft) return off === 0 ? "" : ` (${off > 0 ? "+" : "\u2212"}${Math.abs(off).toFixed(2)})`;
  return isWrong(frame, side, i) ? " wrong" : "";
}

function causeIn(side, i) {
  if (!side.causes) return dash;
  return side.causes[i] ? words(data.causes[side.causes[i] - 1].name) : "none";
}

/** Pairs of name and text; dashes where no pixel is pointed at. */
export function readOut(pixel, frame, sideA, sideB) {
  const names = ["pixel", "A", "B", "reference", "class", "cause in A"];
  if (!pixel || !frame) return names.map((name) => [name, dash]);
  const i = pixel.y * frame.width + pixel.x,
    info = data.classes[frame.classes[i]];
  const texts = [
    `${pixel.x}, ${pixel.y}`,
    ...[sideA, sideB].map((side) => side.mask[i].toFixed(2) + judged(frame, side, i)),
    sideA.reference[i].toFixed(2),
    `${info.name} ${info.word}`,
    causeIn(sideA, i),
  ];
  return names.map((name, k) => [name, texts[k]]);
}
