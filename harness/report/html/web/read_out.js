// The values at one pixel, as words.

import { isWrong } from "./compose.js";
import { data } from "./data.js";
import { words } from "./dom.js";

/** Under a light with area how far it is off, else whether it is wrong. */
function judged(frame, side, i) {
  if (!frame.is_soft) return isWrong(frame, side, i) ? " wrong" : "";
  const off = Number((side.mask[i] - side.reference[i]).toFixed(2));
  return off === 0 ? "" : ` (${off > 0 ? "+" : "\u2212"}${Math.abs(off).toFixed(2)})`;
}

function causeIn(side, i) {
  if (!side.causes) return "-";
  return side.causes[i] ? words(data.causes[side.causes[i] - 1].name) : "none";
}

/** Pairs of name and text; dashes without a pixel. `further` are the sides beyond A and B that are shown. */
export function readOut(pixel, frame, sideA, sideB, further = []) {
  const names = ["pixel", "A", "B", ...["C", "D"].slice(0, further.length), "reference", "class", "cause in A"];
  if (!pixel || !frame) return names.map((name) => [name, "-"]);
  const i = pixel.y * frame.width + pixel.x;
  const info = data.classes[frame.classes[i]];
  const masks = [sideA, sideB, ...further].map((side) => side.mask[i].toFixed(2) + judged(frame, side, i));
  const reference = sideA.reference[i].toFixed(2);
  const texts = [`${pixel.x}, ${pixel.y}`, ...masks, reference, `${info.name} ${info.word}`, causeIn(sideA, i)];
  return names.map((name, k) => [name, texts[k]]);
}
